/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes a GLB file, for any 3D viewer, that shows how distances were computed on an asset: surface, distances, sensors, and
 * bridges (connections over gaps). REPORT.md explains the nodes of the file. Call from any thread; each call from one thread at
 * a time. */
#ifndef PREPROCESS_DEBUG_VIEW_H
#define PREPROCESS_DEBUG_VIEW_H
#include "surface/surface.h"

/* input of a debug view; the caller keeps ownership of all pointers */
struct debug_view {
    const char *name;              /* name of the asset */
    const struct surface *surface; /* surface of the asset; Z is up */
    const float *distances_m;      /* distance in metres of each surface point from the chosen sensor; NULL: no sensor is chosen */
    const char *sensor;            /* name of the chosen sensor */
    const double (*sensors_m)[3];  /* positions of all sensors */
    size_t sensor_count, chosen;
};

/* Writes the debug view to `path` as a GLB file. Returns 0 or -errno. */
int debug_view_save(const struct debug_view *view, const char *path);

#endif
