/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Nearest neighbours in a point cloud with FLANN's exact kd-tree. */
#include "surface/mesh/point_cloud.h"

#include <flann/flann.h>
#include <limits.h>
#include <math.h>
#include <stdint.h>

#include "base/mem.h"

#define FIRST_K 8
#define LEAF_POINTS 12

static float *floats_of(const double (*points)[3], size_t count)
{
    float *floats = mem_try_array(count * 3, sizeof(*floats));
    for (size_t i = 0; floats && i < count * 3; i++)
        floats[i] = (float)points[i / 3][i % 3];
    return floats;
}

/* One round of a search for all points within a radius: each query finds the k nearest points. If all k of a point are within
   the radius, there may be more; the point is then queried again in the next round with a larger k. */
struct round {
    const double (*points)[3];
    float *floats;
    size_t *queue, count;
    double radius_m;
    void (*visit)(void *arg, size_t point, size_t other, double distance_m);
    void *arg;
};

static bool ask(struct round *round, flann_index_t index, struct FLANNParameters *params, int k, bool last)
{
    float *asked = mem_try_array(round->count * 3, sizeof(*asked)),
          *distances2 = mem_try_array(round->count * (size_t)k, sizeof(*distances2));
    int *found = mem_try_array(round->count * (size_t)k, sizeof(*found));
    bool good = asked && distances2 && found;
    size_t kept = 0;
    for (size_t i = 0; good && i < round->count * 3; i++)
        asked[i] = round->floats[3 * round->queue[i / 3] + i % 3];
    good = good && flann_find_nearest_neighbors_index(index, asked, (int)round->count, found, distances2, k, params) == 0;
    for (size_t i = 0; good && i < round->count; i++) {
        size_t point = round->queue[i];
        if (!last && sqrt((double)distances2[i * (size_t)k + (size_t)k - 1]) <= round->radius_m) {
            round->queue[kept++] = point;
            continue;
        }
        for (int j = 0; j < k; j++) {
            int other = found[i * (size_t)k + (size_t)j];
            double distance_m =
                other < 0
                    ? INFINITY
                    : hypot(hypot(round->points[point][0] - round->points[other][0], round->points[point][1] - round->points[other][1]),
                            round->points[point][2] - round->points[other][2]);
            if (other >= 0 && (size_t)other != point && distance_m <= round->radius_m)
                round->visit(round->arg, point, (size_t)other, distance_m);
        }
    }
    round->count = kept;
    mem_free(asked);
    mem_free(distances2);
    mem_free(found);
    return good;
}

int point_cloud_neighbours(const double (*points)[3], size_t count, double radius_m,
                           void (*visit)(void *arg, size_t point, size_t other, double distance_m), void *arg)
{
    struct FLANNParameters params = DEFAULT_FLANN_PARAMETERS;
    struct round round = { .points = points, .count = count, .radius_m = radius_m, .visit = visit, .arg = arg };
    flann_index_t index = NULL;
    float speedup;
    int k = FIRST_K < (int)count ? FIRST_K : (int)count;
    bool good = true;
    if (count < 2 || count > INT_MAX)
        return 0;
    params.algorithm = FLANN_INDEX_KDTREE_SINGLE;
    params.leaf_max_size = LEAF_POINTS;
    params.checks = FLANN_CHECKS_UNLIMITED;
    params.cores = 1;
    params.log_level = FLANN_LOG_NONE;
    round.floats = floats_of(points, count);
    round.queue = mem_try_array(count, sizeof(*round.queue));
    if (round.floats && round.queue)
        index = flann_build_index(round.floats, (int)count, 3, &speedup, &params);
    for (size_t i = 0; round.queue && i < count; i++)
        round.queue[i] = i;
    good = index != NULL;
    while (good) {
        bool last = k >= (int)count || k >= POINT_CLOUD_MAX_K;
        good = ask(&round, index, &params, k, last);
        if (round.count == 0)
            break;
        k = k * 2 < (int)count ? k * 2 : (int)count;
    }
    if (index)
        flann_free_index(index, &params);
    mem_free(round.floats);
    mem_free(round.queue);
    return good ? k : -1;
}
