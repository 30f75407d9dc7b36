/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measures the largest distance between two triangle surfaces, for each part (connected component) separately. Thread: any. */
#ifndef PREPROCESS_LEVELS_DEVIATION_H
#define PREPROCESS_LEVELS_DEVIATION_H
#include "base/workers.h"
#include "surface/mesh/bvh.h"

struct deviation_part;
struct deviation {       /* a triangle surface, prepared for measuring distances to it and from it */
    struct trimesh mesh; /* triangles of the surface, grouped by part (connected component) */
    struct bvh *whole;   /* bounding volume hierarchy over the triangles of all parts; NULL: each part has a hierarchy of its own */
    struct deviation_part *parts;
    size_t part_count;
    const uint32_t *part; /* by vertex: part (connected component) that contains it */
    uint32_t *index;      /* by vertex: lowest index of a vertex at its position; the mesh has one point per position, with this index */
    size_t highest;       /* largest value in the array `index` */
    char *has;            /* by vertex: nonzero if a triangle of this surface uses it */
    uint64_t *known;      /* hash set of the surface's triangles, which finds duplicates and triangles that two surfaces share */
    size_t known_mask;
};

struct deviation_params {
    const float (*positions_m)[3];
    const uint32_t *first_there; /* by vertex: lowest index of a vertex of the same part (connected component) at the same position */
    const uint32_t *part;        /* part (connected component) of each vertex; the array belongs to the caller */
    size_t part_count;
    const char *only; /* by part (connected component): nonzero if the part will be measured; NULL: all parts are */
    bool anywhere;    /* true: build one bounding volume hierarchy over all parts, which deviation_measure_lost() needs */
};
/* Builds a surface to measure: copies positions and triangles (3 vertices each), and removes duplicate triangles. Builds a bounding volume
 * hierarchy for each part (connected component), so that a distance query for one part does not visit the triangles of others. Surfaces to
 * be compared must share positions and parts. */
void deviation_init(struct deviation *surface, const struct deviation_params *params, const uint32_t *triangles, size_t triangle_count);
/* Frees the surface. */
void deviation_finish(struct deviation *surface);

/* Returns the bounding volume hierarchy of the triangles of a part (connected component), which belongs to the surface. NULL: the part has
 * no triangles, or was excluded by `only`. */
const struct bvh *deviation_hierarchy(const struct deviation *surface, size_t part);

/* Raises apart_m[part] to the largest distance of the surface `from` to the same part of `to`, in metres. Probes vertices and points inside
 * large triangles, and skips triangles that both surfaces contain. INFINITY if `to` has no triangle of the part. only: parts to measure
 * (NULL: all). expected_m: expected result, which determines how densely triangles are probed. workers may be NULL. */
void deviation_measure(const struct deviation *from, const struct deviation *to, const char *only, double expected_m, float *apart_m,
                       struct workers *workers);
/* Like deviation_measure(), but for the parts marked in `lost`, whose distance is measured to the nearest triangle of any part of `to`:
 * where a removed part lay on other parts, those parts are visible in its place. `to` must have been built with `anywhere`. */
void deviation_measure_lost(const struct deviation *from, const struct deviation *to, const char *lost, double expected_m, float *apart_m,
                            struct workers *workers);

#endif
