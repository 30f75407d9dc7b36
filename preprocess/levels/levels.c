/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Assembles levels of detail from versions (successively simplified copies of the asset). Each level contains, of each part
 * (connected component), the coarsest version that the level's error allows. Near levels are for assets drawn large. Far levels
 * are for assets drawn small, often with many instances in one picture. */
#include "preprocess/levels/levels.h"

#include <math.h>
#include <meshoptimizer.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "preprocess/levels/levels_impl.h"

/* a near level (for assets drawn large) must have at most this share of the previous level's triangles, otherwise it is not made */
#define NEAR_WORTH 0.5
#define FAR LEVELS_FILLING /* minimum error of a far level (for assets drawn small), relative to the asset's size */
/* maximum triangle count of a far level; consecutive far levels may have similar counts (FAR_WORTH), because many instances are
 * drawn in one picture */
#define FAR_TRIANGLES 16000
/* a far level (for assets drawn small) must have at most this share of the previous level's triangles, otherwise it is not made */
#define FAR_WORTH 0.9
#define STEP 1.4       /* minimum factor by which the error grows from one level to the next coarser one */
#define STEP_SMALL 1.7 /* minimum factor by which the error grows after a level whose error is above LEVELS_SMALL */
/* A near level with the error e also includes all events (a part becomes coarser or is omitted) with an error up to WAIT * e,
   so that the next level differs more. After a rejected level with the error e, the next attempt has an error of at least WAIT
   * e. */
#define WAIT 1.1
/* maximum error caused by omitting a part, in multiples of the level's error; if the omission causes more, the part is restored */
#define MISSED 1.05f
/* number of attempts to move corners of flattened faces (levels_facing.c): first in all parts, then only in parts whose error
 * stays within the limit */
#define MAX_TRIES 2

struct levels_making {
    struct workers *workers;
    struct welds welds;
    struct versions versions;
    struct omission *omissions;
    char *used;     /* by vertex: nonzero if the previous level of detail uses the vertex */
    char *contrary; /* by part (connected component): nonzero if a face's winding contradicts its normals (levels_find_contrary()) */
    /* current state of the choice: */
    /* by part (connected component): index of its version (simplification step) in the level being chosen; ABSENT: the part is omitted */
    uint32_t *version;
    /* by part (connected component): index of its version (simplification step) in the last level added; ABSENT: the part is omitted */
    uint32_t *shown;
    size_t tri_count;
};

#define ABSENT VERSIONS_MAX

/* --- events, sorted by error: a part changes to a coarser version or is omitted --------------------------------------- */

struct event {
    float error_m; /* smallest error, in metres, of a level of detail that may contain the part's coarser version or omit the part */
    uint32_t part, version;
};

static int smallest_first(const void *a, const void *b)
{
    const struct event *p = a, *q = b;
    if (p->error_m != q->error_m)
        return p->error_m < q->error_m ? -1 : 1;
    return p->part != q->part ? (p->part < q->part ? -1 : 1) : p->version < q->version ? -1 : p->version > q->version;
}

static size_t list_events(const struct levels_making *making, struct event *events)
{
    double most_m = LEVELS_FARTHEST * making->welds.whole_m;
    size_t count = 0;
    for (uint32_t p = 0; p < making->welds.part_count; p++) {
        for (uint32_t v = 1; v < making->versions.count; v++)
            if ((double)making->versions.at[v].error_m[p] <= most_m && making->versions.at[v].tris[p] < making->versions.at[v - 1].tris[p])
                events[count++] = (struct event){ making->versions.at[v].error_m[p], p, v };
        if ((double)making->omissions[p].from_m <= most_m)
            events[count++] = (struct event){ making->omissions[p].from_m, p, ABSENT };
    }
    qsort(events, count, sizeof(*events), smallest_first);
    return count;
}

static size_t tris_of(const struct levels_making *making, uint32_t part)
{
    return making->version[part] == ABSENT ? 0 : making->versions.at[making->version[part]].tris[part];
}

static void let_happen(struct levels_making *making, const struct event *event)
{
    if (making->version[event->part] >= event->version)
        return;
    making->tri_count -= tris_of(making, event->part);
    making->version[event->part] = event->version;
    making->tri_count += tris_of(making, event->part);
}

/* Applies events[i] (changes of parts) and the following ones up to the error error_m. Returns the index of the first event not applied. */
static size_t let_all_happen(struct levels_making *making, const struct event *events, size_t i, size_t count, float error_m)
{
    for (; i < count && events[i].error_m <= error_m; i++)
        let_happen(making, &events[i]);
    return i;
}

