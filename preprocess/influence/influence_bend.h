/* SPDX-License-Identifier: GPL-3.0-or-later */
/* By how much a field between the corners of drawn triangles differs from the straight line that is drawn there. Both are straight in
   pieces, on triangles of their own, so their difference is greatest at a corner of where two of these overlap: all of these places are
   found, and that they cover a drawn triangle is checked by area. Thread: one, unless constant. */
#ifndef PREPROCESS_INFLUENCE_INFLUENCE_BEND_H
#define PREPROCESS_INFLUENCE_INFLUENCE_BEND_H
#include "preprocess/influence/influence.h"

struct bend_place {
    uint32_t tri;     /* of those that are drawn */
    uint32_t vertex;  /* that it is at, of all triangles around it; TRIMESH_NONE: at none */
    float weights[3]; /* of the triangle's corners */
};

struct influence_bend {
    struct bend_place *places;
    struct influence_anchor *anchors; /* where each place is on the mesh */
    size_t count, capacity, anchor_capacity;
    const uint32_t *triangles;
    double *area_m2; /* by drawn triangle; negative: not covered, so that nothing is known of it */
    size_t triangle_count;
};

/* Finds the places of triangle_count drawn triangles. Returns false if there are more than `most`. Call influence_bend_finish() in both
   cases. */
bool influence_bend_init(struct influence_bend *bend, const struct influence_mesh *mesh, const float (*positions_m)[3],
                         size_t vertex_count, const uint32_t *triangles, size_t triangle_count, size_t most);
void influence_bend_finish(struct influence_bend *bend);

struct bend_report { /* zero: nothing was asked for */
    size_t measured, unmeasured; /* groups by interpolations: whose bend is bounded; that would have taken too long */
    double steps;                /* 1/255 of MAX - MIN: what no place is off by more than, whatever good sensors read from MIN to MAX */
    double over_share;           /* of the area: triangles in which some place may be off by over a step */
    double unknown_share;        /* of the area: triangles of which nothing is known; not in the two above */
};
/* Adds what an interpolation may be off by to the report, the worst of all; writes the steps of each drawn triangle to `steps` (NULL:
   nowhere). influence: solved for vertex_count vertices and behind them the places. around: what the field falls to far from sensors, as
   (value - MIN) / (MAX - MIN); 0 where shares add up to 1. */
void influence_bend_measure(const struct influence_bend *bend, const struct influence *influence, size_t vertex_count, double around,
                            float *steps, struct bend_report *report);
/* Takes the places out of what was solved for them, too. */
void influence_bend_remove(const struct influence_bend *bend, struct influence *influence, size_t vertex_count);

#endif
