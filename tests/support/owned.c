/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/support/owned.h"

#include <pthread.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "base/log/log.h"
#include "base/mem.h"
#include "base/metrics/counters.h"
#include "base/text/text.h"
#include "base/workers.h"
#include "history/history.h"
#include "render/frame.h"
#include "value/snapshot.h"
#include "value/store.h"

static struct {
    struct owned_resource {
        void (*release)(void *resource);
        void *resource;
    } *items;
    size_t count, capacity;
    pid_t process; /* process that owns the resources; in a forked child they are not released, because its parent still uses them */
    pthread_mutex_t lock;
} owned = { .lock = PTHREAD_MUTEX_INITIALIZER };

static void release_all(void)
{
    if (getpid() == owned.process) {
        owned_release(0);
        mem_free(owned.items);
    }
}

void owned_add(void (*release)(void *resource), void *resource)
{
    pthread_mutex_lock(&owned.lock);
    if (!owned.items) {
        owned.process = getpid();
        atexit(release_all);
    }
    mem_grow(&owned.items, &owned.capacity, owned.count + 1, sizeof(*owned.items));
    owned.items[owned.count++] = (struct owned_resource){ release, resource };
    pthread_mutex_unlock(&owned.lock);
}

size_t owned_count(void)
{
    return owned.count;
}

void owned_release(size_t kept)
{
    while (owned.count > kept) {
        const struct owned_resource *newest = &owned.items[--owned.count];
        newest->release(newest->resource);
    }
}

void test_series(const struct history_series *series)
{
    owned_add(mem_free, series->points.at);
    owned_add(mem_free, series->buckets.at);
}

static void release_text(void *resource)
{
    text_finish(resource);
    mem_free(resource);
}

struct text *test_text(void)
{
    struct text *text = mem_new(sizeof(*text));
    owned_add(release_text, text);
    return text;
}

char *test_printf(const char *format, ...)
{
    va_list arguments;
    char *text = NULL;
    va_start(arguments, format);
    if (vasprintf(&text, format, arguments) < 0)
        abort();
    va_end(arguments);
    owned_add(free, text);
    return text;
}

void *test_memory(void *memory)
{
    owned_add(mem_free, memory);
    return memory;
}

static void release_frame(void *resource)
{
    struct frame *frame = resource;
    frame_unref(&frame);
}

struct frame *test_frame(struct frame *frame)
{
    owned_add(release_frame, frame);
    return frame;
}

static void release_json(void *json)
{
    json_decref(json);
}

json_t *test_json(json_t *json)
{
    owned_add(release_json, json);
    return json;
}

#define RELEASE(noun)                                                                                                                      \
    static void release_##noun(void *resource)                                                                                             \
    {                                                                                                                                      \
        struct noun *noun = resource;                                                                                                      \
        noun##_destroy(&noun);                                                                                                             \
    }
RELEASE(log)
RELEASE(counters)
RELEASE(snapshot)
RELEASE(store)
RELEASE(workers)

struct log *test_log(void)
{
    struct log *log = log_create(LOG_ERROR);
    owned_add(release_log, log);
    return log;
}

struct counters *test_counters(void)
{
    struct counters *counters = counters_create();
    owned_add(release_counters, counters);
    return counters;
}

struct snapshot *test_snapshot(size_t tag_count)
{
    struct snapshot *snapshot = snapshot_create(tag_count);
    owned_add(release_snapshot, snapshot);
    return snapshot;
}

struct store *test_store(const struct plant *plant)
{
    struct store *store = store_create(plant);
    owned_add(release_store, store);
    return store;
}

struct workers *test_workers(int threads)
{
    struct workers *workers = workers_create(threads);
    owned_add(release_workers, workers);
    return workers;
}
