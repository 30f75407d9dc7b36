/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Live sensor relocation (relocation.h): builds an asset's surface in the background. Then computes the distances of moved
   sensors on that surface, one request after the other. */
#include "surface/relocation.h"

#include <math.h>
#include <pthread.h>
#include <string.h>

#include "base/files/cache_file.h"
#include "base/math/extent.h"
#include "base/mem.h"
#include "base/math/vec.h"
#include "surface/vertex_embedding.h"
#include "surface/mesh/bvh.h"
#include "surface/surface_store.h"

struct relocation_ask {
    uint64_t ticket;
    double point_m[3];
    struct relocation_place place;
    void (*done)(void *arg, struct relocation_result *result);
    void *arg;
    struct relocation_ask *next;
    /* --- below: under the lock */
    bool running, cancelled;
};

struct relocation {
    struct log *log;
    struct workers *workers;
    struct relocation_shape shape;
    char *surface_path;
    double size_m;
    pthread_mutex_t lock;
    pthread_cond_t idle;
    /* --- below: under lock */
    enum relocation_state state;
    /* surface of the asset, used to compute distances; once it is built, it is read without the mutex */
    struct surface *surface;
    /* positions of the asset's vertices on the surface, read without the mutex once the surface is built. NULL: not needed,
       because the surface was built from these vertices */
    struct vertex_embedding *embedding;
    /* waiting and running requests for the distances from a sensor position, oldest first */
    struct relocation_ask *asks;
    uint64_t last_ticket;
    size_t jobs; /* number of jobs that were submitted to the workers and have not finished; relocation_destroy() waits for them */
};

static void corner(const struct relocation_shape *shape, size_t t, size_t i, double out[3])
{
    const float *p = shape->positions_m[shape->triangles[3 * t + i]];
    for (int axis = 0; axis < 3; axis++)
        out[axis] = (double)p[axis];
}

static double size_of(const struct relocation_shape *shape)
{
    struct extent extent = extent_empty();
    for (size_t i = 0; i < 3 * shape->triangle_count; i++)
        extent_addf(&extent, shape->positions_m[shape->triangles[i]]);
    return shape->triangle_count ? extent_size(&extent) : 0;
}

/* --- places ----------------------------------------------------------------------------------------------------------------- */

/* Projects a point onto the asset while the surface is still being built: tries all triangles, which takes only a few milliseconds. */
static bool project_onto_triangles(const struct relocation *relocation, const double point_m[3], struct relocation_place *place)
{
    double best_m = relocation->size_m;
    bool found = false;
    for (size_t t = 0; t < relocation->shape.triangle_count; t++) {
        double corners[3][3], w[3], at[3];
        for (size_t i = 0; i < 3; i++)
            corner(&relocation->shape, t, i, corners[i]);
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
        *place = (struct relocation_place){ .distance_m = distance_m, .vertex = relocation->shape.triangles[3 * t + nearest] };
        memcpy(place->surface_m, at, sizeof(at));
    }
    return found;
}

static uint32_t nearest_vertex(const struct relocation_shape *shape, const double point_m[3])
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

static bool find_place(const struct relocation *relocation, const struct surface *surface, const double point_m[3],
                       struct relocation_place *place)
{
    struct surface_point at;
    if (!isfinite(point_m[0]) || !isfinite(point_m[1]) || !isfinite(point_m[2]))
        return false;
    if (!surface)
        return project_onto_triangles(relocation, point_m, place);
    surface_find_point(surface, point_m, NULL, &at);
    *place = (struct relocation_place){ .distance_m = at.distance_m, .vertex = nearest_vertex(&relocation->shape, at.point_m) };
    memcpy(place->surface_m, at.point_m, sizeof(at.point_m));
    return at.distance_m < relocation->size_m;
}

/* --- the surface ------------------------------------------------------------------------------------------------------------ */

static struct relocation_ask *take_ask(struct relocation *relocation, uint64_t ticket)
{
    for (struct relocation_ask **at = &relocation->asks; *at; at = &(*at)->next)
        if ((*at)->ticket == ticket) {
            struct relocation_ask *ask = *at;
            *at = ask->next;
            return ask;
        }
    return NULL;
}

