/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Loads environment maps on the workers and uploads the results to the GPU. */
#include "render/light/environments.h"

#include <pthread.h>
#include <stdatomic.h>
#include <time.h>

#include "base/clock.h"
#include "base/mem.h"
#include "gpu/mesh.h"

enum { SOURCE_MAX_PX = 1024, BLOCK_BINDING = 1, UNIT_MIRRORED = 8, UNIT_BRDF = 9 };

/* Task of loading one environment map, shared by a worker thread and the renderer. It is freed when both have released it. */
struct environment_task {
    atomic_int refs;
    struct log *log;
    struct workers *workers;
    char *path;
    bool y_up;
    pthread_mutex_t lock;
    pthread_cond_t done_wake;
    /* --- below: under lock */
    bool done, good;
    struct environment environment;
};

static void task_unref(struct environment_task **task_ptr)
{
    struct environment_task *task = *task_ptr;
    *task_ptr = NULL;
    if (!task || atomic_fetch_sub(&task->refs, 1) > 1)
        return;
    environment_finish(&task->environment);
    pthread_cond_destroy(&task->done_wake);
    pthread_mutex_destroy(&task->lock);
    mem_free(task->path);
    mem_free(task);
}

static bool read_task(const struct environment_task *task, struct environment *environment)
{
    struct image_float image;
    char why[IMAGE_WHY_BYTES];
    if (!image_load_float(&image, task->path, SOURCE_MAX_PX, why)) {
        log_err(task->log, "environment %s: %s", task->path, why);
        return false;
    }
    bool good = environment_init(environment, &image, task->y_up, task->workers);
    if (!good)
        log_err(task->log,
                "environment %s: the upper half of this picture is black, or lacks a colour such as blue, so it cannot light the plant",
                task->path);
    mem_free(image.rgba);
    return good;
}

/* Runs on a worker. */
static void run_task(void *arg)
{
    struct environment_task *task = arg;
    struct environment environment = { 0 };
    bool good = read_task(task, &environment);
    pthread_mutex_lock(&task->lock);
    task->environment = environment;
    task->good = good;
    task->done = true;
    pthread_cond_broadcast(&task->done_wake);
    pthread_mutex_unlock(&task->lock);
    task_unref(&task);
}

static struct environment_task *start_task(struct log *log, struct workers *workers, const char *path, bool y_up)
{
    struct environment_task *task = mem_new(sizeof(*task));
    pthread_condattr_t attributes;
    *task = (struct environment_task){ .refs = 2, .log = log, .workers = workers, .path = mem_strdup(path), .y_up = y_up };
    pthread_mutex_init(&task->lock, NULL);
    pthread_condattr_init(&attributes);
    pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
    pthread_cond_init(&task->done_wake, &attributes);
    pthread_condattr_destroy(&attributes);
    workers_submit(workers, run_task, task);
    return task;
}