/* --- one level ------------------------------------------------------------------------------------------------------------ */

/* Replaces welds (groups of equal vertices) by vertices and writes the level's triangles, primitive by primitive in the
 * geometry's order. */
static void write_level(struct levels_making *making, struct level *level, const uint32_t *welds, size_t count)
{
    const struct geometry *g = making->welds.geometry;
    uint32_t *fill = mem_array(g->primitive_count + 1u, sizeof(*fill));
    level->indices = mem_array(count, sizeof(*level->indices));
    level->primitives = mem_array(g->primitive_count, sizeof(*level->primitives));
    level->index_count = (uint32_t)count;
    level->whole_count = (uint32_t)count;
    for (size_t i = 0; i < count; i += 3)
        fill[making->welds.primitive[welds[i]] + 1] += 3;
    for (uint32_t p = 0; p < g->primitive_count; p++) {
        if (fill[p + 1])
            level->primitives[level->primitive_count++] = (struct asset_primitive){
                .first_index = fill[p], .index_count = fill[p + 1], .material = g->primitives[p].material, .name = g->primitives[p].name
            };
        fill[p + 1] += fill[p];
    }
    for (size_t i = 0; i < count; i += 3) {
        float n[3];
        uint32_t *at = &fill[making->welds.primitive[welds[i]]];
        levels_normal(&making->welds, welds + i, n);
        for (size_t c = 0; c < 3; c++)
            level->indices[(*at)++] = levels_vertex(&making->welds, making->used, welds[i + c], n, false);
    }
    memset(making->used, 0, g->vertex_count);
    for (uint32_t i = 0; i < level->index_count; i++)
        making->used[level->indices[i]] = 1;
    for (uint32_t p = 0; p < level->primitive_count; p++)
        meshopt_optimizeVertexCache(level->indices + level->primitives[p].first_index, level->indices + level->primitives[p].first_index,
                                    level->primitives[p].index_count, g->vertex_count);
    mem_free(fill);
}

/* Measures the error of omitting parts (connected components) that lay on other parts: the largest distance from the omitted
 * surface to the surface that is visible in its place. Raises apart_m of these parts to that distance. */
static void measure_lost(const struct levels_making *making, const uint32_t *welds, size_t count, double expected_m, float *apart_m)
{
    const struct welds *of = &making->welds;
    struct deviation level;
    char *lost = mem_array(of->part_count, 1), any = 0;
    for (uint32_t p = 0; p < of->part_count; p++)
        any |= lost[p] = making->version[p] == ABSENT && !making->omissions[p].alone;
    if (any) {
        deviation_init(&level,
                       &(struct deviation_params){ .positions_m = (const float(*)[3])of->positions_m,
                                                   .first_there = of->first_there,
                                                   .part = of->part,
                                                   .part_count = of->part_count,
                                                   .anywhere = true },
                       welds, count / 3);
        deviation_measure_lost(&making->versions.first, &level, lost, expected_m, apart_m, making->workers);
        deviation_finish(&level);
    }
    mem_free(lost);
}

/* Returns the largest error of any part in its current version (simplification step), in metres. Ignores omitted parts that lay
 * on other parts: measure_lost() measures these. */
static float error_of_parts(const struct levels_making *making)
{
    float most_m = 0;
    for (uint32_t p = 0; p < making->welds.part_count; p++)
        if (making->version[p] != ABSENT)
            most_m = fmaxf(most_m, making->versions.at[making->version[p]].error_m[p]);
        else if (making->omissions[p].alone)
            most_m = fmaxf(most_m, making->omissions[p].from_m);
    return most_m;
}

/* Moves corners of flattened faces (levels_facing.c). If this raises a part's error above limit_m, sets most_m[part] to 0, so
 * that the next attempt skips the part. Returns whether any part must be skipped. */
static bool try_facing(const struct levels_making *making, uint32_t *welds, size_t count, float limit_m, float *most_m)
{
    const struct welds *of = &making->welds;
    float *apart_m = mem_array(of->part_count, sizeof(*apart_m));
    char *moved = mem_array(of->part_count, 1), any = 0;
    if (levels_face(of, making->used, making->contrary, most_m, welds, count, moved)) {
        struct deviation level;
        const struct deviation *first = &making->versions.first;
        levels_surface(&level, of, moved, welds, count);
        deviation_measure(&level, first, moved, (double)limit_m, apart_m, making->workers);
        deviation_measure(first, &level, moved, (double)limit_m, apart_m, making->workers);
        deviation_finish(&level);
        for (uint32_t p = 0; p < of->part_count; p++)
            if (apart_m[p] > limit_m) {
                most_m[p] = 0;
                any = 1;
            }
    }
    mem_free(apart_m);
    mem_free(moved);
    return any;
}

