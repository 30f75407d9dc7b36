/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cost of moving a sensor on the demo plant's heat exchanger while it is displayed, as in the daemon; prints one JSON line. */
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/math/search.h"
#include "base/mem.h"
#include "scene/manifest.h"
#include "scene/scene_create.h"
#include "surface/relocation.h"
#include "tests/support/sleep.h"

#define ROUNDS 30
#define NAME "prep_move_sensor_ms"
#define ASSET "E-101"
#define PREPARED "build/demo/plant.prepared"

struct relocation_counter {
    pthread_mutex_t lock;
    pthread_cond_t came;
    int count;
};

static void take(void *arg, struct relocation_result *result)
{
    struct relocation_counter *box = arg;
    if (result->status != RELOCATION_DONE)
        abort();
    mem_free(result->geodesic_m);
    pthread_mutex_lock(&box->lock);
    box->count++;
    pthread_cond_signal(&box->came);
    pthread_mutex_unlock(&box->lock);
}

static const struct asset_view *find(const struct scene *scene, const char *id)
{
    for (size_t i = 0; i < scene->asset_count; i++)
        if (strcmp(scene->plant->assets[i].id, id) == 0)
            return &scene->assets[i].file->view;
    return NULL;
}

/* Measures the time from requesting a sensor's move until its new distances to all vertices, straight-line and along the
   surface, are ready. */
static void measure(struct relocation *relocation, const struct asset_view *view)
{
    double ms[ROUNDS];
    struct relocation_counter box = { .lock = PTHREAD_MUTEX_INITIALIZER, .came = PTHREAD_COND_INITIALIZER };
    float *euclidean_m = mem_array(view->header->vertex_count, sizeof(*euclidean_m));
    for (int i = -1; i < ROUNDS; i++) {
        const float *p = view->positions_m[(size_t)(i + 1) * view->header->vertex_count / (ROUNDS + 1)];
        const double point[3] = { (double)p[0] + 0.003, (double)p[1] - 0.002, (double)p[2] + 0.001 };
        struct relocation_place place;
        int64_t began_ns = clock_mono_ns();
        if (!relocation_place(relocation, point, &place, euclidean_m) || !relocation_request(relocation, point, take, &box))
            abort();
        pthread_mutex_lock(&box.lock);
        while (box.count < i + 2)
            pthread_cond_wait(&box.came, &box.lock);
        pthread_mutex_unlock(&box.lock);
        if (i >= 0)
            ms[i] = (double)(clock_mono_ns() - began_ns) / NS_PER_MS;
    }
    qsort(ms, ROUNDS, sizeof(*ms), compare_doubles);
    printf("{\"name\": \"" NAME "\", \"value\": %.1f, \"p95\": %.1f, \"unit\": \"ms\", \"goal\": [\"<=\", 150]}\n", ms[ROUNDS / 2],
           ms[ROUNDS * 95 / 100]);
    mem_free(euclidean_m);
}

/* Creates the object that computes a moved sensor's distances, from the surface that plantcast-prep has cached. Returns NULL if
   there is no such surface. */
static struct relocation *create_mover(struct log *log, struct workers *workers, const struct asset_view *view)
{
    const struct asset_level *finest = &view->levels[0];
    const struct asset_primitive *first = &view->primitives[finest->first_primitive], *last = first + finest->primitive_count - 1;
    struct manifest manifest = { 0 };
    struct relocation *relocation = NULL;
    bool read = manifest_read(log, PREPARED, &manifest);
    const struct manifest_entry *entry = read ? manifest_find(&manifest, ASSET) : NULL;
    if (entry && entry->surface) {
        char *path = mem_printf(PREPARED "/%s", entry->surface);
        relocation = relocation_create(log, workers,
                                       &(struct relocation_shape){ .positions_m = view->positions_m,
                                                                   .normals = view->normals,
                                                                   .vertex_count = view->header->vertex_count,
                                                                   .triangles = view->indices + first->first_index,
                                                                   .triangle_count =
                                                                       (last->first_index + last->index_count - first->first_index) / 3,
                                                                   .surface_path = path,
                                                                   .surface_key = strtoull(entry->surface, NULL, 16) });
        mem_free(path);
    }
    if (read)
        manifest_finish(&manifest);
    return relocation;
}

int main(void)
{
    struct diag diag = { 0 };
    struct log *log = log_create(LOG_ERROR);
    struct workers *workers = workers_create(0);
    struct plant *plant = plant_load("build/demo/plant.yaml", &diag);
    struct scene *scene = plant ? scene_create(log, plant, PREPARED) : NULL;
    const struct asset_view *view = scene ? find(scene, ASSET) : NULL;
    struct relocation *relocation = view ? create_mover(log, workers, view) : NULL;
    if (relocation) {
        while (relocation_state(relocation) == RELOCATION_WARMING)
            sleep_ns(NS_PER_MS);
        measure(relocation, view);
    } else {
        printf("{\"name\": \"" NAME "\", \"value\": null, \"unit\": \"ms\", \"why\": \"there is no " ASSET " in build/demo\"}\n");
    }
    relocation_destroy(&relocation);
    workers_destroy(&workers);
    scene_destroy(&scene);
    plant_destroy(&plant);
    diag_finish(&diag);
    log_destroy(&log);
    return 0;
}
