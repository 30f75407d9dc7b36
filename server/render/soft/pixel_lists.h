/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lists of the sensors that matter in a small square of pixels, for fields of many sensors (field/pixel_field.h). The
   contributions of a list's sensors are summed at each pixel; polynomials of the position approximate the sums over all other
   sensors. Lists are made for squares of 128, 64, 32 and 16 pixels, until they are short. Each is made from the list of the
   larger square around it. They are rebuilt for each picture, so they need no update when readings change. Private to soft/. */
#ifndef RENDER_SOFT_PIXEL_LISTS_H
#define RENDER_SOFT_PIXEL_LISTS_H
#include <math.h>

#include "field/pixel_field.h"
#include "render/soft/lanes.h"

/* PIXEL_FEW: fields with at most this many sensors need no lists: all sensors are summed at each pixel. */
enum { PIXEL_FEW = 8, CELL_SHIFT = 4, CELL_PX = 1 << CELL_SHIFT, SQUARE_CELLS = 8, PIXEL_TERMS = 10 };

struct pixel_cell {        /* the pixels of one cell (a square with sides of CELL_PX pixels) that show one mesh */
    float low[3], high[3]; /* box in metres around the surface points that the cell's pixels show */
    uint16_t column, row;  /* position of this square of pixels (cell) in the frame, in cells from the top left */
    uint32_t mesh;
};

struct pixel_list {
    /* indices in field->sensors of the near sensors, which are evaluated at each pixel of the square; NULL: the first `count` sensors */
    const uint32_t *sensors;
    size_t first;            /* index in pixel_lists.sensors of the first sensor of this list */
    int count;
    bool all_used;  /* true: all near sensors of the list, which are evaluated at each pixel, have a usable reading */
    /* true: at least one sensor with a reading is too far away to be in the list; the polynomials below approximate its weight */
    bool has_far;
    /* true: at least one far sensor (replaced by a polynomial) has a reading of quality Uncertain, so pixels may be marked as uncertain */
    bool has_marks;
    /* Polynomials that replace sums over the far sensors, all times 2^-top (`unit` is 2^top). total: sum of the weights;
       values: sum of weights times values; marked: sum of the weights of Uncertain sensors. Coefficients of 1, x, y, z, xx, xy,
       xz, yy, yz, zz, with x, y, z in metres from `centre`. */
    float top, unit, centre[3], total[PIXEL_TERMS], values[PIXEL_TERMS], marked[PIXEL_TERMS];
    /* mesh and position of the list's square of pixels (cell), copied from struct pixel_cell */
    uint32_t mesh, column, row;
    uint32_t next;              /* index for the caller's own use, such as a linked list; the functions below ignore it */
};

struct pixel_lists {
    struct pixel_list *lists;
    uint32_t *sensors;
    size_t count, capacity, sensor_count, sensor_capacity;
    float *room; /* working memory */
    size_t room_capacity;
};

#define pixel_lists_step SOFT_IN_SET(pixel_lists_step, SOFT_SET)
#define pixel_lists_add SOFT_IN_SET(pixel_lists_add, SOFT_SET)
#define pixel_lists_settle SOFT_IN_SET(pixel_lists_settle, SOFT_SET)
#define pixel_lists_finish SOFT_IN_SET(pixel_lists_finish, SOFT_SET)

/* Returns the largest error that a list may cause in the field's values: three quarters of a step of 1/255 of the range. scale: from struct
   frame_uniforms. */
float pixel_lists_step(const float *scale);
/* Makes a list of sensors for each cell and appends it to `lists`. cells: cells of one square of SQUARE_CELLS x SQUARE_CELLS cells, in the
   order of pixel_cells_order(). */
void pixel_lists_add(struct pixel_lists *lists, const struct pixel_field *field, float step, const struct pixel_cell *cells, size_t count);
/* Sets the pointer `sensors` of each list to the list's part of the array pixel_lists.sensors. Call it after the last
   pixel_lists_add(), which may move that array. */
void pixel_lists_settle(struct pixel_lists *lists);
/* Frees the lists. *lists may be zeroed, and can be used again afterwards. */
void pixel_lists_finish(struct pixel_lists *lists);

/* Returns whether a sensor's weight in this field is its strength (a constant factor) / distance^2; such weights are quick to
   sum. */
static inline bool pixel_is_inverse_square(const struct pixel_field *field)
{
    return !field->paper && field->power == 2.0f && !(field->reach_m < INFINITY);
}

/* Returns a list of all sensors of a field, for fields with so few sensors that none is replaced by a polynomial. */
static inline struct pixel_list pixel_list_of_all(const struct pixel_field *field)
{
    struct pixel_list all = { .count = field->count, .all_used = true };
    for (int i = 0; i < field->count; i++)
        all.all_used &= (field->sensors[i].state & PIXEL_USABLE) != 0;
    return all;
}

/* Returns the number of a cell on a space-filling curve (Z-order) through its square. The cells of each aligned smaller square have
   consecutive numbers. */
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
