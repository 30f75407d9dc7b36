/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Clips polygons against half planes, one after the other. */
#include "preprocess/influence/polygons.h"

#include <string.h>

#include "base/mem.h"

double polygon_area(const struct polygon *polygon)
{
    double twice = 0;
    for (int i = 2; i < polygon->count; i++)
        twice += polygon_cross(polygon->at[0], polygon->at[i - 1], polygon->at[i]);
    return twice / 2;
}

double polygons_area(const struct polygons *polygons)
{
    double sum = 0;
    for (size_t i = 0; i < polygons->count; i++)
        sum += polygon_area(&polygons->of[i]);
    return sum;
}

/* Writes the part of the polygon to the left (side 1) or right (side -1) of the line from a to b. Returns false with an empty
 * result if that part could have more than POLYGON_CORNERS corners. */
static bool half_of(const struct polygon *polygon, const double a[2], const double b[2], double side, struct polygon *out)
{
    out->count = 0;
    for (int i = 0; i < polygon->count; i++) {
        const double *p = polygon->at[i], *q = polygon->at[(i + 1) % polygon->count];
        double p_in = side * polygon_cross(a, b, p), q_in = side * polygon_cross(a, b, q);
        if (out->count + 2 > POLYGON_CORNERS) {
            out->count = 0;
            return false;
        }
        if (p_in >= 0)
            memcpy(out->at[out->count++], p, sizeof(out->at[0]));
        if ((p_in > 0 && q_in < 0) || (p_in < 0 && q_in > 0)) {
            double t = p_in / (p_in - q_in);
            for (int axis = 0; axis < 2; axis++)
                out->at[out->count][axis] = p[axis] + t * (q[axis] - p[axis]);
            out->count++;
        }
    }
    if (out->count < 3)
        out->count = 0;
    return true;
}

bool polygon_in_triangle(const struct polygon *polygon, const double triangle[3][2], struct polygon *out)
{
    struct polygon rest = *polygon;
    for (int i = 0; i < 3; i++) {
        if (!half_of(&rest, triangle[i], triangle[(i + 1) % 3], 1, out))
            return false;
        if (out->count == 0)
            return true;
        rest = *out;
    }
    return true;
}

void polygons_add(struct polygons *polygons, const struct polygon *polygon)
{
    mem_grow(&polygons->of, &polygons->capacity, polygons->count + 1, sizeof(*polygons->of));
    polygons->of[polygons->count++] = *polygon;
}

void polygons_add_outside(struct polygons *polygons, const struct polygon *polygon, const double triangle[3][2], double least_m2)
{
    struct polygon inside = *polygon, out[3], next;
    bool good = true;
    for (int i = 0; i < 3 && good; i++) {
        good = half_of(&inside, triangle[i], triangle[(i + 1) % 3], -1, &out[i]) &&
               half_of(&inside, triangle[i], triangle[(i + 1) % 3], 1, &next);
        inside = next;
    }
    /* if the overlap has at most the area least_m2, appends the whole polygon: splitting it would gain nothing */
    if (!good || !(polygon_area(&inside) > least_m2)) {
        polygons_add(polygons, polygon);
        return;
    }
    for (int i = 0; i < 3; i++)
        if (polygon_area(&out[i]) > least_m2)
            polygons_add(polygons, &out[i]);
}

void polygons_finish(struct polygons *polygons)
{
    mem_free(polygons->of);
    *polygons = (struct polygons){ 0 };
}
