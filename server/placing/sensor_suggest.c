/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Suggests positions for new sensors. Candidate positions are sorted by an upper bound of their gain. The bound uses
   straight-line distances, which are never longer than geodesic ones. So only the candidates with the highest bounds need
   geodesic distances. */
#include "placing/sensor_suggest.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>

#include "base/mem.h"
#include "field/kernels.h"
#include "field/layout.h"
#include "placing/mover.h"
#include "placing/sensor_coverage.h"
#include "plant/influence.h"
#include "plant/models/transform.h"

/* maximum number of candidate positions per asset, spread evenly over the area where hot spots are hard to detect */
#define MAX_CANDIDATES 1500
/* maximum number of candidates per suggestion, those with the highest bounds, for which geodesic distances are computed */
#define MAX_MEASURED 40
/* minimum gain for which a new sensor is suggested: reduction of the measure of how hard hot spots are to detect
   (sensor_suggest.h) */
#define MIN_GAIN 1e-6

struct suggest_asset { /* an asset on which sensors may be suggested */
    int asset;
    size_t count;
    const float (*at_m)[3];
    double *area_m2, whole_m2;
    float *near_m;            /* by vertex: distance in metres to the nearest sensor, including suggested ones */
    struct relocation *mover; /* computes geodesic distances on the asset; NULL: not needed yet */
};

struct candidate {
    size_t part;
    uint32_t vertex;
    /* upper bound of the gain of a sensor at this vertex: reduction of the measure of how hard hot spots are to detect
       (sensor_suggest.h) times the area in square metres */
    double bound;
};

struct suggesting {
    const struct suggest_query *query;
    double seen_m; /* distance in metres from a sensor within which a hot spot as strong as the group's full value range is detectable */
    struct suggest_asset *parts;
    size_t part_count;
    double whole_m2;
};

static double unseen(const struct suggesting *suggesting, double near_m)
{
    double share = near_m / suggesting->seen_m;
    return share < 1 ? share * share : 1;
}

static void measure(const struct suggesting *suggesting, double *mean, double *share)
{
    *mean = *share = 0;
    for (size_t p = 0; p < suggesting->part_count; p++) {
        const struct suggest_asset *part = &suggesting->parts[p];
        for (size_t v = 0; v < part->count; v++) {
            double here = unseen(suggesting, (double)part->near_m[v]);
            *mean += part->area_m2[v] * here / suggesting->whole_m2;
            *share += here >= 1 ? part->area_m2[v] / suggesting->whole_m2 : 0;
        }
    }
}

static bool add_part(struct suggesting *suggesting, int asset)
{
    const struct suggest_query *query = suggesting->query;
    struct field_layout *layout = layout_create(query->scene, asset, query->group, NULL);
    if (!layout || layout->assumed) {
        layout_destroy(&layout);
        return true;
    }
    const struct asset_view *view = &layout->file->view;
    struct suggest_asset *part = &suggesting->parts[suggesting->part_count++];
    *part = (struct suggest_asset){ .asset = asset, .count = layout->vertex_count, .at_m = view->positions_m };
    part->area_m2 = sensor_coverage_areas(view);
    part->near_m = mem_try_array(part->count, sizeof(*part->near_m));
    if (part->near_m) {
        for (size_t v = 0; v < part->count; v++) {
            part->near_m[v] = INFINITY;
            part->whole_m2 += part->area_m2[v];
        }
        for (size_t i = 0; i < layout->sensor_count; i++)
            for (size_t at = 0; at < part->count; at += KERNEL_BLOCK) {
                size_t count = part->count - at < KERNEL_BLOCK ? part->count - at : KERNEL_BLOCK;
                float room[KERNEL_BLOCK];
                kernel_nearest(layout_distances(layout, DISTANCE_GEODESIC, i, at, count, room), count, part->near_m + at);
            }
    }
    suggesting->whole_m2 += part->whole_m2;
    layout_destroy(&layout);
    return part->near_m;
}

/* --- candidates -------------------------------------------------------------------------------------------------------------- */

static double gain_of(const struct suggesting *suggesting, const struct suggest_asset *part, const float *away_m)
{
    double gain = 0;
    for (size_t v = 0; v < part->count; v++)
        if (away_m[v] < part->near_m[v])
            gain += part->area_m2[v] * (unseen(suggesting, (double)part->near_m[v]) - unseen(suggesting, (double)away_m[v]));
    return gain;
}

struct bounding {
    const struct suggesting *suggesting;
    struct candidate *candidates;
};

static void bound_some(void *arg, size_t begin, size_t end)
{
    const struct bounding *bounding = arg;
    for (size_t i = begin; i < end; i++) {
        struct candidate *candidate = &bounding->candidates[i];
        const struct suggest_asset *part = &bounding->suggesting->parts[candidate->part];
        const float *from = part->at_m[candidate->vertex];
        const double most = bounding->suggesting->seen_m * bounding->suggesting->seen_m;
        for (size_t v = 0; v < part->count; v++) {
            const float *to = part->at_m[v];
            double x = (double)(to[0] - from[0]), y = (double)(to[1] - from[1]), z = (double)(to[2] - from[2]);
            double square = x * x + y * y + z * z, near_m = (double)part->near_m[v];
            if (square < most && square < near_m * near_m)
                candidate->bound += part->area_m2[v] * (unseen(bounding->suggesting, near_m) - square / most);
        }
    }
}

static int by_bound(const void *a, const void *b)
{
    const struct candidate *first = a, *second = b;
    return (first->bound < second->bound) - (first->bound > second->bound);
}

/* Lists candidate positions for a sensor, spread evenly over the area where hot spots are hard to detect, highest bound first.
   Deterministic. *count receives the number of candidates. The caller frees the list. */
