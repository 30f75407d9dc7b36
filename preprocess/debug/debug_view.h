/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How distances were found on one asset, as a GLB for any viewer. What its nodes show: REPORT.md. Thread: any, one per call. */
#ifndef PREPROCESS_DEBUG_VIEW_H
#define PREPROCESS_DEBUG_VIEW_H
#include "surface/surface.h"

struct debug_view {
    const char *name;              /* of the asset */
    const struct surface *surface; /* Z up */
    const float *distances_m;      /* at its points, from the sensor; NULL: none is chosen */
    const char *sensor;            /* whose distances */
    const double (*sensors_m)[3];  /* places of all sensors */
    size_t sensor_count, chosen;
};

/* 0 or -errno. */
int debug_view_save(const struct debug_view *view, const char *path);

#endif
