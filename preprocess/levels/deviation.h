/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measures how far two triangle surfaces are apart, for each part separately. Thread: any. */
#ifndef PREPROCESS_LEVELS_DEVIATION_H
#define PREPROCESS_LEVELS_DEVIATION_H
#include "base/workers.h"
#include "surface/mesh/bvh.h"

struct deviation { /* a surface to measure against, and where it is probed */
    struct trimesh mesh;
    struct bvh *bvh;
    const uint32_t *part; /* by index in the positions */
    uint32_t *index;      /* of each point: its index in the positions, the first one at its place */
    size_t highest;       /* of them */
    char *has, *has_part; /* by index: it is a corner here; by part: it has triangles here */
    uint64_t *known;      /* a set of triangles, by hash of their indices */
    size_t known_mask;
};

/* Builds a surface to be measured: copies positions and triangles (3 indices each), removes duplicate triangles, and builds a bounding
   volume hierarchy. part (by vertex) is borrowed. first_there, by vertex: the first vertex of the same part at the same position. Surfaces
   that are compared must share positions and parts. */
void deviation_init(struct deviation *surface, const float (*positions_m)[3], const uint32_t *first_there, const uint32_t *part,
                    size_t part_count, const uint32_t *triangles, size_t triangle_count);
/* Frees the surface. */
void deviation_finish(struct deviation *surface);

/* Raises apart_m[part] to the largest distance from the surface `from` to the same part of `to`, probed at vertices and inside large
   triangles, except triangles that both have. INFINITY where `to` has nothing of the part. only: parts to measure (NULL: all). expected_m:
   about the distance hoped for, which steers how densely triangles are probed. workers may be NULL. */
void deviation_measure(const struct deviation *from, const struct deviation *to, const char *only, double expected_m, float *apart_m,
                       struct workers *workers);
/* As deviation_measure(), for the parts that `lost` marks, but to the nearest triangle of any part: where they lay on others, those are
   seen in their place. */
void deviation_measure_lost(const struct deviation *from, const struct deviation *to, const char *lost, double expected_m, float *apart_m,
                            struct workers *workers);

#endif
