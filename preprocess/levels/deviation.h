/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measures how far two triangle surfaces are apart, for each part separately. Thread: any. */
#ifndef PREPROCESS_LEVELS_DEVIATION_H
#define PREPROCESS_LEVELS_DEVIATION_H
#include "base/workers.h"
#include "surface/mesh/bvh.h"

struct deviation_part;
struct deviation { /* a surface to measure against, and where it is probed */
    struct trimesh mesh;  /* part by part */
    struct bvh *whole;    /* of all parts; NULL: of each part its own */
    struct deviation_part *parts;
    size_t part_count;
    const uint32_t *part; /* by index in the positions */
    uint32_t *index;      /* of each point: its index in the positions, the first one at its place */
    size_t highest;       /* of them */
    char *has;            /* by index: it is a corner here */
    uint64_t *known;      /* a set of triangles, by hash of their indices */
    size_t known_mask;
};

struct deviation_params {
    const float (*positions_m)[3];
    const uint32_t *first_there; /* by vertex: the first vertex of the same part at the same position */
    const uint32_t *part;        /* by vertex; borrowed */
    size_t part_count;
    const char *only; /* by part: it will be measured; NULL: all */
    bool anywhere;    /* for deviation_measure_lost(): as the surface that others are measured to */
};
/* Builds a surface to be measured: copies positions and triangles (3 vertices each), removes duplicate triangles, and builds a bounding
   volume hierarchy of each part, so that other parts around it are not met when distances to it are looked for. Surfaces that are compared
   must share positions and parts. */
void deviation_init(struct deviation *surface, const struct deviation_params *params, const uint32_t *triangles, size_t triangle_count);
/* Frees the surface. */
void deviation_finish(struct deviation *surface);

/* Returns the hierarchy of a part's triangles; NULL: it has none, or was not to be measured. It lives as long as the surface. */
const struct bvh *deviation_hierarchy(const struct deviation *surface, size_t part);

/* Raises apart_m[part] to the largest distance from the surface `from` to the same part of `to`, probed at vertices and inside large
   triangles, except triangles that both have. INFINITY where `to` has nothing of the part. only: parts to measure (NULL: all). expected_m:
   about the distance hoped for, which steers how densely triangles are probed. workers may be NULL. */
void deviation_measure(const struct deviation *from, const struct deviation *to, const char *only, double expected_m, float *apart_m,
                       struct workers *workers);
/* As deviation_measure(), for the parts that `lost` marks, but to the nearest triangle of any part: where they lay on others, those are
   seen in their place. `to` must have been made for it (anywhere). */
void deviation_measure_lost(const struct deviation *from, const struct deviation *to, const char *lost, double expected_m, float *apart_m,
                            struct workers *workers);

#endif
