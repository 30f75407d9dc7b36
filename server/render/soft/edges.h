/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Edge functions of triangles (positive on one side of an edge, negative on the other), and interpolation over triangles, for
   eight pixels at a time. Private to soft/. */
#ifndef RENDER_SOFT_EDGES_H
#define RENDER_SOFT_EDGES_H
#include <stdbool.h>

#include "render/soft/soft_impl.h"
#include "render/soft/lanes.h"

struct raster_edge {
    float x, y, dx, dy; /* (x, y): upper end of the edge in pixels; (dx, dy): vector from there to the lower end */
    int32_t negative;   /* -1: pixels inside the triangle have negative values of the edge function; 0: they have non-negative values */
};

/* A quantity (such as depth) that is a linear function of the pixel position. at: its value at the triangle's first corner; dx, dy: change
   per pixel; low, high: smallest and largest value at the corners */
struct plane {
    float at, dx, dy, low, high;
};

SOFT_INLINE float smallest(float a, float b, float c)
{
    float least = a < b ? a : b;
    return least < c ? least : c;
}

SOFT_INLINE float largest(float a, float b, float c)
{
    float most = a > b ? a : b;
    return most > c ? most : c;
}

SOFT_INLINE void edge_init(struct raster_edge *edge, const struct soft_vertex *p, const struct soft_vertex *q)
{
    bool swap = q->y < p->y || (q->y == p->y && q->x < p->x);
    const struct soft_vertex *upper = swap ? q : p, *lower = swap ? p : q;
    *edge = (struct raster_edge){ upper->x, upper->y, lower->x - upper->x, lower->y - upper->y, swap ? -1 : 0 };
}

/* Returns the part of a triangle edge's function (edges.h) that is the same for all pixels of a row of the frame. y: y
   coordinate of the row's pixel centres. */
SOFT_INLINE float edge_row(const struct raster_edge *edge, float y)
{
    return edge->dx * (y - edge->y) + edge->dy * edge->x;
}

/* Returns eight numbers, negative for each pixel on the outer side of the edge. Only the sign bit counts, so a pixel with the edge function
   -0 is also on exactly one side. x: x of the pixel centres. */
SOFT_INLINE lanes_int edge_side(const struct raster_edge *edge, float row, lanes x)
{
    return (lanes_int)(row - edge->dy * x) ^ edge->negative;
}

/* vectors from the first corner of a triangle to the two others, divided by twice the triangle's area; input of plane_of() */
struct slopes {
    float x1, y1, x2, y2;
};

SOFT_INLINE struct plane plane_of(const struct slopes *slopes, float v0, float v1, float v2)
{
    float d1 = v1 - v0, d2 = v2 - v0;
    return (struct plane){ v0, d1 * slopes->y2 - d2 * slopes->y1, d2 * slopes->x1 - d1 * slopes->x2, smallest(v0, v1, v2),
                           largest(v0, v1, v2) };
}

SOFT_INLINE lanes plane_at(const struct plane *plane, lanes x, float y, bool thin)
{
    lanes value = plane->at + plane->dy * y + plane->dx * x;
    return thin ? lanes_clamp(value, plane->low, plane->high) : value;
}

#endif
