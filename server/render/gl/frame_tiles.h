/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A frame divided into tiles. They are drawn one after the other with the camera of the whole frame, so that no seams appear
   between them. Call only in the thread that owns the GL context. */
#ifndef RENDER_GL_FRAME_TILES_H
#define RENDER_GL_FRAME_TILES_H
#include "render/frame_context.h"

struct frame_tiles {
    int width_px, height_px;
    /* block_px: side of a square block of cells in pixels; columns, rows: number of blocks. The cells of a block are in Z-order, so that
       the cells of a tile of any size are contiguous */
    int block_px, columns, rows;
    /* next: index of the next cell (square of pixels) to draw, counted through both passes (enum gl_pass). span: number of
       cells in the tile that begins there; 0: not chosen yet */
    int next, span;
    int *in_tile; /* indices of the assets that the current tile (rectangle of the frame) shows */
};
struct tile {
    int x_px, y_px, width_px, height_px; /* one tile: a rectangle in pixels, from the top left of the frame */
};

/* Divides the frame into tiles. whole true: one tile covers the whole frame; false: tiles have at most 16 cells of 64 x 64 pixels. */
void frame_tiles_init(struct frame_tiles *tiles, const struct frame_context *context, bool whole);
void frame_tiles_finish(struct frame_tiles *tiles);
/* returns the number of cells (squares of pixels) that cover the frame; each pass (enum gl_pass) draws each cell once */
int frame_tiles_cells(const struct frame_tiles *tiles);
/* Returns the largest tile of at most most_px pixels that begins with the next cell (square of pixels), but never less than one
   cell. A tile outside the frame has size 0. */
struct tile frame_tiles_choose(struct frame_tiles *tiles, double most_px);
/* Returns the frame's context with its list of visible assets reduced to those inside the tile. Valid until the next call. */
struct frame_context frame_tiles_context(struct frame_tiles *tiles, const struct frame_context *frame, const struct tile *tile);

#endif
