/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reduces a depth buffer to the cells (squares of pixels) of a depth grid, the coarse depth with which clients warp a picture.
   Pure. Call from any thread. */
#ifndef RENDER_SOFT_DEPTH_CELLS_H
#define RENDER_SOFT_DEPTH_CELLS_H
#include "render/depth_grid.h"

struct depth_source {
    const float *depth; /* depth buffer of the frame: 1 near, 0 far and background */
    size_t pitch_px;
    int width_px, height_px;
    const struct depth_lens *lens;
};

/* Finds the depth grid cells (squares of pixels) in rows `first_row` to `end_row` - 1 and columns `first_column` to
   `end_column` - 1. cells: all cells of the frame, row by row. */
void depth_cells_find(const struct depth_source *source, int first_row, int end_row, int first_column, int end_column,
                      struct depth_cell *cells);

#endif
