/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the cells of a frame's depth grid (depth_grid.h) on the GPU. Call only in the thread that owns the GL context. */
#ifndef RENDER_GL_DEPTH_QUERY_H
#define RENDER_GL_DEPTH_QUERY_H
#include "render/depth_grid.h"
#include "render/frame_context.h"

struct depth_query {
    GLuint program; /* program of shaders/depth_cells.comp, owned by the caller; zero-initialise all other members */
    GLuint buffer;
    /* cells (squares of pixels with their depth) of the depth grid; the GPU writes them to memory mapped into this process */
    const struct depth_cell *cells;
    size_t capacity;
    struct depth_lens lens;
    int width_px, height_px; /* size in pixels of the frame whose depth grid is computed; 0: the frame gets no depth grid */
};

/* Starts computing the cells of the frame's depth grid on the GPU, if the frame gets a grid. Call it after the multisampled
   frame is resolved. The previous frame that used this query must be complete. Returns false on a GL error (logged). */
bool depth_query_start(struct depth_query *query, const struct frame_context *context, const struct light *light);
/* Returns the frame's depth grid; call it after the GPU has computed the cells. The caller owns the grid. NULL: the frame gets no grid, or
   memory ran out. */
struct depth_grid *depth_query_get(const struct depth_query *query);
void depth_query_finish(struct depth_query *query);

#endif
