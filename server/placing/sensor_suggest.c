/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Suggests positions for new sensors. The surface is represented by points: the vertices, and points inside large faces (triangles
   of the finest level of detail). Candidate positions are sorted by an upper bound of their gain. The bound uses
   straight-line distances, which are never longer than geodesic ones. So only the candidates with the highest bounds need
   geodesic distances, if the group uses these. */
#include "placing/sensor_suggest.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>

#include "base/mem.h"
#include "field/kernels.h"
#include "field/layout.h"
#include "placing/face_piece.h"
#include "placing/mover.h"
#include "plant/influence.h"
#include "plant/models/transform.h"

/* maximum number of candidate positions per asset, spread evenly over the area where hot spots are hard to detect */
#define MAX_CANDIDATES 1500
/* maximum number of candidates per suggestion, those with the highest bounds, for which geodesic distances are computed */
#define MAX_MEASURED 40
/* minimum gain for which a new sensor is suggested: reduction of the measure of how hard hot spots are to detect
   (sensor_suggest.h) */
#define MIN_GAIN 1e-6

/* longest side of a piece of a face that one point represents, as a part of the distance within which a sensor detects a hot spot
   as strong as the group's full value range. The sides are longer if an asset would need more than MAX_POINTS points. */
#define PIECE_PART 0.2
enum { MAX_POINTS = 100000 };

struct suggest_asset { /* an asset on which sensors may be suggested */
    int asset;
    struct field_layout *layout; /* sensors of the group that count in the view `show: blind` */
    struct layout_points inside; /* points inside faces */
    /* number of points that represent the surface: the asset's vertices, then the points inside faces */
    size_t count, vertex_count;
    float (*at_m)[3];
    double *area_m2, whole_m2;
    float *near_m;            /* by point: distance in metres to the nearest sensor, including suggested ones */
    struct relocation *mover; /* computes geodesic distances on the asset; NULL: not needed yet, or not at all (straight lines) */
};

struct candidate {
    size_t part;
    size_t point;
    /* upper bound of the gain of a sensor at this point: reduction of the measure of how hard hot spots are to detect
       (sensor_suggest.h) times the area in square metres */
    double bound;
};