static void answer(struct relocation_ask *ask, enum relocation_status status, float *geodesic_m)
{
    struct relocation_result result = { .status = status, .ticket = ask->ticket, .place = ask->place, .geodesic_m = geodesic_m };
    ask->done(ask->arg, &result);
    mem_free(ask);
}

static void end_job(struct relocation *relocation)
{
    pthread_mutex_lock(&relocation->lock);
    if (--relocation->jobs == 0)
        pthread_cond_broadcast(&relocation->idle);
    pthread_mutex_unlock(&relocation->lock);
}

/* Returns the oldest request that is not running, and marks it as running. Returns NULL if no request is waiting: the one for
   which this job was submitted was cancelled. */
static struct relocation_ask *begin_ask(struct relocation *relocation)
{
    pthread_mutex_lock(&relocation->lock);
    struct relocation_ask *ask = relocation->asks;
    while (ask && ask->running)
        ask = ask->next;
    if (ask)
        ask->running = true;
    pthread_mutex_unlock(&relocation->lock);
    return ask;
}

static bool find_distances(const struct relocation *relocation, const double surface_m[3], float *geodesic_m)
{
    return relocation->embedding ? vertex_embedding_distances(relocation->embedding, surface_m, geodesic_m)
                                 : surface_distances(relocation->surface, (const double(*)[3])surface_m, 1, geodesic_m);
}

static void solve_next(void *arg)
{
    struct relocation *relocation = arg;
    struct relocation_ask *ask = begin_ask(relocation);
    if (ask) {
        enum relocation_status status = relocation->surface ? RELOCATION_NO_MEMORY : RELOCATION_NO_SURFACE;
        float *geodesic_m = relocation->surface ? mem_try_array(relocation->shape.vertex_count, sizeof(*geodesic_m)) : NULL;
        if (geodesic_m && find_place(relocation, relocation->surface, ask->point_m, &ask->place) &&
            find_distances(relocation, ask->place.surface_m, geodesic_m))
            status = RELOCATION_DONE;
        pthread_mutex_lock(&relocation->lock);
        take_ask(relocation, ask->ticket);
        status = ask->cancelled ? RELOCATION_CANCELLED : status;
        pthread_mutex_unlock(&relocation->lock);
        if (status != RELOCATION_DONE) {
            mem_free(geodesic_m);
            geodesic_m = NULL;
        }
        answer(ask, status, geodesic_m);
    }
    end_job(relocation);
}

/* Reads the surface that plantcast-prep stored in the file relocation->surface_path. Returns NULL if there is no file, or its content is
   not valid. */
static struct surface *read_surface(const struct relocation *relocation, struct vertex_embedding **embedding)
{
    struct cache_file kept = { 0 };
    struct surface *surface = NULL;
    *embedding = NULL;
    if (relocation->surface_path &&
        cache_file_open_compressed(&kept, relocation->log, relocation->surface_path, SURFACE_MAGIC, relocation->shape.surface_key)) {
        surface = surface_unpack(&(struct unpack){ .at = kept.bytes, .left = kept.count }, relocation->log, relocation->workers);
        if (!surface)
            log_warn(relocation->log, "cache file %s: its surface is damaged, or memory ran out; the surface is built again",
                     relocation->surface_path);
    }
    cache_file_close(&kept);
    if (surface)
        *embedding = vertex_embedding_create(surface, relocation->shape.positions_m, relocation->shape.normals,
                                             relocation->shape.vertex_count, relocation->shape.triangles, relocation->shape.triangle_count);
    if (surface && !*embedding)
        surface_destroy(&surface);
    return surface;
}

static void warm(void *arg)
{
    struct relocation *relocation = arg;
    const struct relocation_shape *shape = &relocation->shape;
    struct vertex_embedding *embedding;
    struct surface *surface = read_surface(relocation, &embedding);
    size_t waiting = 0;
    if (!surface)
        surface = surface_create(relocation->log, relocation->workers, shape->positions_m, shape->vertex_count, shape->triangles,
                                 shape->triangle_count, &(struct surface_params){ .tolerance_m = shape->tolerance_m });
    pthread_mutex_lock(&relocation->lock);
    relocation->surface = surface;
    relocation->embedding = embedding;
    relocation->state = surface ? RELOCATION_WARM : RELOCATION_BROKEN;
    for (const struct relocation_ask *ask = relocation->asks; ask; ask = ask->next)
        waiting++;
    relocation->jobs += waiting;
    pthread_mutex_unlock(&relocation->lock);
    for (; waiting; waiting--)
        workers_submit(relocation->workers, solve_next, relocation);
    end_job(relocation);
}

