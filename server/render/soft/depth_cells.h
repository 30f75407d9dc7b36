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

#endif
