/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lists of the sensors that matter to a small square of pixels, for fields of many sensors (field/pixel_field.h). A list's sensors are
   summed at each pixel, the sums over all others are polynomials of the place. Lists are made for squares of
   128, 64, 32 and 16 pixels, each from the one around, until they are short. They are made for each picture, so
   nothing is kept when sensors or readings change. Private to soft/. */
#ifndef RENDER_SOFT_PIXEL_LISTS_H
#define RENDER_SOFT_PIXEL_LISTS_H
#include "field/pixel_field.h"
#include "render/soft/lanes.h"

/* PIXEL_FEW: with that many sensors, all are summed at each pixel. */
enum { PIXEL_FEW = 8, CELL_SHIFT = 4, CELL_PX = 1 << CELL_SHIFT, SQUARE_CELLS = 8, PIXEL_TERMS = 10 };

struct pixel_cell { /* pixels of one mesh in a cell */
    float low[3], high[3]; /* box around the places that the pixels show */
    uint16_t column, row;  /* in cells */
    uint32_t mesh;
};

struct pixel_list {
    const uint32_t *sensors; /* indices in the field; NULL: the first `count` sensors */
    size_t first;            /* of `sensors` in struct pixel_lists */
    int count;
    bool has_far;   /* the polynomials are not 0 */
    bool has_marks; /* a far sensor is uncertain */
    /* The polynomials: sums of weights, of weights times values, of uncertain weights, all times 2^-top. Terms: 1, x, y, z, xx, xy, xz,
       yy, yz, zz from the centre. */
    float top, centre[3], total[PIXEL_TERMS], values[PIXEL_TERMS], marked[PIXEL_TERMS];
    uint32_t mesh, column, row; /* from the cell */
    uint32_t next;              /* for the caller */
};

struct pixel_lists {
    struct pixel_list *lists;
    uint32_t *sensors;
    size_t count, capacity, sensor_count, sensor_capacity;
};

/* Returns the largest error of a list's values: three quarters of a step of 1/255 of the range. scale: from struct frame_uniforms. */
float pixel_lists_step(const float *scale);
/* Appends a list for each cell. cells: of one square of SQUARE_CELLS x SQUARE_CELLS cells, in the order of pixel_cells_order(). */
void pixel_lists_add(struct pixel_lists *lists, const struct pixel_field *field, float step, const struct pixel_cell *cells, size_t count);
/* Sets `sensors` of all lists, which pixel_lists_add() moves. */
void pixel_lists_settle(struct pixel_lists *lists);
void pixel_lists_finish(struct pixel_lists *lists); /* a zeroed struct is fine; it can be used again */

/* Returns the number of a cell in its square along a curve, on which each aligned square of cells is a range. */
static inline uint32_t pixel_cells_order(uint32_t column, uint32_t row)
{
    return (column & 1) | (row & 1) << 1 | (column & 2) << 1 | (row & 2) << 2 | (column & 4) << 2 | (row & 4) << 3;
}
static inline void pixel_cell_from_order(uint32_t order, uint32_t *column, uint32_t *row)
{
    *column = (order & 1) | (order >> 1 & 2) | (order >> 2 & 4);
    *row = (order >> 1 & 1) | (order >> 2 & 2) | (order >> 3 & 4);
}

#endif
