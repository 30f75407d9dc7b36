/* SPDX-License-Identifier: GPL-3.0-or-later */
/* By how much a field between the corners of drawn triangles differs from the straight line that is drawn there. Both are straight in
   pieces, on triangles of their own, so their difference is greatest at a corner of where two of these overlap: all of these places are
   found, and what is left of a drawn triangle then is measured. Where a part is inside another one, or against it, nothing is solved.
   Where bridging a crack has moved corners of the mesh off the drawn triangle, its field is taken from straight above and below. */
#ifndef PREPROCESS_INFLUENCE_INFLUENCE_BEND_H
#define PREPROCESS_INFLUENCE_INFLUENCE_BEND_H
#include <stdatomic.h>

#include "preprocess/influence/influence_mesh.h"
#include "preprocess/influence/mesh_error.h"

struct bend_place {
    uint32_t tri;                   /* of those that are drawn */
    float weights[3];               /* of the triangle's corners */
    struct influence_anchor anchor; /* where it is on the mesh */
};

struct bend_level { /* a level of detail */
    size_t triangle_count;
    double error_m; /* distance of its triangles from the surface */
};

struct bend_drawn { /* the triangles that are drawn */
    const float (*positions_m)[3];
    const uint32_t *triangles; /* 3 indices each, level by level, the finest first */
    size_t vertex_count, triangle_count;
    const struct influence_anchor *anchors; /* of the vertices */
    /* All places of the finest level are found. Coarser levels do not lie on the surface: some samples of each triangle are taken. */
    const struct bend_level *levels;
    size_t level_count; /* 0: all triangles are of the finest level */
};

struct influence_bend {
    struct bend_drawn drawn;
    struct bend_place *places; /* those of a triangle one after the other */
    size_t count, capacity;
    double *area_m2, *hidden_m2, *unknown_m2; /* by drawn triangle: all of it, and what of it is not bounded. Coarse: in samples */
    _Atomic int64_t *plus, *minus;            /* by place: what shares are too small and too large by, added up */
    struct mesh_error *mesh_error;            /* error of the solution itself */
    size_t point_count;                       /* points of the mesh */
};

/* Finds the places of the drawn triangles; these and the anchors must outlive *bend. surface: what the mesh was made from. Returns false if
   there are more than `most`, or no memory. Call influence_bend_finish() in both cases. Thread: one. */
bool influence_bend_init(struct influence_bend *bend, const struct influence_mesh *mesh, const struct surface *surface,
                         const struct bend_drawn *drawn, size_t most);
void influence_bend_finish(struct influence_bend *bend);

/* Adds what `width` sensors' shares come to, at most BEND_WIDTH; at_points: [point of the mesh], each with `stride` numbers, of which the
   first `width` are taken. The sum is the same in any order. Thread: any number of calls at a time. */
void influence_bend_add(struct influence_bend *bend, const float *at_points, size_t stride, size_t width);

struct bend_report { /* zero: nothing was asked for */
    size_t measured, unmeasured; /* groups by interpolations: whose bend is bounded; that have too many places */
    double steps;                /* 1/255 of MAX - MIN: what no place is off by more than, whatever good sensors read from MIN to MAX */
    double over_share;           /* of the area: triangles in which some place may be off by over a step */
    double hidden_share;         /* of the area: inside another part or against it, where nothing is solved */
    double unknown_share;        /* of the area: not on the surface that is solved on; as above, not in `steps` and `over_share` */
};
/* Adds what an interpolation may be off by to the report, the worst of all, now that the shares of all sensors were added; of the finest
   level. Writes the steps of each drawn triangle to `steps` (NULL: nowhere), and for each vertex by how much the triangles around it
   may differ from the exact solution to `errors` (NULL: nowhere): bend and discretisation error, in parts of the spread of readings (fin:
   and of what is around); 1 where nothing is known. Then the next one may begin. around: what the field falls to far from sensors,
   as (value - MIN) / (MAX - MIN); 0 where shares add up to 1. Thread: one. */
void influence_bend_measure(struct influence_bend *bend, double around, float *steps, float *errors, struct bend_report *report);

#endif
