/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A surface made in the background, and walks on it for whoever asks. */
#include "surface/mover.h"

#include <math.h>
#include <pthread.h>
#include <string.h>

#include "base/kept.h"
#include "base/mem.h"
#include "base/vec.h"
#include "surface/anchors.h"
#include "surface/bvh.h"
#include "surface/surface_store.h"

struct ask {
    uint64_t ticket;
    double point_m[3];
    struct mover_place place;
    void (*done)(void *arg, struct mover_result *result);
    void *arg;
    struct ask *next;
    /* --- below: under the mover's lock */
    bool running, cancelled;
};

struct mover {
    struct log *log;
    struct workers *workers;
    struct mover_shape shape;
    char *surface_path;
    double size_m;
    pthread_mutex_t lock;
    pthread_cond_t idle;
    /* --- below: under lock */
    enum mover_state state;
    struct surface *surface; /* once warm: read by walks, without the lock */
    struct anchors *anchors; /* likewise; NULL: the surface's vertices are the shape's */
    struct ask *asks;        /* waiting or running, oldest first */
    uint64_t last_ticket;
    size_t jobs; /* submitted, and not through */
};

static void corner(const struct mover_shape *shape, size_t t, size_t i, double out[3])
{
    const float *p = shape->positions_m[shape->triangles[3 * t + i]];
    for (int axis = 0; axis < 3; axis++)
        out[axis] = (double)p[axis];
}

static double size_of(const struct mover_shape *shape)
{
    double low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY, -INFINITY }, p[3];
    for (size_t t = 0; t < shape->triangle_count; t++)
        for (size_t i = 0; i < 3; i++) {
            corner(shape, t, i, p);
            for (int axis = 0; axis < 3; axis++) {
                low[axis] = min_of(low[axis], p[axis]);
                high[axis] = max_of(high[axis], p[axis]);
            }
        }
    return shape->triangle_count ? vec_distance(low, high) : 0;
}

/* --- places ----------------------------------------------------------------------------------------------------------------- */

/* Without the surface: all triangles are tried, which takes some milliseconds. */
static bool drop(const struct mover *mover, const double point_m[3], struct mover_place *place)
{
    double best_m = mover->size_m;
    bool found = false;
    for (size_t t = 0; t < mover->shape.triangle_count; t++) {
        double corners[3][3], w[3], at[3];
        for (size_t i = 0; i < 3; i++)
            corner(&mover->shape, t, i, corners[i]);
        if (triangle_is_farther(point_m, corners[0], corners[1], corners[2], best_m))
            continue;
        triangle_nearest(point_m, corners[0], corners[1], corners[2], w);
        for (int axis = 0; axis < 3; axis++)
            at[axis] = w[0] * corners[0][axis] + w[1] * corners[1][axis] + w[2] * corners[2][axis];
        double distance_m = vec_distance(at, point_m);
        if (!(distance_m < best_m))
            continue;
        size_t nearest = w[0] >= w[1] && w[0] >= w[2] ? 0 : w[1] >= w[2] ? 1 : 2;
        best_m = distance_m;
        found = true;
        *place = (struct mover_place){ .distance_m = distance_m, .vertex = mover->shape.triangles[3 * t + nearest] };
        memcpy(place->surface_m, at, sizeof(at));
    }
    return found;
}

static uint32_t nearest_vertex(const struct mover_shape *shape, const double point_m[3])
{
    double best2 = INFINITY;
    uint32_t best = 0;
    for (size_t v = 0; v < shape->vertex_count; v++) {
        const float *p = shape->positions_m[v];
        double d2 = vec_distance2((const double[3]){ (double)p[0], (double)p[1], (double)p[2] }, point_m);
        if (d2 < best2) {
            best2 = d2;
            best = (uint32_t)v;
        }
    }
    return best;
}

static bool find_place(const struct mover *mover, const struct surface *surface, const double point_m[3], struct mover_place *place)
{
    struct surface_spot at;
    if (!isfinite(point_m[0]) || !isfinite(point_m[1]) || !isfinite(point_m[2]))
        return false;
    if (!surface)
        return drop(mover, point_m, place);
    surface_find_spot(surface, point_m, NULL, &at);
    *place = (struct mover_place){ .distance_m = at.distance_m, .vertex = nearest_vertex(&mover->shape, at.point_m) };
    memcpy(place->surface_m, at.point_m, sizeof(at.point_m));
    return at.distance_m < mover->size_m;
}

