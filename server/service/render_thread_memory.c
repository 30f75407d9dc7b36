/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Memory of the renderer's caches: measured, limited, and released while there are no clients. */
#include "base/clock.h"
#include "base/mem.h"
#include "base/system/memory.h"
#include "service/render_thread_impl.h"
#include "render/frame_pool.h"

/* interval in nanoseconds at which the memory use of caches and process is measured */
static const int64_t MEASURE_INTERVAL_NS = 1 * NS_PER_S;
static const int64_t IDLE_TIMEOUT_NS = 10 * NS_PER_S;    /* nanoseconds without clients after which the renderer's caches are released */
static const double FIELD_SHARE = 0.3; /* maximum fraction of the caches' memory for interpolated values and weights of all fields */
/* Minimum number of bytes reserved for memory other than models and caches: shaders, threads, the plant, and temporary memory
   for drawing a frame or baking a light. */
static const size_t OTHER_BYTES = (size_t)576 << 20;
/* bytes of free but still resident heap above which the heap is trimmed (free memory is returned to the system) */
static const size_t FREE_BYTES = (size_t)64 << 20;
static const int64_t TRIM_NS = 5 * NS_PER_S; /* minimum time between two trims */
/* The recorded peak of other memory decreases slowly: each measurement lowers the difference between the peak and the present
   value by the fraction 1 / FADES. */
static const size_t FADES = 64;

static counter *add_counter(struct render_service *service, const char *of)
{
    char *name = mem_printf("plantcast_memory_bytes{of=\"%s\"}", of);
    counter *added = counters_add(service->params.counters, name, "gauge",
                                  "Bytes of memory held for drawing, by purpose; everything except the models is a cache.");
    mem_free(name);
    return added;
}

void render_thread_memory_init(struct thread_memory *memory, struct render_service *service)
{
    *memory = (struct thread_memory){ .fields = add_counter(service, "fields"), .frames = add_counter(service, "frames") };
    for (int i = 0; i < RENDER_STORES; i++)
        memory->stores[i] = add_counter(service, render_store_names[i]);
    memory->bound = counters_add(service->params.counters, "plantcast_memory_bound_bytes", "gauge",
                                 "Limit in bytes for all caches together (--memory); the picture being drawn is not included.");
}

/* Returns the recent peak of the process's memory besides models and caches, whose bytes are `counted`. If the memory is close
   to the limit `all`, first returns free heap memory to the system. */
static size_t other_bytes(struct thread_memory *memory, size_t all, size_t counted)
{
    struct memory_use use;
    int64_t now_ns = clock_mono_ns();
    memory_measure(&use);
    bool loose = use.anonymous > use.allocated + FREE_BYTES;
    if (loose && use.anonymous > all - all / 8 && now_ns - memory->trimmed_ns > TRIM_NS) {
        memory_trim();
        memory_measure(&use);
        memory->trimmed_ns = now_ns;
        loose = false;
    }
    size_t other = use.anonymous > counted ? use.anonymous - counted : 0;
    if (other < memory->other)
        memory->other -= (memory->other - other) / FADES;
    /* keeps the old peak until the heap is trimmed: memory just freed by a cache is still in the heap, and would count as other memory */
    else if (!loose)
        memory->other = other;
    return memory->other > OTHER_BYTES ? memory->other : OTHER_BYTES;
}

/* Returns the bytes that the caches may take: `all` (the limit of the process) minus models and other memory, but at least a
   quarter of `all`. */
static size_t bound_of(size_t all, size_t models, size_t other)
{
    return models + other < all - all / 4 ? all - models - other : all / 4;
}

void render_thread_bound_memory(struct render_thread *thread)
{
    struct thread_memory *memory = &thread->memory;
    size_t bytes[RENDER_STORES], all = thread->service->params.memory_bytes, frames = frame_pool_bytes(renderer_frames(thread->renderer));
    size_t counted = field_bytes(thread->field) + frames;
    renderer_measure_memory(thread->renderer, bytes);
    for (int i = 0; i < RENDER_STORES; i++)
        counted += bytes[i];
    all = all ? all : memory_default_bytes();
    size_t bound = bound_of(all, bytes[STORE_MODELS], other_bytes(memory, all, counted));
    /* the memory of finished frames is subtracted from what caches may use: it cannot be limited, because the number of frames
       follows from the number of sessions */
    size_t caches = bound > 2 * frames ? bound - frames : bound / 2;
    field_set_cache_limit(thread->field, (size_t)(FIELD_SHARE * (double)caches));
    renderer_bound_memory(thread->renderer, caches - (size_t)(FIELD_SHARE * (double)caches));
    renderer_measure_memory(thread->renderer, bytes);
    for (int i = 0; i < RENDER_STORES; i++)
        counter_set(memory->stores[i], (int64_t)bytes[i]);
    counter_set(memory->fields, (int64_t)field_bytes(thread->field));
    counter_set(memory->frames, (int64_t)frames);
    counter_set(memory->bound, (int64_t)(bound + bytes[STORE_MODELS]));
}

void render_thread_note_work(struct render_thread *thread)
{
    thread->memory.released = false;
    thread->memory.alone_since_ns = 0;
}

void render_thread_check_memory(struct render_thread *thread)
{
    int64_t now_ns = clock_mono_ns();
    render_thread_note_work(thread);
    if (now_ns - thread->memory.looked_ns < MEASURE_INTERVAL_NS)
        return;
    thread->memory.looked_ns = now_ns;
    render_thread_bound_memory(thread);
}

bool render_thread_may_release_memory(struct render_thread *thread, int64_t *wait_until_ns)
{
    struct thread_memory *memory = &thread->memory;
    int64_t now_ns = clock_mono_ns();
    if (thread->service->client_count > 0) {
        memory->alone_since_ns = 0;
        return false;
    }
    if (!memory->alone_since_ns)
        memory->alone_since_ns = now_ns;
    if (memory->released)
        return false;
    int64_t due_ns = memory->alone_since_ns + IDLE_TIMEOUT_NS;
    *wait_until_ns = due_ns < *wait_until_ns ? due_ns : *wait_until_ns;
    return now_ns >= due_ns;
}

void render_thread_release_memory(struct render_thread *thread)
{
    renderer_drop_caches(thread->renderer);
    field_clear_cache(thread->field);
    recent_frames_finish(&thread->recent);
    encode_queue_drop_idle(thread->service->queue);
    frame_pool_drop_spares(renderer_frames(thread->renderer));
    memory_trim();
    thread->memory.other = 0;
    render_thread_bound_memory(thread);
    thread->memory.released = true;
}
