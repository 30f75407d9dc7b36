/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Levels of detail: coarser versions of an asset's triangles, each simplified from the one before, over one set of vertices. */
#ifndef PREPROCESS_LEVELS_H
#define PREPROCESS_LEVELS_H
#include "base/workers.h"
#include "preprocess/geometry/geometry.h"

#define LEVELS_MAX 24

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
    size_t repeated; /* triangles of the finest with the same three corners as one before; 0 once they come out of the cache */
};

/* Simplifies the geometry into levels, finest first. Each has at most half of the triangles of the one before. Far levels, which many
   instances are drawn with, lie closer together: each errs by 1.4 times as much as the one before where that allows 0.9 of its triangles or
   fewer, else by as little as does. Borders between materials, texture seams and vertex colours stay in place within the error. Parts that
   lie on much larger ones (bolts on a flange) are left out of levels whose error exceeds their height by a tenth, unless what they lie on
   has moved so far that they would be missed by more than the level errs; small isolated parts, of levels whose error is no less than
   their size. Returns false if out of memory, and then there is nothing to finish. workers may be NULL. */
bool levels_make(struct levels *levels, const struct geometry *geometry, struct workers *workers);
/* Frees one level's arrays. */
void level_finish(struct level *level);
/* Frees all levels. */
void levels_finish(struct levels *levels);

#endif