/* --- the surface ------------------------------------------------------------------------------------------------------------ */

static struct ask *take(struct mover *mover, uint64_t ticket)
{
    for (struct ask **at = &mover->asks; *at; at = &(*at)->next)
        if ((*at)->ticket == ticket) {
            struct ask *ask = *at;
            *at = ask->next;
            return ask;
        }
    return NULL;
}

static void answer(struct ask *ask, enum mover_status status, float *geodesic_m)
{
    struct mover_result result = { .status = status, .ticket = ask->ticket, .place = ask->place, .geodesic_m = geodesic_m };
    ask->done(ask->arg, &result);
    mem_free(ask);
}

static void end_job(struct mover *mover)
{
    pthread_mutex_lock(&mover->lock);
    if (--mover->jobs == 0)
        pthread_cond_broadcast(&mover->idle);
    pthread_mutex_unlock(&mover->lock);
}

/* The oldest ask that nobody has begun; NULL: it was cancelled meanwhile. */
static struct ask *begin_ask(struct mover *mover)
{
    pthread_mutex_lock(&mover->lock);
    struct ask *ask = mover->asks;
    while (ask && ask->running)
        ask = ask->next;
    if (ask)
        ask->running = true;
    pthread_mutex_unlock(&mover->lock);
    return ask;
}

static bool find_distances(const struct mover *mover, const double surface_m[3], float *geodesic_m)
{
    return mover->anchors ? anchors_distances(mover->anchors, surface_m, geodesic_m)
                          : surface_distances(mover->surface, (const double(*)[3])surface_m, 1, geodesic_m);
}

static void walk(void *arg)
{
    struct mover *mover = arg;
    struct ask *ask = begin_ask(mover);
    if (ask) {
        enum mover_status status = mover->surface ? MOVER_NO_MEMORY : MOVER_NO_SURFACE;
        float *geodesic_m = mover->surface ? mem_try_array(mover->shape.vertex_count, sizeof(*geodesic_m)) : NULL;
        if (geodesic_m && find_place(mover, mover->surface, ask->point_m, &ask->place) &&
            find_distances(mover, ask->place.surface_m, geodesic_m))
            status = MOVER_DONE;
        pthread_mutex_lock(&mover->lock);
        take(mover, ask->ticket);
        status = ask->cancelled ? MOVER_CANCELLED : status;
        pthread_mutex_unlock(&mover->lock);
        if (status != MOVER_DONE) {
            mem_free(geodesic_m);
            geodesic_m = NULL;
        }
        answer(ask, status, geodesic_m);
    }
    end_job(mover);
}

/* NULL: there is none that is any good. */
static struct surface *read_surface(const struct mover *mover, struct anchors **anchors)
{
    struct kept kept = { 0 };
    struct surface *surface = NULL;
    *anchors = NULL;
    if (mover->surface_path && kept_open(&kept, mover->surface_path, SURFACE_MAGIC, mover->shape.surface_key))
        surface = surface_unpack(&(struct unpack){ kept.bytes, kept.count, false }, mover->log, mover->workers);
    kept_close(&kept);
    if (surface)
        *anchors = anchors_create(surface, mover->shape.positions_m, mover->shape.normals, mover->shape.vertex_count,
                                  mover->shape.triangles, mover->shape.triangle_count);
    if (surface && !*anchors)
        surface_destroy(&surface);
    return surface;
}

static void warm(void *arg)
{
    struct mover *mover = arg;
    const struct mover_shape *shape = &mover->shape;
    struct anchors *anchors;
    struct surface *surface = read_surface(mover, &anchors);
    size_t waiting = 0;
    if (!surface)
        surface = surface_create(mover->log, mover->workers, shape->positions_m, shape->vertex_count, shape->triangles,
                                 shape->triangle_count, &(struct surface_params){ .tolerance_m = shape->tolerance_m });
    pthread_mutex_lock(&mover->lock);
    mover->surface = surface;
    mover->anchors = anchors;
    mover->state = surface ? MOVER_WARM : MOVER_BROKEN;
    for (const struct ask *ask = mover->asks; ask; ask = ask->next)
        waiting++;
    mover->jobs += waiting;
    pthread_mutex_unlock(&mover->lock);
    for (; waiting; waiting--)
        workers_submit(mover->workers, walk, mover);
    end_job(mover);
}

