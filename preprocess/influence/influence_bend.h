/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measures the bend: the largest difference between the solved field, which bends, and the drawn field, which is linear between
 * the corners of each triangle of the asset file. The two fields are piecewise linear on different triangulations, so their
 * difference is largest at corners of the overlaps of mesh and drawn triangles. All these corners ("places") are found, and the
 * rest of each drawn triangle's area is recorded as not covered. The field is not solved where a part lies inside or against
 * another part. Where crack bridging has moved mesh corners off the drawn triangle, the mesh is projected perpendicularly onto
 * it. */
#ifndef PREPROCESS_INFLUENCE_INFLUENCE_BEND_H
#define PREPROCESS_INFLUENCE_INFLUENCE_BEND_H
#include <stdatomic.h>

#include "preprocess/influence/influence_mesh.h"
#include "preprocess/influence/mesh_error.h"

struct bend_place {
    uint32_t tri;                   /* index of the drawn triangle that contains the place */
    float weights[3];               /* barycentric weights of the place (point at which the error is measured) in the drawn triangle */
    struct influence_anchor anchor; /* position of the place on the finite-element mesh */
};

struct bend_level { /* one level of detail */
    size_t triangle_count;
    double error_m; /* largest distance of this level's triangles from the surface, metres */
};

struct bend_drawn { /* the drawn triangles: the triangles of the asset file */
    const float (*positions_m)[3];
    /* vertex indices of the drawn triangles, 3 each; levels of detail one after the other, finest first */
    const uint32_t *triangles;
    size_t vertex_count, triangle_count;
    const struct influence_anchor *anchors; /* by drawn vertex: its position on the finite-element mesh */
    /* levels of detail; all overlap corners are found for the finest level; triangles of coarser levels do not lie on the
     * surface, so the bend is measured at a few points of each */
    const struct bend_level *levels;
    size_t level_count; /* number of elements of `levels`; 0: all triangles belong to the finest level */
};

struct influence_bend {
    struct bend_drawn drawn;
    struct bend_place *places; /* points at which the bend is measured, grouped by drawn triangle */
    size_t count, capacity;
    /* by drawn triangle. area_m2: its area; hidden_m2: the part of that area inside or against other parts; unknown_m2: the
       part in which the bend is unknown. For triangles of coarse levels, these are numbers of sample points instead of
       areas. */
    double *area_m2, *hidden_m2, *unknown_m2;
    /* by place (corner of an overlap): sums of the sensors' positive and negative weight errors, in fixed point */
    _Atomic int64_t *plus, *minus;
    struct mesh_error *mesh_error; /* sums that give the discretisation error of the finite-element solution (mesh_error.h) */
    size_t point_count;            /* number of points of the finite-element mesh */
};

/* Finds the places of the drawn triangles: the points at which the bend is measured. The mesh, `drawn` and its arrays must
 * outlive *bend. surface: the surface that the mesh was made from. Returns false if there are more than `most` places, or if
 * out of memory. In either case, call influence_bend_finish(). Call from one thread only. */
bool influence_bend_init(struct influence_bend *bend, const struct influence_mesh *mesh, const struct surface *surface,
                         const struct bend_drawn *drawn, size_t most);
void influence_bend_finish(struct influence_bend *bend);

/* Adds the interpolation errors of the weights ("shares") of `width` sensors, at most BEND_WIDTH. at_points: `stride` numbers
 * per mesh point, of which the first `width` are weights. The order of calls does not affect the sums. Any number of threads
 * may call at the same time. */
void influence_bend_add(struct influence_bend *bend, const float *at_points, size_t stride, size_t width);

struct bend_report { /* measured bend (interpolation error in drawn triangles); all zero: no bend was measured */
    /* numbers of (group, interpolation) pairs. measured: with measured bend; unmeasured: with too many places (corners of
     * overlaps) to measure it */
    size_t measured, unmeasured;
    /* upper bound, for any good readings, of the deviation of the interpolated values from linear interpolation in the drawn
       triangles, in colour steps: (MAX - MIN) / 255 */
    double steps;
    double over_share;   /* share of the area in triangles whose bend (interpolation error) may exceed one step */
    double hidden_share; /* share of the asset's area inside or against another part; no values are computed there */
    /* share of the asset's area that is not on the surface on which values were computed; like the hidden area, not included in
       `steps` and `over_share` */
    double unknown_share;
};
/* Computes the error of one interpolation after the shares of all sensors were added, and resets the sums for the next one.
 * Merges the finest level's result into the report, which keeps the maximum of each number. steps (may be NULL): receives the
 * bend of each drawn triangle in colour steps. errors (may be NULL): receives, by vertex, the largest difference from the exact
 * solution in the adjacent triangles: bend plus discretisation error, as a share of the spread of readings (fin: spread of
 * readings and ambient); 1 where it is unknown. around: the field's value far from all sensors, as (value - MIN) / (MAX - MIN);
 * 0 for interpolations whose weights sum to 1. Call from one thread only. */
void influence_bend_measure(struct influence_bend *bend, double around, float *steps, float *errors, struct bend_report *report);

#endif