static struct candidate *find_candidates(const struct suggesting *suggesting, size_t *count)
{
    struct candidate *list = mem_array(suggesting->part_count * (MAX_CANDIDATES + 1), sizeof(*list));
    *count = 0;
    for (size_t p = 0; p < suggesting->part_count; p++) {
        const struct suggest_asset *part = &suggesting->parts[p];
        double whole = 0, passed = 0, next = 0;
        for (size_t v = 0; v < part->count; v++)
            whole += part->area_m2[v] * unseen(suggesting, (double)part->near_m[v]);
        for (uint32_t v = 0; v < part->count && whole > 0; v++) {
            passed += part->area_m2[v] * unseen(suggesting, (double)part->near_m[v]);
            if (passed <= next)
                continue;
            list[(*count)++] = (struct candidate){ .part = p, .vertex = v };
            while (next < passed)
                next += whole / MAX_CANDIDATES;
        }
    }
    struct bounding bounding = { suggesting, list };
    workers_for(suggesting->query->workers, *count, 4, bound_some, &bounding);
    qsort(list, *count, sizeof(*list), by_bound);
    return list;
}

/* --- distances along the surface --------------------------------------------------------------------------------------------- */

struct suggest_wait {
    pthread_mutex_t lock;
    pthread_cond_t done;
    /* --- below: under lock */
    bool is_done;
    struct relocation_result result;
};

static void on_distances(void *arg, struct relocation_result *result)
{
    struct suggest_wait *waiting = arg;
    pthread_mutex_lock(&waiting->lock);
    waiting->result = *result;
    waiting->is_done = true;
    pthread_cond_signal(&waiting->done);
    pthread_mutex_unlock(&waiting->lock);
}

/* Computes the geodesic distances from one vertex of an asset to all others. Returns an array by vertex, which the caller frees
   (mem_free); NULL on failure. */
static float *distances_from(const struct suggesting *suggesting, struct suggest_asset *part, uint32_t vertex)
{
    const struct suggest_query *query = suggesting->query;
    struct suggest_wait waiting = { .is_done = false };
    const double point_m[3] = { (double)part->at_m[vertex][0], (double)part->at_m[vertex][1], (double)part->at_m[vertex][2] };
    if (!part->mover)
        part->mover = mover_create(query->log, query->workers, query->scene, query->folder, part->asset);
    pthread_mutex_init(&waiting.lock, NULL);
    pthread_cond_init(&waiting.done, NULL);
    if (relocation_request(part->mover, point_m, on_distances, &waiting)) {
        pthread_mutex_lock(&waiting.lock);
        while (!waiting.is_done)
            pthread_cond_wait(&waiting.done, &waiting.lock);
        pthread_mutex_unlock(&waiting.lock);
    }
    pthread_mutex_destroy(&waiting.lock);
    pthread_cond_destroy(&waiting.done);
    return waiting.result.status == RELOCATION_DONE ? waiting.result.geodesic_m : NULL;
}

/* Finds the candidate position with the largest gain, and counts it as a sensor from now on. Returns false if no candidate
   gains more than MIN_GAIN. */
static bool take_best(struct suggesting *suggesting, struct suggestion *out)
{
    size_t count;
    struct candidate *list = find_candidates(suggesting, &count), best = { 0 };
    float *best_m = NULL;
    double most = MIN_GAIN * suggesting->whole_m2;
    for (size_t i = 0; i < count && i < MAX_MEASURED && list[i].bound > most; i++) {
        struct suggest_asset *part = &suggesting->parts[list[i].part];
        float *away_m = distances_from(suggesting, part, list[i].vertex);
        double gain = away_m ? gain_of(suggesting, part, away_m) : 0;
        if (gain > most) {
            float *worse_m = best_m;
            best_m = away_m;
            away_m = worse_m;
            most = gain;
            best = list[i];
        }
        mem_free(away_m);
    }
    mem_free(list);
    if (!best_m)
        return false;
    struct suggest_asset *part = &suggesting->parts[best.part];
    *out = (struct suggestion){ .asset = part->asset };
    measure(suggesting, &out->before, &out->unseen_before);
    for (size_t v = 0; v < part->count; v++)
        part->near_m[v] = fminf(part->near_m[v], best_m[v]);
    measure(suggesting, &out->after, &out->unseen_after);
    for (int c = 0; c < 3; c++)
        out->at_m[c] = (double)part->at_m[best.vertex][c];
    transform_point(suggesting->query->scene->assets[part->asset].placement, out->at_m, out->at_m);
    mem_free(best_m);
    return true;
}

size_t sensor_suggest(const struct suggest_query *query, struct suggestion *out)
{
    const struct plant_group *group = &query->scene->plant->groups[query->group];
    struct suggesting suggesting = { .query = query, .seen_m = group->hot_spot_m * sqrt(-2 * log(PLANT_SEEN_PART)) };
    size_t made = 0;
    bool good = true;
    suggesting.parts = mem_array(query->scene->asset_count, sizeof(*suggesting.parts));
    for (size_t a = 0; a < query->scene->asset_count && good; a++)
        good = (query->asset >= 0 && query->asset != (int)a) || add_part(&suggesting, (int)a);
    if (!good)
        log_err(query->log, "cannot suggest positions for sensors: out of memory");
    while (good && suggesting.part_count > 0 && made < query->count && take_best(&suggesting, &out[made]))
        made++;
    for (size_t p = 0; p < suggesting.part_count; p++) {
        relocation_destroy(&suggesting.parts[p].mover);
        mem_free(suggesting.parts[p].area_m2);
        mem_free(suggesting.parts[p].near_m);
    }
    mem_free(suggesting.parts);
    return made;
}
