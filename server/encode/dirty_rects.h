/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Dirty rectangles: the parts of a frame that differ from the previous one. Pure. Call from any thread. */
#ifndef ENCODE_DIRTY_RECTS_H
#define ENCODE_DIRTY_RECTS_H
#include <stdbool.h>

#include "render/frame.h"

enum { DIRTY_RECTS_MAX = 8, DIRTY_RECTS_TILE_PX = 32 };
struct dirty_rect {
    int x_px, y_px, width_px, height_px;
};

/* Finds disjoint rectangles that cover every pixel that differs between two frames of equal size. Returns the number of
   rectangles; 0: the frames are equal. Edges lie at multiples of DIRTY_RECTS_TILE_PX or at the frame's right or lower edge. */
int dirty_rects_find(const struct frame *before, const struct frame *now, struct dirty_rect out[DIRTY_RECTS_MAX]);
/* returns true if two frames are equal; faster than dirty_rects_find() */
bool dirty_rects_none(const struct frame *before, const struct frame *now);
/* Returns the fraction of the frame that the rectangles cover, 0..1. */
double dirty_rects_share(const struct frame *frame, const struct dirty_rect *rects, int count);

#endif
