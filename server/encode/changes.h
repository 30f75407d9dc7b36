/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which parts of a picture differ from the one before it. Pure. */
#ifndef ENCODE_CHANGES_H
#define ENCODE_CHANGES_H
#include <stdbool.h>

#include "render/frame.h"

enum { CHANGES_MAX = 8, CHANGES_TILE_PX = 32 };
struct change {
    int x_px, y_px, width_px, height_px;
};

/* Rectangles that hold every pixel that differs, apart from each other, at multiples of CHANGES_TILE_PX but for the picture's own right
   and lower edge. Returns how many; 0: the pictures are equal. Both of one size. */
int changes_find(const struct frame *before, const struct frame *now, struct change out[CHANGES_MAX]);
bool changes_none(const struct frame *before, const struct frame *now); /* likewise, and faster */
/* Share of the picture that rectangles cover, 0..1. */
double changes_share(const struct frame *frame, const struct change *changes, int count);

#endif
