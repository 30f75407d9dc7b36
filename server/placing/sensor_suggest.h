/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Suggests where additional sensors would help most: one position after the other, each chosen so that one sensor there reduces
   the measure as much as possible. The measure says how hard hot spots are to detect. 0: there is a sensor everywhere; 1: even
   a hot spot as strong as the group's full value range is undetectable. The measure is the mean over the surface of ln(h / h0)
   / ln(1 / 0.05), capped at 1. h is the strength of the weakest hot spot that is detectable at a point (drawn by the view
   option `show: blind`, which measures distances in the same way), and h0 that strength at a sensor. This greedy choice among
   the tested positions reaches at least 63 % of the best set's gain (Nemhauser, Wolsey & Fisher, 1978). Points represent the
   surface: the vertices, and points inside large triangles. Each point inside a triangle represents a piece with sides of at
   most a fifth of the distance at which h is the full range. The pieces are larger if an asset would need more than 100,000
   pieces. Call from one thread only; waits for worker threads. */
#ifndef PLACING_SENSOR_SUGGEST_H
#define PLACING_SENSOR_SUGGEST_H
#include "base/log/log.h"
#include "base/workers.h"
#include "scene/scene.h"

struct suggest_query {
    struct log *log;
    struct workers *workers;
    const struct scene *scene;
    const char *folder; /* folder of the prepared files */
    int group, asset;   /* asset: index of the asset; -1: all assets on which sensors of the group have known positions */
    size_t count;
};

struct suggestion {
    int asset;
    double at_m[3];       /* suggested position on the surface, in plant coordinates */
    double before, after; /* the measure (see the top of this file) over all assets of the query, before and after adding this sensor */
    double unseen_before, unseen_after; /* fraction of the area where even a hot spot as strong as the group's full value range is
                                           undetectable, before and after adding this sensor */
};

/* Writes up to query->count suggestions to `out` and returns their number; fewer if no further sensor would help. Returns 0 if no asset
 * has sensors of the group at known positions, or after a failure (logged). */
size_t sensor_suggest(const struct suggest_query *query, struct suggestion *out);

#endif
