/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Coarser versions of an asset's triangles, each made from the one before, so that their vertices are nested. */
#ifndef PREPROCESS_LEVELS_H
#define PREPROCESS_LEVELS_H
#include "base/workers.h"
#include "preprocess/geometry/geometry.h"

#define LEVELS_MAX 16

/* Why an edge is not cut though the field errs along it: the level may not have more triangles; the pieces would be too short; the distance
   along the surface jumps there. */
enum level_limit { LEVEL_LIMIT_TRIANGLES, LEVEL_LIMIT_LENGTH, LEVEL_LIMIT_JUMP, LEVEL_LIMITS };

/* After splitting: edges along which the field errs by more than a step of colour, and by how many at most. Of the short edges of coarser
   levels some are looked at, and stand for the rest. */
struct level_left {
    uint32_t edges;
    float steps;
};

struct level {
    uint32_t *indices;                  /* vertices of the geometry */
    struct asset_primitive *primitives; /* first_index counts from this level's first; without those that have no triangle left */
    uint32_t index_count, primitive_count;
    uint32_t whole_count; /* of indices, before splitting */
    float error_m;        /* no point of the finest surface is farther from this one, nor the other way round; 0 for the finest */
    struct level_left left[LEVEL_LIMITS];
};

struct levels {
    struct level at[LEVELS_MAX]; /* finest first */
    size_t count;
    size_t given_up; /* by the splitting: they would need as many triangles as the next finer one */
    size_t repeated; /* triangles of the finest with the same three corners as one before; 0 once it comes out of a stock */
};

/* Each level has at most 0.6 of the triangles of the one before, far ones 0.85: many instances are drawn with these. Borders between
   materials, texture seams and vertex colours stay where they are, within the error. Parts that lie on much larger ones are left out of
   levels that err by a tenth more than they stand out (bolts in a flange); so are small parts that no others are near, from where they
   are no larger than the error: a pixel. For those alone, no point of the level is near their points. False: out of memory; nothing to
   finish. */
bool levels_make(struct levels *levels, const struct geometry *geometry, struct workers *workers);
void level_finish(struct level *level);
void levels_finish(struct levels *levels);

#endif
