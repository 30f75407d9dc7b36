/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Levels of detail: coarser versions of an asset's triangles, each simplified from the one before, over one set of vertices. */
#ifndef PREPROCESS_LEVELS_H
#define PREPROCESS_LEVELS_H
#include "base/workers.h"
#include "preprocess/geometry/geometry.h"

#define LEVELS_MAX 24

/* Why subdivision leaves an edge unsplit although linear interpolation along it has an error: the level's triangle limit is
 * reached; the parts of the edge would be too short; the distance along the surface jumps there, so splitting does not help. */
enum level_limit { LEVEL_LIMIT_TRIANGLES, LEVEL_LIMIT_LENGTH, LEVEL_LIMIT_JUMP, LEVEL_LIMITS };

/* Edges whose interpolation error after subdivision is still above one colour step (1/255 of the value range): their count, and
   the largest error in colour steps. In coarser levels of detail, the count of edges too short to split is extrapolated from a
   sample. */
struct level_left {
    uint32_t edges;
    float steps;
};

struct level {
    uint32_t *indices; /* the level's triangles as indices of the geometry's vertices */
    /* the level's triangles, grouped by material; first_index is relative to this level; primitives without triangles are omitted */
    struct asset_primitive *primitives;
    uint32_t index_count, primitive_count;
    uint32_t whole_count; /* number of the level's indices before subdivision */
    /* largest distance, in metres, of this level's surface from the finest level's, in either direction; 0 for the finest */
    float error_m;
    struct level_left left[LEVEL_LIMITS];
};

struct levels {
    struct level at[LEVELS_MAX]; /* levels of detail, finest first */
    size_t count;
    /* number of levels of detail dropped during subdivision because they would need nearly as many triangles as the next finer level */
    size_t given_up;
    /* number of duplicate triangles in the finest level of detail; 0 if the levels come from the build cache, which does not
     * store this number */
    size_t repeated;
};

/* Simplifies the geometry into levels, finest first. Each level has at most half the triangles of the one before. Far levels,
 * used to draw many instances, are closer together: each has 1.4 times the error of the level before, or a larger error if it
 * takes one to get at most 0.9 of the triangles. Borders between materials, texture seams and vertex colours stay in place
 * within the error. Parts that lie on much larger parts (bolts on a flange) are omitted from levels whose error exceeds the
 * part's height by a tenth. They stay if the surface under them has moved so far that the omission would exceed the level's
 * error. Small isolated parts are omitted from levels whose error is at least their size. Returns false if out of memory;
 * levels_finish() then need not be called. workers may be NULL. */
bool levels_make(struct levels *levels, const struct geometry *geometry, struct workers *workers);
/* Frees one level's arrays. */
void level_finish(struct level *level);
/* Frees all levels. */
void levels_finish(struct levels *levels);

#endif
