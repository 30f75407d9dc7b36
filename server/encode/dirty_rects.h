/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which parts of a picture differ from the one before it. Pure. */
#ifndef ENCODE_DIRTY_RECTS_H
#define ENCODE_DIRTY_RECTS_H
#include <stdbool.h>

#include "render/frame.h"

enum { DIRTY_RECTS_MAX = 8, DIRTY_RECTS_TILE_PX = 32 };
struct dirty_rect {
    int x_px, y_px, width_px, height_px;
};

/* Rectangles that hold every pixel that differs, apart from each other, at multiples of DIRTY_RECTS_TILE_PX but for the picture's own right
   and lower edge. Returns how many; 0: the pictures are equal. Both of one size. */
int dirty_rects_find(const struct frame *before, const struct frame *now, struct dirty_rect out[DIRTY_RECTS_MAX]);
bool dirty_rects_none(const struct frame *before, const struct frame *now); /* likewise, and faster */
/* Share of the picture that rectangles cover, 0..1. */
double dirty_rects_share(const struct frame *frame, const struct dirty_rect *rects, int count);

#endif
