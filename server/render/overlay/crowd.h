/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Omits sensor markers where many overlap, following the rule in protocol/LABELS.md. Pure; all lengths in pixels. */
#ifndef RENDER_OVERLAY_CROWD_H
#define RENDER_OVERLAY_CROWD_H
#include <stdbool.h>
#include <stddef.h>

struct crowd_item {
    double x, y, depth_m;
    bool occluded;
    bool kept; /* true: the marker must be drawn, even if it overlaps many other markers */
    bool held; /* true: the previous frame showed the marker, so it is preferred to others */
};

/* Sets drawn[i] to true if items[i] (a marker) is to be drawn. unit: size of one pixel at 1280x720. */
void crowd_thin(const struct crowd_item *items, size_t count, double unit, bool *drawn);

#endif
