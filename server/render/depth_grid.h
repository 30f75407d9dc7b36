/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Depth grid: coarse depth of a frame, with which a client can show the frame from another camera (PROTOCOL.md, Depth grid).
   Immutable; reference-counted; may be released on any thread. */
#ifndef RENDER_DEPTH_GRID_H
#define RENDER_DEPTH_GRID_H
#include "protocol/wire.h"
#include "render/plan/view_constants.h"

enum { DEPTH_CELL_PX = 8 };

/* Square of DEPTH_CELL_PX x DEPTH_CELL_PX pixels. Depths are those of the depth buffer: above 0, larger is nearer; 0: background. */
struct depth_cell {
    /* a depth step divides a cell into a nearer and a farther side. near, far: middle of the depth range of the nearer and of
       the farther side; without a step, both are the middle of the cell's depth range */
    float near, far;
    /* one bit per pixel of the cell, row by row; 1: the pixel is on the nearer side of the cell's depth step */
    uint64_t mask;
};

/* Converts values in the depth buffer to distances from the camera. (depth - offset) / factor is 1 / distance in a perspective
   view, and the distance in an orthographic one. Distances are in metres along the direction of view. */
struct depth_lens {
    bool orthographic;
    double offset, factor;
    /* a cell is divided by a step if two of its depths differ by more than step * depth + least_step */
    float step, least_step;
    /* the ground that receives shadows: its depth at the pixel (x, y) is ground[0] x + ground[1] y + ground[2] */
    bool has_ground;
    /* ground_from_pixel: column-major homogeneous matrix from a pixel (x, y, 1) to the position (u s, v s, s) on the ground; u, v: 0..1 */
    double ground[3], ground_from_pixel[3][3];
};

struct depth_grid {
    _Atomic int refs;
    /* header of the message that carries the grid to clients; sequence number and x_px, y_px are not set yet, because they
       differ between messages */
    struct wire_depth wire;
    uint8_t *payload;
};

static inline int depth_cells_along(int px)
{
    return (px + DEPTH_CELL_PX - 1) / DEPTH_CELL_PX;
}
/* Computes from a view the matrices that clients need to turn depth codes into positions (struct depth_lens). plant_from_ground: matrix
   from positions on the drawn ground rectangle, 0..1 along each side, to the plant; NULL: the view shows no ground. */
void depth_lens_init(struct depth_lens *lens, const struct view_constants *constants, const double *plant_from_ground, int width_px,
                     int height_px);
/* Encodes the cells (squares of pixels) of a frame as a depth grid; `cells` is in row order. Returns NULL when out of memory.
   The caller owns the grid (depth_grid_unref). */
struct depth_grid *depth_grid_create(const struct depth_cell *cells, const struct depth_lens *lens, int width_px, int height_px);
struct depth_grid *depth_grid_ref(struct depth_grid *grid); /* accepts NULL */
void depth_grid_unref(struct depth_grid **grid);            /* accepts a pointer to NULL */
/* Returns whether two depth grids are equal, so that a client that has received `a` need not be sent `b`. Both may be NULL. */
bool depth_grid_equal(const struct depth_grid *a, const struct depth_grid *b);

#endif
