/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Clips convex, counter-clockwise polygons in a plane against triangles (Sutherland & Hodgman, Reentrant polygon clipping,
 * 1974). Call from one thread only. */
#ifndef PREPROCESS_INFLUENCE_POLYGONS_H
#define PREPROCESS_INFLUENCE_POLYGONS_H
#include <stdbool.h>
#include <stddef.h>

enum { POLYGON_CORNERS = 24 };

struct polygon {
    double at[POLYGON_CORNERS][2];
    int count; /* number of corners; 0: the polygon is empty */
};

struct polygons {
    struct polygon *of;
    size_t count, capacity;
};

/* Returns twice the signed area of the triangle a, b, c: positive if counter-clockwise. */
static inline double polygon_cross(const double a[2], const double b[2], const double c[2])
{
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

double polygon_area(const struct polygon *polygon);
double polygons_area(const struct polygons *polygons);
/* Writes the intersection of the polygon and the triangle. Returns false with an empty result if it would have more than POLYGON_CORNERS
 * corners. */
bool polygon_in_triangle(const struct polygon *polygon, const double triangle[3][2], struct polygon *out);
/* Appends the part of the polygon outside the triangle to `polygons`, as convex polygons. Drops those with at most the area least_m2. */
void polygons_add_outside(struct polygons *polygons, const struct polygon *polygon, const double triangle[3][2], double least_m2);
void polygons_add(struct polygons *polygons, const struct polygon *polygon);
/* Frees the list. */
void polygons_finish(struct polygons *polygons);

#endif
