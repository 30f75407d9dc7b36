/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How far two triangle surfaces are apart, measured. */
#ifndef PREPROCESS_DEVIATION_H
#define PREPROCESS_DEVIATION_H
#include "base/workers.h"
#include "surface/bvh.h"

struct deviation { /* a surface to measure against, and where it is probed */
    struct trimesh mesh;
    struct bvh *bvh;
    uint32_t *index; /* of each point: its index in the positions */
    size_t highest;  /* of them */
    char *has;       /* by index: it is a corner here */
    uint64_t *known; /* a set of triangles, by hash of their indices */
    size_t known_mask;
};

/* Positions and triangles (indices, 3 each) are copied. Surfaces that are compared share their positions. */
void deviation_init(struct deviation *surface, const float (*positions_m)[3], const uint32_t *triangles, size_t triangle_count);
void deviation_finish(struct deviation *surface);

/* The largest distance from points of `from` to `to`: its corners, and inner points of triangles larger than the distances that matter, but
   for what both have. expected_m: about what is hoped for; beyond limit_m it is not looked for exactly. workers may be NULL. */
double deviation_measure(const struct deviation *from, const struct deviation *to, double expected_m, double limit_m,
                         struct workers *workers);

#endif