struct mover *mover_create(struct log *log, struct workers *workers, const struct mover_shape *shape)
{
    struct mover *mover = mem_new(sizeof(*mover));
    *mover = (struct mover){ .log = log, .workers = workers, .shape = *shape, .size_m = size_of(shape), .jobs = 1 };
    mover->surface_path = shape->surface_path ? mem_strdup(shape->surface_path) : NULL;
    pthread_mutex_init(&mover->lock, NULL);
    pthread_cond_init(&mover->idle, NULL);
    workers_submit(workers, warm, mover);
    return mover;
}

void mover_destroy(struct mover **mover_ptr)
{
    struct mover *mover = *mover_ptr;
    if (!mover)
        return;
    pthread_mutex_lock(&mover->lock);
    struct ask *waiting = NULL, **last = &waiting;
    for (struct ask **at = &mover->asks; *at;) {
        struct ask *ask = *at;
        ask->cancelled = true;
        if (ask->running) {
            at = &ask->next;
            continue;
        }
        *at = ask->next;
        ask->next = NULL;
        *last = ask;
        last = &ask->next;
    }
    while (mover->jobs)
        pthread_cond_wait(&mover->idle, &mover->lock);
    pthread_mutex_unlock(&mover->lock);
    while (waiting) {
        struct ask *ask = waiting;
        waiting = ask->next;
        answer(ask, MOVER_CANCELLED, NULL);
    }
    anchors_destroy(&mover->anchors);
    surface_destroy(&mover->surface);
    mem_free(mover->surface_path);
    pthread_mutex_destroy(&mover->lock);
    pthread_cond_destroy(&mover->idle);
    mem_free(mover);
    *mover_ptr = NULL;
}

enum mover_state mover_state(struct mover *mover)
{
    pthread_mutex_lock(&mover->lock);
    enum mover_state state = mover->state;
    pthread_mutex_unlock(&mover->lock);
    return state;
}

/* --- asking ------------------------------------------------------------------------------------------------------------------- */

bool mover_place(struct mover *mover, const double point_m[3], struct mover_place *place, float *euclidean_m)
{
    pthread_mutex_lock(&mover->lock);
    const struct surface *surface = mover->surface;
    pthread_mutex_unlock(&mover->lock);
    if (!find_place(mover, surface, point_m, place))
        return false;
    for (size_t v = 0; euclidean_m && v < mover->shape.vertex_count; v++) {
        const float *p = mover->shape.positions_m[v];
        euclidean_m[v] = (float)vec_distance((const double[3]){ (double)p[0], (double)p[1], (double)p[2] }, place->surface_m);
    }
    return true;
}

uint64_t mover_ask(struct mover *mover, const double point_m[3], void (*done)(void *arg, struct mover_result *result), void *arg)
{
    struct mover_place place;
    if (!mover_place(mover, point_m, &place, NULL))
        return 0;
    struct ask *ask = mem_new(sizeof(*ask)), **last;
    *ask = (struct ask){ .point_m = { point_m[0], point_m[1], point_m[2] }, .place = place, .done = done, .arg = arg };
    pthread_mutex_lock(&mover->lock);
    uint64_t ticket = ask->ticket = ++mover->last_ticket;
    for (last = &mover->asks; *last; last = &(*last)->next)
        ;
    *last = ask;
    bool now = mover->state != MOVER_WARMING;
    mover->jobs += now;
    pthread_mutex_unlock(&mover->lock);
    if (now)
        workers_submit(mover->workers, walk, mover);
    return ticket;
}

void mover_cancel(struct mover *mover, uint64_t ticket)
{
    pthread_mutex_lock(&mover->lock);
    struct ask *ask = mover->asks;
    while (ask && ask->ticket != ticket)
        ask = ask->next;
    if (ask && ask->running) {
        ask->cancelled = true;
        ask = NULL;
    } else if (ask) {
        take(mover, ticket);
    }
    pthread_mutex_unlock(&mover->lock);
    if (ask)
        answer(ask, MOVER_CANCELLED, NULL);
}
