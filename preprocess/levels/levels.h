/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Levels of detail: coarser versions of an asset's triangles, each simplified from the one before, over one set of vertices. */
#ifndef PREPROCESS_LEVELS_H
#define PREPROCESS_LEVELS_H
#include "base/workers.h"
#include "preprocess/geometry/geometry.h"

#define LEVELS_MAX 24

/* Reasons why an edge stays unsplit although the field has an interpolation error along it: the level's triangle limit; pieces would be too
 * short; the distance along the surface jumps there. */
enum level_limit { LEVEL_LIMIT_TRIANGLES, LEVEL_LIMIT_LENGTH, LEVEL_LIMIT_JUMP, LEVEL_LIMITS };

/* Edges that still have a field error above one colour step after subdivision: their count, and the largest error in colour steps. In
 * coarser levels, the count of short edges is extrapolated from a sample. */
struct level_left {
    uint32_t edges;
    float steps;
};

struct level {
    uint32_t *indices;                  /* vertex indices of the geometry */
    struct asset_primitive *primitives; /* first_index is relative to this level; primitives without triangles are omitted */
    uint32_t index_count, primitive_count;
    uint32_t whole_count; /* index count before subdivision */
    float error_m; /* metres; largest distance between this level's surface and the finest one, in either direction; 0 for the finest */
    struct level_left left[LEVEL_LIMITS];
};

struct levels {
    struct level at[LEVELS_MAX]; /* finest first */
    size_t count;
    size_t given_up; /* levels dropped during subdivision, because they would need as many triangles as the next finer one */
    size_t repeated; /* number of duplicate triangles in the finest level; 0 for levels from the build cache */
};

/* Simplifies the geometry into levels, finest first. Each level has at most half the triangles of the one before. Far levels, used to draw
 * many instances, are closer together: each has 1.4 times the error of the one before if that gives at most 0.9 of its triangles, else the
 * smallest error that does. Borders between materials, texture seams and vertex colours stay in place within the error. Parts on much
 * larger ones (bolts on a flange) are omitted from levels whose error exceeds their height by a tenth, unless the surface under them has
 * moved so much that the omission exceeds the error. Small isolated parts are omitted from levels whose error is at least their size.
 * Returns false if out of memory; then levels_finish() need not be called. workers may be NULL. */
bool levels_make(struct levels *levels, const struct geometry *geometry, struct workers *workers);
/* Frees one level's arrays. */
void level_finish(struct level *level);
/* Frees all levels. */
void levels_finish(struct levels *levels);

#endif
