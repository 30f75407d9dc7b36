/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the cells of a depth grid (depth_grid.h): nearest and farthest depth, and the pixels on the nearer side of a depth step. */
#include "render/soft/depth_cells.h"

#include "render/soft/kernels.h"
#include "render/soft/lanes.h"

/* Smallest gap in depth between the two sides of a depth step, as a fraction of the cell's depth range; with a smaller gap the
   cell is not divided. On a single tilted plane, the depths of a cell are spread evenly, so that no gap is this large. */
static const float LEAST_GAP = 0.25f;

SOFT_INLINE float least_of_all(lanes x)
{
    x = lanes_least(x, __builtin_shufflevector(x, x, 4, 5, 6, 7, 0, 1, 2, 3));
    x = lanes_least(x, __builtin_shufflevector(x, x, 2, 3, 0, 1, 6, 7, 4, 5));
    return x[0] < x[1] ? x[0] : x[1];
}

SOFT_INLINE float most_of_all(lanes x)
{
    return -least_of_all(-x);
}

SOFT_INLINE lanes row_at(const float *depth, size_t pitch_px, int row)
{
    return *(const lanes *)(depth + (size_t)row * pitch_px);
}

/* Divides the pixels of a depth grid cell into those nearer than the depth `border` and those farther away. low: least depth of
   the farther pixels; 0: they show only background. high: largest depth of the cell. Returns false if the gap between the two
   sides is too small (LEAST_GAP). */
SOFT_INLINE bool divide(const float *depth, size_t pitch_px, float low, float border, float high, struct depth_cell *cell)
{
    lanes zero = { 0 }, nearest_behind = zero, farthest_before = zero + high;
    uint64_t mask = 0;
    for (int row = 0; row < DEPTH_CELL_PX; row++) {
        lanes here = row_at(depth, pitch_px, row);
        lanes_int before = here > border;
        nearest_behind = lanes_most(nearest_behind, lanes_choose(before, zero, here));
        farthest_before = lanes_least(farthest_before, lanes_choose(before, here, zero + high));
        mask |= (uint64_t)lanes_bits(before) << (row * DEPTH_CELL_PX);
    }
    float behind = most_of_all(nearest_behind), before = least_of_all(farthest_before);
    if (low > 0 && before - behind < LEAST_GAP * (high - low))
        return false;
    *cell = (struct depth_cell){ 0.5f * (before + high), 0.5f * (low + behind), mask };
    return true;
}

/* Returns the depth of the farthest surface in a depth grid cell, ignoring background. Larger depths are nearer, so this is the least depth
   above 0. */
SOFT_INLINE float farthest_surface(const float *depth, size_t pitch_px, float high)
{
    lanes most = { 0 }, least = most + high;
    most = least;
    for (int row = 0; row < DEPTH_CELL_PX; row++) {
        lanes here = row_at(depth, pitch_px, row);
        least = lanes_least(least, lanes_choose(here > 0.0f, here, most));
    }
    return least_of_all(least);
}

SOFT_INLINE void find_cell(const struct depth_lens *lens, const float *depth, size_t pitch_px, struct depth_cell *cell)
{
    lanes least = row_at(depth, pitch_px, 0), most = least;
    for (int row = 1; row < DEPTH_CELL_PX; row++) {
        lanes here = row_at(depth, pitch_px, row);
        least = lanes_least(least, here);
        most = lanes_most(most, here);
    }
    float low = least_of_all(least), high = most_of_all(most), middle = 0.5f * (low + high);
    *cell = (struct depth_cell){ middle, middle, 0 };
    if (high <= 0)
        return;
    /* If the cell shows two surfaces and background, divides it at the step between the surfaces rather than at the background:
       when a client warps the picture, a wrong depth moves the features of a surface visibly, but the background has none. */
    float surface = low > 0 ? low : farthest_surface(depth, pitch_px, high), border = 0.5f * (surface + high);
    bool divided = high - surface > lens->step * border + lens->least_step && divide(depth, pitch_px, surface, border, high, cell);
    if (low <= 0 && !divided)
        divide(depth, pitch_px, 0, 0, high, cell);
}

/* Computes a depth grid cell that extends beyond the frame. Outside the frame, the pixels at the frame's edge are repeated. */
static void find_edge_cell(const struct depth_source *source, int row, int column, struct depth_cell *cell)
{
    float depth[DEPTH_CELL_PX * DEPTH_CELL_PX];
    for (int i = 0; i < DEPTH_CELL_PX * DEPTH_CELL_PX; i++) {
        int x = column * DEPTH_CELL_PX + i % DEPTH_CELL_PX, y = row * DEPTH_CELL_PX + i / DEPTH_CELL_PX;
        x = x < source->width_px ? x : source->width_px - 1;
        y = y < source->height_px ? y : source->height_px - 1;
        depth[i] = source->depth[(size_t)y * source->pitch_px + (size_t)x];
    }
    find_cell(source->lens, depth, DEPTH_CELL_PX, cell);
}

void soft_find_cells(const struct depth_source *source, int first_row, int end_row, int first_column, int end_column,
                     struct depth_cell *cells)
{
    int columns = depth_cells_along(source->width_px), whole_columns = source->width_px / DEPTH_CELL_PX;
    int whole_rows = source->height_px / DEPTH_CELL_PX;
    for (int row = first_row; row < end_row; row++) {
        struct depth_cell *out = cells + (size_t)row * (size_t)columns;
        const float *depth = source->depth + (size_t)row * DEPTH_CELL_PX * source->pitch_px;
        for (int column = first_column; column < end_column; column++)
            if (row < whole_rows && column < whole_columns)
                find_cell(source->lens, depth + (size_t)column * DEPTH_CELL_PX, source->pitch_px, &out[column]);
            else
                find_edge_cell(source, row, column, &out[column]);
    }
}