static bool upload(const struct environments *environments, struct environment_slot *slot)
{
    const struct environment *environment = &slot->of;
    slot->irradiance = mesh_buffer(environments->gl->log, "environment", sizeof(environment->irradiance), environment->irradiance, 0);
    glCreateTextures(GL_TEXTURE_3D, 1, &slot->mirrored);
    glTextureStorage3D(slot->mirrored, 1, GL_RGBA16F, ENVIRONMENT_PX, ENVIRONMENT_PX, ENVIRONMENT_LAYERS);
    glTextureSubImage3D(slot->mirrored, 0, 0, 0, 0, ENVIRONMENT_PX, ENVIRONMENT_PX, ENVIRONMENT_LAYERS, GL_RGBA, GL_FLOAT,
                        environment->mirrored);
    glTextureParameteri(slot->mirrored, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTextureParameteri(slot->mirrored, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTextureParameteri(slot->mirrored, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    glTextureParameteri(slot->mirrored, GL_TEXTURE_WRAP_R, GL_CLAMP_TO_EDGE);
    return slot->irradiance && gl_no_errors();
}

/* protects the BRDF table and the built-in skies, which all renderers share; they are computed once and kept until the process ends */
static pthread_mutex_t lock_built_in = PTHREAD_MUTEX_INITIALIZER;

static const float (*built_in_brdf(void))[2]
{
    static float texels[ENVIRONMENT_BRDF_PX * ENVIRONMENT_BRDF_PX][2]; /* written under the lock */
    static bool made;
    pthread_mutex_lock(&lock_built_in);
    if (!made)
        environment_brdf(ENVIRONMENT_BRDF_PX, texels);
    made = true;
    pthread_mutex_unlock(&lock_built_in);
    return (const float(*)[2])texels;
}

static void make_brdf(struct environments *environments)
{
    const float(*texels)[2] = built_in_brdf();
    environments->brdf_texels = texels;
    glCreateTextures(GL_TEXTURE_2D, 1, &environments->brdf);
    glTextureStorage2D(environments->brdf, 1, GL_RG16F, ENVIRONMENT_BRDF_PX, ENVIRONMENT_BRDF_PX);
    glTextureSubImage2D(environments->brdf, 0, 0, 0, ENVIRONMENT_BRDF_PX, ENVIRONMENT_BRDF_PX, GL_RG, GL_FLOAT, texels);
    glTextureParameteri(environments->brdf, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTextureParameteri(environments->brdf, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTextureParameteri(environments->brdf, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
}

static const struct environment *built_in_sky(bool y_up, struct workers *workers)
{
    static struct environment skies[2]; /* written under the lock */
    pthread_mutex_lock(&lock_built_in);
    if (!skies[y_up].mirrored)
        environment_init(&skies[y_up], NULL, y_up, workers);
    pthread_mutex_unlock(&lock_built_in);
    return &skies[y_up];
}

bool environments_init(struct environments *environments, struct gl *gl, const struct plant *plant, struct workers *workers)
{
    bool y_up = plant->up == AXIS_Y;
    *environments = (struct environments){ .gl = gl, .count = 1 + (int)plant->display.environment_count };
    for (int i = 1; i < environments->count; i++)
        environments->slots[i].task = start_task(gl->log, workers, plant->display.environments[i - 1].path, y_up);
    environments->slots[0].of = *built_in_sky(y_up, workers);
    bool good = upload(environments, &environments->slots[0]);
    make_brdf(environments);
    return good;
}

void environments_finish(struct environments *environments)
{
    for (int i = 0; i < environments->count; i++) {
        struct environment_slot *slot = &environments->slots[i];
        glDeleteBuffers(1, &slot->irradiance);
        glDeleteTextures(1, &slot->mirrored);
        if (i > 0) /* slot 0, the built-in sky, is not freed: all renderers share it */
            environment_finish(&slot->of);
        task_unref(&slot->task);
    }
    glDeleteTextures(1, &environments->brdf);
    *environments = (struct environments){ 0 };
}

static bool wait_done(struct environment_task *task, int64_t timeout_ns)
{
    int64_t until_ns = clock_mono_ns() + timeout_ns;
    struct timespec until = { .tv_sec = until_ns / NS_PER_S, .tv_nsec = until_ns % NS_PER_S };
    int late = timeout_ns > 0 ? 0 : 1;
    pthread_mutex_lock(&task->lock);
    while (!task->done && !late)
        late = pthread_cond_timedwait(&task->done_wake, &task->lock, &until);
    bool done = task->done;
    pthread_mutex_unlock(&task->lock);
    return done;
}

bool environments_wait(struct environments *environments, int number, int64_t timeout_ns)
{
    struct environment_slot *slot = &environments->slots[number];
    if (!slot->task)
        return true;
    if (!wait_done(slot->task, timeout_ns))
        return false;
    if (slot->task->good) {
        slot->of = slot->task->environment; /* safe to read without a lock: the worker no longer accesses the task */
        slot->task->environment = (struct environment){ 0 };
    }
    if (slot->of.mirrored && !upload(environments, slot)) {
        glDeleteTextures(1, &slot->mirrored);
        slot->mirrored = 0;
    }
    task_unref(&slot->task);
    return true;
}

static const struct environment_slot *slot_of(const struct environments *environments, int number)
{
    return &environments->slots[environments->slots[number].mirrored ? number : 0];
}

struct environment_light environments_get(const struct environments *environments, int number)
{
    return (struct environment_light){ &slot_of(environments, number)->of, environments->brdf_texels };
}

void environments_bind(const struct environments *environments, int number)
{
    const struct environment_slot *slot = slot_of(environments, number);
    glBindBufferBase(GL_UNIFORM_BUFFER, BLOCK_BINDING, slot->irradiance);
    glBindTextureUnit(UNIT_MIRRORED, slot->mirrored);
    glBindTextureUnit(UNIT_BRDF, environments->brdf);
}