struct relocation *relocation_create(struct log *log, struct workers *workers, const struct relocation_shape *shape)
{
    struct relocation *relocation = mem_new(sizeof(*relocation));
    *relocation = (struct relocation){ .log = log, .workers = workers, .shape = *shape, .size_m = size_of(shape), .jobs = 1 };
    relocation->surface_path = shape->surface_path ? mem_strdup(shape->surface_path) : NULL;
    pthread_mutex_init(&relocation->lock, NULL);
    pthread_cond_init(&relocation->idle, NULL);
    workers_submit(workers, warm, relocation);
    return relocation;
}

void relocation_destroy(struct relocation **relocation_ptr)
{
    struct relocation *relocation = *relocation_ptr;
    if (!relocation)
        return;
    pthread_mutex_lock(&relocation->lock);
    struct relocation_ask *waiting = NULL, **last = &waiting;
    for (struct relocation_ask **at = &relocation->asks; *at;) {
        struct relocation_ask *ask = *at;
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
    while (relocation->jobs)
        pthread_cond_wait(&relocation->idle, &relocation->lock);
    pthread_mutex_unlock(&relocation->lock);
    while (waiting) {
        struct relocation_ask *ask = waiting;
        waiting = ask->next;
        answer(ask, RELOCATION_CANCELLED, NULL);
    }
    vertex_embedding_destroy(&relocation->embedding);
    surface_destroy(&relocation->surface);
    mem_free(relocation->surface_path);
    pthread_mutex_destroy(&relocation->lock);
    pthread_cond_destroy(&relocation->idle);
    mem_free(relocation);
    *relocation_ptr = NULL;
}

enum relocation_state relocation_state(struct relocation *relocation)
{
    pthread_mutex_lock(&relocation->lock);
    enum relocation_state state = relocation->state;
    pthread_mutex_unlock(&relocation->lock);
    return state;
}

/* --- requests ----------------------------------------------------------------------------------------------------------------- */

bool relocation_place(struct relocation *relocation, const double point_m[3], struct relocation_place *place, float *euclidean_m)
{
    pthread_mutex_lock(&relocation->lock);
    const struct surface *surface = relocation->surface;
    pthread_mutex_unlock(&relocation->lock);
    if (!find_place(relocation, surface, point_m, place))
        return false;
    for (size_t v = 0; euclidean_m && v < relocation->shape.vertex_count; v++) {
        const float *p = relocation->shape.positions_m[v];
        euclidean_m[v] = (float)vec_distance((const double[3]){ (double)p[0], (double)p[1], (double)p[2] }, place->surface_m);
    }
    return true;
}

uint64_t relocation_request(struct relocation *relocation, const double point_m[3],
                            void (*done)(void *arg, struct relocation_result *result), void *arg)
{
    struct relocation_place place;
    if (!relocation_place(relocation, point_m, &place, NULL))
        return 0;
    struct relocation_ask *ask = mem_new(sizeof(*ask)), **last;
    *ask = (struct relocation_ask){ .point_m = { point_m[0], point_m[1], point_m[2] }, .place = place, .done = done, .arg = arg };
    pthread_mutex_lock(&relocation->lock);
    uint64_t ticket = ask->ticket = ++relocation->last_ticket;
    for (last = &relocation->asks; *last; last = &(*last)->next)
        ;
    *last = ask;
    bool now = relocation->state != RELOCATION_WARMING;
    relocation->jobs += now;
    pthread_mutex_unlock(&relocation->lock);
    if (now)
        workers_submit(relocation->workers, solve_next, relocation);
    return ticket;
}

void relocation_cancel(struct relocation *relocation, uint64_t ticket)
{
    pthread_mutex_lock(&relocation->lock);
    struct relocation_ask *ask = relocation->asks;
    while (ask && ask->ticket != ticket)
        ask = ask->next;
    if (ask && ask->running) {
        ask->cancelled = true;
        ask = NULL;
    } else if (ask) {
        take_ask(relocation, ticket);
    }
    pthread_mutex_unlock(&relocation->lock);
    if (ask)
        answer(ask, RELOCATION_CANCELLED, NULL);
}
