/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measures the largest distance between two triangle surfaces, separately for each part (connected component). Call from any thread. */
#ifndef PREPROCESS_LEVELS_DEVIATION_H
#define PREPROCESS_LEVELS_DEVIATION_H
#include "base/workers.h"
#include "surface/mesh/bvh.h"

struct deviation_part;
struct deviation {       /* a triangle surface, prepared for distance measurements from and to it */
    struct trimesh mesh; /* triangles of the surface, grouped by part (connected component) */
    struct bvh *whole;   /* bounding volume hierarchy over the triangles of all parts; NULL: each part has its own */
    struct deviation_part *parts;
    size_t part_count;
    const uint32_t *part; /* by vertex: the part (connected component) that contains it */
    uint32_t *index;      /* by vertex: lowest index of a vertex at its position; also the index of the mesh's point there */
    size_t highest;       /* largest value in the array `index` */
    char *has;            /* by vertex: nonzero if a triangle of this surface uses it */
    uint64_t *known;      /* hash set of the surface's triangles, for finding duplicates and triangles shared by two surfaces */
    size_t known_mask;
};

struct deviation_params {
    const float (*positions_m)[3];
    const uint32_t *first_there; /* by vertex: lowest index of a vertex at the same position in the same part (connected component) */
    const uint32_t *part;        /* by vertex: its part (connected component); the array belongs to the caller */
    size_t part_count;
    const char *only; /* by part (connected component): nonzero: the part will be measured; NULL: all parts will be */
    bool anywhere;    /* true: build one bounding volume hierarchy over all parts, as deviation_measure_lost() requires */
};
/* Builds a surface to measure: copies positions and triangles (3 vertices each), and removes duplicate triangles. Builds a
 * separate bounding volume hierarchy for each part (connected component), so that distance queries do not visit other parts.
 * Surfaces to be compared must share positions and parts. */
void deviation_init(struct deviation *surface, const struct deviation_params *params, const uint32_t *triangles, size_t triangle_count);
/* Frees the surface. */
void deviation_finish(struct deviation *surface);

/* Returns the bounding volume hierarchy of a part's triangles, which belongs to the surface. NULL: the part has no triangles,
 * or was excluded by `only`. */
const struct bvh *deviation_hierarchy(const struct deviation *surface, size_t part);

/* Raises apart_m[part] to the largest distance of the surface `from` to the same part of `to`, in metres; INFINITY if `to` has
 * no triangle of the part. Probes vertices and points inside large triangles, and skips triangles shared by both surfaces.
 * only: parts to measure (NULL: all). expected_m: expected result, which determines how densely triangles are probed. workers
 * may be NULL. */
void deviation_measure(const struct deviation *from, const struct deviation *to, const char *only, double expected_m, float *apart_m,
                       struct workers *workers);
/* Like deviation_measure(), but for the parts marked in `lost`, and measured to the nearest triangle of any part of `to`: where
 * a removed part lay on other parts, those parts are visible in its place. `to` must have been built with `anywhere`. */
void deviation_measure_lost(const struct deviation *from, const struct deviation *to, const char *lost, double expected_m, float *apart_m,
                            struct workers *workers);

#endif
