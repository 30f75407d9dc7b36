/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A frame cut into tiles, which are drawn one after the other with the camera of the whole, so that they fit without a seam. Thread: the
   one of the GL context. */
#ifndef RENDER_GL_FRAME_TILES_H
#define RENDER_GL_FRAME_TILES_H
#include "render/frame_context.h"

struct frame_tiles {
    int width_px, height_px;
    int block_px, columns, rows; /* blocks of cells; in a block the cells follow a Z, so that tiles of any size follow one another */
    int next, span;              /* the next cell, counted through all passes, and how many cells its tile has; 0: not chosen yet */
    int *in_tile;                /* assets */
};
struct tile {
    int x_px, y_px, width_px, height_px; /* from the top left */
};

/* whole: one tile holds all. */
void frame_tiles_init(struct frame_tiles *tiles, const struct frame_context *context, bool whole);
void frame_tiles_finish(struct frame_tiles *tiles);
int frame_tiles_cells(const struct frame_tiles *tiles); /* of one pass */
/* Returns the largest tile that begins with the next cell and has at most so many pixels, or the smallest. Of no size: outside the
   frame. */
struct tile frame_tiles_choose(struct frame_tiles *tiles, double most_px);
/* Returns the frame with only those assets that the tile shows. Valid until the next call. */
struct frame_context frame_tiles_context(struct frame_tiles *tiles, const struct frame_context *frame, const struct tile *tile);

#endif