/* Moves corners of flattened faces (levels_facing.c), but only in parts whose error stays within limit_m. */
static void face_parts(const struct levels_making *making, uint32_t *welds, size_t count, float limit_m)
{
    float *most_m = mem_array(making->welds.part_count, sizeof(*most_m));
    uint32_t *before = mem_array(count, sizeof(*before));
    memcpy(before, welds, count * sizeof(*before));
    for (uint32_t p = 0; p < making->welds.part_count; p++)
        most_m[p] = making->version[p] == ABSENT ? 0 : making->versions.at[making->version[p]].error_m[p];
    for (int i = 0; i < MAX_TRIES && try_facing(making, welds, count, limit_m, most_m); i++)
        memcpy(welds, before, count * sizeof(*before));
    mem_free(most_m);
    mem_free(before);
}

/* Returns the triangles of all parts, each in its current version (simplification step): three welds (groups of equal vertices) per
 * triangle, *count in total. The caller frees the array. */
static uint32_t *list_welds(const struct levels_making *making, size_t *count)
{
    uint32_t *welds = mem_array(3 * making->tri_count, sizeof(*welds));
    *count = 0;
    for (uint32_t v = 0; v < making->versions.count; v++) {
        const struct version *version = &making->versions.at[v];
        for (size_t i = 0; i < version->count; i += 3)
            if (making->version[making->welds.part[version->welds[i]]] == v) {
                memcpy(welds + *count, version->welds + i, 3 * sizeof(*welds));
                *count += 3;
            }
    }
    return welds;
}

/* Returns the index of the coarsest version (simplification step) of a part whose error is at most error_m. The result is never finer than
 * the part's version in the last level. */
static uint32_t version_within(const struct levels_making *making, uint32_t part, float error_m)
{
    uint32_t best = making->shown[part];
    for (uint32_t v = best + 1; v < making->versions.count; v++)
        if (making->versions.at[v].error_m[part] <= error_m)
            best = v;
    return best;
}

/* Restores omitted parts whose omission causes more than MISSED times the level's error (apart_m), because the surface under
 * them has moved away. Sets back[part] for these parts. Returns whether any part was restored. */
static bool bring_back(struct levels_making *making, const float *apart_m, float error_m, char *back)
{
    bool any = false;
    for (uint32_t p = 0; p < making->welds.part_count; p++)
        if (apart_m[p] > MISSED * error_m && making->shown[p] != ABSENT) {
            making->version[p] = version_within(making, p, error_m);
            making->tri_count += tris_of(making, p);
            back[p] = 1;
            any = true;
        }
    return any;
}

/* Returns the minimum error of the level of detail after `last`, in metres. */
static double step_m(const struct levels_making *making, const struct level *last)
{
    double last_m = (double)last->error_m;
    return last_m * (last_m > LEVELS_SMALL * making->welds.whole_m ? STEP_SMALL : STEP);
}

static bool is_far(const struct levels_making *making, const struct level *last, float error_m)
{
    return making->tri_count <= FAR_TRIANGLES && fmax((double)error_m, step_m(making, last)) >= FAR * making->welds.whole_m;
}

/* Returns whether the parts in their current versions (simplification steps) have few enough triangles to justify another level
 * after `last`. */
static bool is_worth(const struct levels_making *making, const struct level *last, float error_m)
{
    double before = (double)(last->index_count / 3), now = (double)making->tri_count;
    return now <= (is_far(making, last, error_m) ? FAR_WORTH : NEAR_WORTH) * before;
}

/* Adds a level of detail with the parts in their current versions (simplification steps). *error_out_m receives the level's
 * error. Restores parts that earlier levels omitted as too small if the level would otherwise look wrong. Returns false without
 * adding the level if the restored parts bring its triangle count too close to the previous level's. */
