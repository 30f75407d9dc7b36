/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which markers are drawn where many crowd: the rule of protocol/LABELS.md. Pure; in pixels. */
#ifndef RENDER_OVERLAY_CROWD_H
#define RENDER_OVERLAY_CROWD_H
#include <stdbool.h>
#include <stddef.h>

struct crowd_item {
    double x, y, depth_m;
    bool occluded;
    bool kept; /* drawn in any case */
    bool held; /* drawn in the picture before */
};

/* drawn: by item. */
void crowd_thin(const struct crowd_item *items, size_t count, double unit, bool *drawn);

#endif
