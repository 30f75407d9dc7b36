/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes a GLB file that shows how distances were computed on one asset, for any 3D viewer: surface, distances, sensors, bridges. REPORT.md
   says what its nodes show. Thread: any, one per call. */
#ifndef PREPROCESS_DEBUG_VIEW_H
#define PREPROCESS_DEBUG_VIEW_H
#include "surface/surface.h"

/* What to show. Everything is borrowed for the call. */
struct debug_view {
    const char *name;              /* of the asset */
    const struct surface *surface; /* Z up */
    const float *distances_m;      /* at its points, from the sensor; NULL: none is chosen */
    const char *sensor;            /* whose distances */
    const double (*sensors_m)[3];  /* places of all sensors */
    size_t sensor_count, chosen;
};

/* Writes the view to `path` as GLB. Returns 0 or -errno. */
int debug_view_save(const struct debug_view *view, const char *path);

#endif