static bool add_level(struct levels_making *making, struct levels *levels, float *error_out_m)
{
    size_t count, parts = making->welds.part_count;
    float *apart_m = mem_array(parts, sizeof(*apart_m)), error_m = error_of_parts(making);
    char *back = mem_array(parts, 1);
    const struct level *last = &levels->at[levels->count - 1];
    uint32_t *welds = list_welds(making, &count);
    measure_lost(making, welds, count, (double)error_m, apart_m);
    if (bring_back(making, apart_m, error_m, back)) {
        mem_free(welds);
        welds = list_welds(making, &count);
    }
    for (size_t p = 0; p < parts; p++)
        error_m = fmaxf(error_m, back[p] ? 0 : apart_m[p]);
    error_m = fmaxf(error_m, last->error_m);
    *error_out_m = error_m;
    const bool added = is_worth(making, last, error_m);
    if (added) {
        struct level *level = &levels->at[levels->count++];
        level->error_m = error_m;
        face_parts(making, welds, count, error_m);
        write_level(making, level, welds, count);
        memcpy(making->shown, making->version, parts * sizeof(*making->shown));
    }
    for (uint32_t p = 0; p < parts; p++)
        if (back[p])
            let_happen(making, &(struct event){ .part = p, .version = ABSENT });
    mem_free(welds);
    mem_free(apart_m);
    mem_free(back);
    return added;
}

/* --- all ------------------------------------------------------------------------------------------------------------------ */

static void copy_finest(struct level *level, const struct geometry *g)
{
    *level = (struct level){ .index_count = g->index_count, .whole_count = g->index_count, .primitive_count = g->primitive_count };
    level->indices = mem_array(g->index_count, sizeof(*level->indices));
    level->primitives = mem_array(g->primitive_count, sizeof(*level->primitives));
    memcpy(level->indices, g->indices, g->index_count * sizeof(*level->indices));
    memcpy(level->primitives, g->primitives, g->primitive_count * sizeof(*level->primitives));
}

static void make_coarse(struct levels_making *making, struct levels *levels)
{
    struct event *events = mem_array(making->welds.part_count * (making->versions.count + 1), sizeof(*events));
    size_t count = list_events(making, events);
    /* waited_m: minimum error of the next attempt after a rejected level of detail, metres; 0: the last attempt was accepted */
    float error_m, waited_m = 0;
    making->used = mem_array(making->welds.geometry->vertex_count, 1);
    making->version = mem_array(making->welds.part_count, sizeof(*making->version));
    making->shown = mem_array(making->welds.part_count, sizeof(*making->shown));
    memset(making->used, 1, making->welds.geometry->vertex_count);
    making->contrary = mem_array(making->welds.part_count, 1);
    levels_find_contrary(&making->welds, making->contrary);
    for (size_t i = 0; i < count && levels->count < LEVELS_MAX;) {
        const struct level *last = &levels->at[levels->count - 1];
        i = let_all_happen(making, events, i, count, fmaxf((float)step_m(making, last), waited_m));
        for (error_m = last->error_m; i < count && !is_worth(making, last, error_m); error_m = events[i++].error_m)
            let_happen(making, &events[i]);
        if (!is_far(making, last, error_m))
            i = let_all_happen(making, events, i, count, (float)WAIT * error_m);
        if (making->tri_count == 0 || !is_worth(making, last, error_m))
            break;
        waited_m = 0;
        if (!add_level(making, levels, &error_m) && i < count)
            waited_m = fmaxf((float)WAIT * error_m, events[i].error_m);
    }
    mem_free(events);
}

bool levels_make(struct levels *levels, const struct geometry *geometry, struct workers *workers)
{
    struct levels_making making = { .workers = workers, .tri_count = geometry->index_count / 3 };
    *levels = (struct levels){ .count = 1 };
    bool good = welds_init(&making.welds, geometry);
    if (good) {
        copy_finest(&levels->at[0], geometry);
        making.omissions = mem_array(making.welds.part_count, sizeof(*making.omissions));
        versions_make(&making.versions, &making.welds, workers);
        levels->repeated = making.tri_count - making.versions.first.mesh.tri_count;
        omissions_find(making.omissions, &making.welds, workers);
        make_coarse(&making, levels);
    }
    versions_finish(&making.versions);
    welds_finish(&making.welds);
    mem_free(making.omissions);
    mem_free(making.used);
    mem_free(making.contrary);
    mem_free(making.version);
    mem_free(making.shown);
    return good;
}

void level_finish(struct level *level)
{
    mem_free(level->indices);
    mem_free(level->primitives);
    *level = (struct level){ 0 };
}

void levels_finish(struct levels *levels)
{
    for (size_t i = 0; i < levels->count; i++)
        level_finish(&levels->at[i]);
    *levels = (struct levels){ 0 };
}
