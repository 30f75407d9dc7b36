/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How far two triangle surfaces are apart, part by part, measured. */
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

/* Positions and triangles (indices, 3 each) are copied, part (by index) is only pointed to. first_there, by index: the first one at the
   same place, which is of the same part. Of triangles with the same three places one is taken: of a hundred copies of a plate in one
   place each would be looked at from each of their corners. Surfaces that are compared share their positions and their parts. */
void deviation_init(struct deviation *surface, const float (*positions_m)[3], const uint32_t *first_there, const uint32_t *part,
                    size_t part_count, const uint32_t *triangles, size_t triangle_count);
void deviation_finish(struct deviation *surface);

/* Raises apart_m[part] to the largest distance from points of `from` to the same part of `to`: from its corners, and from inner points of
   triangles larger than the distances that matter, but for what both have. INFINITY where `to` has nothing of that part. only: by part, or
   NULL: all. expected_m: about what is hoped for. workers may be NULL. */
void deviation_measure(const struct deviation *from, const struct deviation *to, const char *only, double expected_m, float *apart_m,
                       struct workers *workers);
/* The same of parts that are lost, to whatever of `to` is nearest: where they lay on others, those are seen in their place. */
void deviation_measure_lost(const struct deviation *from, const struct deviation *to, const char *lost, double expected_m, float *apart_m,
                            struct workers *workers);

#endif