struct suggesting {
    const struct suggest_query *query;
    enum distance_mode mode; /* distances of the view `show: blind` */
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

/* --- points that represent the surface --------------------------------------------------------------------------------------- */

struct face_split { /* division of large faces into pieces */
    struct suggest_asset *part;
    double longest_m; /* longest side of a piece */
    size_t count;     /* number of pieces of large faces so far */
    bool store;       /* store the middle of each piece as a point; false: count only */
};

/* Halves the piece until no side is longer than split->longest_m. Counts or stores the resulting pieces. */
static void split_piece(struct face_split *split, const uint32_t face[3], const struct face_piece *piece, const double at_m[3][3],
                        double area_m2)
{
    double sides_m[3];
    for (int k = 0; k < 3; k++)
        sides_m[k] = vec_distance(at_m[k], at_m[(k + 1) % 3]);
    int side = sides_m[0] >= max_of(sides_m[1], sides_m[2]) ? 0 : sides_m[1] >= sides_m[2] ? 1 : 2, next = (side + 1) % 3;
    if (sides_m[side] > split->longest_m && split->count <= MAX_POINTS) {
        struct face_piece halves[2];
        double half_m[3][3];
        face_piece_halve(piece, side, halves);
        for (int h = 0; h < 2; h++) {
            memcpy(half_m, at_m, sizeof(half_m));
            vec_mix(at_m[side], at_m[next], 0.5, half_m[h == 0 ? next : side]);
            split_piece(split, face, &halves[h], half_m, area_m2 / 2);
        }
        return;
    }
    if (split->store) {
        const struct suggest_asset *part = split->part;
        float middle[3];
        face_piece_middle(piece, middle);
        layout_set_point(&part->layout->file->view, &part->inside, split->count, face, middle);
        memcpy(part->at_m[part->vertex_count + split->count], part->inside.positions_m[split->count], sizeof(*part->at_m));
        part->area_m2[part->vertex_count + split->count] = area_m2;
    }
    split->count++;
}

/* Counts the points inside faces or, if split->store is true, stores them and the area that each point represents. The corners of
   a face that is not divided represent a third of its area each. */
static void split_faces(struct face_split *split)
{
    const struct asset_view *view = &split->part->layout->file->view;
    size_t count;
    const uint32_t(*faces)[3] = face_list(view, &count);
    split->count = 0;
    for (size_t i = 0; i < count && split->count <= MAX_POINTS; i++) {
        double at_m[3][3], area_m2 = face_area(view, faces[i]), longest_m = 0;
        for (int k = 0; k < 3; k++)
            for (int c = 0; c < 3; c++)
                at_m[k][c] = (double)view->positions_m[faces[i][k]][c];
        for (int k = 0; k < 3; k++)
            longest_m = max_of(longest_m, vec_distance(at_m[k], at_m[(k + 1) % 3]));
        if (longest_m > split->longest_m && area_m2 > 0)
            split_piece(split, faces[i], &face_whole, at_m, area_m2);
        else
            for (int k = 0; split->store && k < 3; k++)
                split->part->area_m2[faces[i][k]] += area_m2 / 3;
    }
}

/* Stores the points that represent the asset's surface. Returns false if memory ran out. */
static bool make_points(const struct suggesting *suggesting, struct suggest_asset *part)
{
    const struct asset_view *view = &part->layout->file->view;
    struct face_split split = { .part = part, .longest_m = PIECE_PART * suggesting->seen_m };
    for (split_faces(&split); split.count > MAX_POINTS; split_faces(&split))
        split.longest_m *= 1.25;
    size_t inside = split.count;
    part->vertex_count = part->layout->vertex_count;
    part->count = part->vertex_count + inside;
    part->at_m = mem_try_array(part->count, sizeof(*part->at_m));
    part->area_m2 = mem_try_array(part->count, sizeof(*part->area_m2));
    part->near_m = mem_try_array(part->count, sizeof(*part->near_m));
    part->inside =
        (struct layout_points){ mem_array(inside, sizeof(*part->inside.positions_m)), mem_array(inside, sizeof(*part->inside.corners)),
                                mem_array(inside, sizeof(*part->inside.parts)), mem_array(inside, sizeof(*part->inside.away_m)) };
    if (!part->at_m || !part->area_m2 || !part->near_m)
        return false;
    memcpy(part->at_m, view->positions_m, part->vertex_count * sizeof(*part->at_m));
    split.store = true;
    split_faces(&split);
    return true;
}

/* Lowers near_m, an array by point, to the distances from one sensor of the layout, where these are smaller. */
static void take_nearest(const struct suggest_asset *part, const struct field_layout *layout, enum distance_mode mode, size_t sensor,
                         float *near_m)
{
    struct field_layout inside = *layout;
    float room[KERNEL_BLOCK];
    inside.points = &part->inside;
    for (size_t at = 0, count, end; at < part->count; at += count) {
        bool is_vertex = at < part->vertex_count;
        size_t begin = is_vertex ? at : at - part->vertex_count;
        end = is_vertex ? part->vertex_count : part->count;
        count = end - at < KERNEL_BLOCK ? end - at : KERNEL_BLOCK;
        kernel_nearest(layout_distances(is_vertex ? layout : &inside, mode, sensor, begin, count, room), count, near_m + at);
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
    /* the view `show: blind` replaces interpolations computed by plantcast-prep by shepard */
    layout_remove_ineffective(layout, interpolation_is_prepared(layout->group->interpolation) ? INTERPOLATION_SHEPARD
                                                                                              : layout->group->interpolation);
    struct suggest_asset *part = &suggesting->parts[suggesting->part_count++];
    *part = (struct suggest_asset){ .asset = asset, .layout = layout };
    if (!make_points(suggesting, part))
        return false;
    for (size_t p = 0; p < part->count; p++) {
        part->near_m[p] = INFINITY;
        part->whole_m2 += part->area_m2[p];
    }
    for (size_t i = 0; i < layout->sensor_count; i++)
        take_nearest(part, layout, suggesting->mode, i, part->near_m);
    suggesting->whole_m2 += part->whole_m2;
    return true;
}

static void remove_part(struct suggest_asset *part)
{
    relocation_destroy(&part->mover);
    layout_destroy(&part->layout);
    mem_free(part->inside.positions_m);
    mem_free(part->inside.corners);
    mem_free(part->inside.parts);
    mem_free(part->inside.away_m);
    mem_free(part->at_m);
    mem_free(part->area_m2);
    mem_free(part->near_m);
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
        const float *from = part->at_m[candidate->point];
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
        for (size_t v = 0; v < part->count && whole > 0; v++) {
            passed += part->area_m2[v] * unseen(suggesting, (double)part->near_m[v]);
            if (passed <= next)
                continue;
            list[(*count)++] = (struct candidate){ .part = p, .point = v };
            while (next < passed)
                next += whole / MAX_CANDIDATES;
        }
    }
    struct bounding bounding = { suggesting, list };
    workers_for(suggesting->query->workers, *count, 4, bound_some, &bounding);
    qsort(list, *count, sizeof(*list), by_bound);
    return list;
}

/* --- distances from a candidate ---------------------------------------------------------------------------------------------- */

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

/* Computes the distances along the surface from one point of an asset to all vertices. Returns an array by vertex, which the
   caller frees (mem_free); NULL on failure. */
static float *geodesic_from(const struct suggesting *suggesting, struct suggest_asset *part, size_t point)
{
    const struct suggest_query *query = suggesting->query;
    struct suggest_wait waiting = { .is_done = false };
    const double point_m[3] = { (double)part->at_m[point][0], (double)part->at_m[point][1], (double)part->at_m[point][2] };
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
    return waiting.result.geodesic_m;
}

/* Computes the distances from one point of an asset to all points that represent its surface. Returns an array by point, which
   the caller frees (mem_free); NULL on failure. */
static float *distances_from(const struct suggesting *suggesting, struct suggest_asset *part, size_t point)
{
    const bool along = suggesting->mode != DISTANCE_EUCLIDEAN;
    float *geodesic_m = along ? geodesic_from(suggesting, part, point) : NULL;
    float *away_m = geodesic_m || !along ? mem_try_array(part->count, sizeof(*away_m)) : NULL;
    if (away_m) {
        struct layout_sensor sensor = { .tried = true, .tried_m = geodesic_m };
        memcpy(sensor.surface_m, part->at_m[point], sizeof(sensor.surface_m));
        struct field_layout layout = *part->layout;
        layout.sensors = &sensor;
        layout.sensor_count = 1;
        for (size_t p = 0; p < part->count; p++)
            away_m[p] = INFINITY;
        take_nearest(part, &layout, suggesting->mode, 0, away_m);
    }
    mem_free(geodesic_m);
    return away_m;
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
        float *away_m = distances_from(suggesting, part, list[i].point);
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
        out->at_m[c] = (double)part->at_m[best.point][c];
    transform_point(suggesting->query->scene->assets[part->asset].placement, out->at_m, out->at_m);
    mem_free(best_m);
    return true;
}

size_t sensor_suggest(const struct suggest_query *query, struct suggestion *out)
{
    const struct plant_group *group = &query->scene->plant->groups[query->group];
    struct suggesting suggesting = { .query = query,
                                     .mode = interpolation_distance(group->interpolation, group->distance),
                                     .seen_m = group->hot_spot_m * sqrt(-2 * log(PLANT_SEEN_PART)) };
    size_t made = 0;
    bool good = true;
    suggesting.parts = mem_array(query->scene->asset_count, sizeof(*suggesting.parts));
    for (size_t a = 0; a < query->scene->asset_count && good; a++)
        good = (query->asset >= 0 && query->asset != (int)a) || add_part(&suggesting, (int)a);
    if (!good)
        log_err(query->log, "cannot suggest positions for sensors: out of memory");
    while (good && suggesting.part_count > 0 && made < query->count && take_best(&suggesting, &out[made]))
        made++;
    for (size_t p = 0; p < suggesting.part_count; p++)
        remove_part(&suggesting.parts[p]);
    mem_free(suggesting.parts);
    return made;
}
