/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The thread that loads the readings of past instants. */
#include "service/history_loader.h"

#include <stdatomic.h>
#include <string.h>

#include "alarm/alarms_at_instant.h"
#include "base/clock.h"
#include "base/mem.h"
#include "base/thread.h"
#include "corelink/core_history.h"
#include "history/history.h"

static const int64_t SPAN_INTERVAL_NS =
    60 * NS_PER_S; /* interval of reading the start of recorded history again; long, because old files are removed rarely */
/* interval of checks whether recorded history has begun, while nothing is recorded yet */
static const int64_t RETRY_DELAY_NS = 2 * NS_PER_S;

struct wanted_instant {
    uint64_t client;
    int64_t at_us;
};

struct history_loader {
    struct history_loader_params params;
    _Atomic bool stop;
    /* reader of the history that this machine recorded; NULL: history is read from the core. Only the loader's thread uses the
       members from this one to `thread` */
    struct history_reader *reader;
    struct core_history *core; /* link to the core; NULL: the history is on this machine */
    struct history_tag *tags;
    int64_t spanned_ns;
    struct thread thread;
    /* --- below: protected by thread.lock */
    struct wanted_instant *wanted; /* past instants whose readings clients wait for, oldest request first */
    size_t count, capacity;
    struct history_loader_answer *answers, **last;
    int64_t first_us;
};

/* --- requests, from any thread ---------------------------------------------------------------------------------------- */

/* Removes the request with index i from the list of past instants whose readings clients wait for. The caller holds the lock. */
static void remove_at(struct history_loader *loader, size_t i)
{
    loader->count--;
    memmove(&loader->wanted[i], &loader->wanted[i + 1], (loader->count - i) * sizeof(*loader->wanted));
}

/* Returns the index of the client's request in the list of wanted instants, or the list's count if the client has none. The caller holds
   the lock. */
static size_t find(const struct history_loader *loader, uint64_t client)
{
    size_t i = 0;
    while (i < loader->count && loader->wanted[i].client != client)
        i++;
    return i;
}

void history_loader_ask(struct history_loader *loader, uint64_t client, int64_t at_us)
{
    pthread_mutex_lock(&loader->thread.lock);
    size_t i = find(loader, client);
    if (i == loader->count)
        mem_grow(&loader->wanted, &loader->capacity, ++loader->count, sizeof(*loader->wanted));
    loader->wanted[i] = (struct wanted_instant){ client, at_us };
    pthread_cond_signal(&loader->thread.wake);
    pthread_mutex_unlock(&loader->thread.lock);
}

void history_loader_forget(struct history_loader *loader, uint64_t client)
{
    pthread_mutex_lock(&loader->thread.lock);
    size_t i = find(loader, client);
    if (i < loader->count)
        remove_at(loader, i);
    pthread_mutex_unlock(&loader->thread.lock);
}

struct history_loader_answer *history_loader_collect(struct history_loader *loader)
{
    pthread_mutex_lock(&loader->thread.lock);
    struct history_loader_answer *answers = loader->answers;
    loader->answers = NULL;
    loader->last = &loader->answers;
    pthread_mutex_unlock(&loader->thread.lock);
    return answers;
}

int64_t history_loader_first_us(struct history_loader *loader)
{
    pthread_mutex_lock(&loader->thread.lock);
    int64_t first_us = loader->first_us;
    pthread_mutex_unlock(&loader->thread.lock);
    return first_us;
}

/* --- the thread ------------------------------------------------------------------------------------------------------- */

static bool read_here(struct history_loader *loader, int64_t at_us, struct snapshot *snapshot)
{
    return history_at(loader->reader, loader->tags, at_us, snapshot) == 0 &&
           alarms_at_instant(loader->params.log, loader->reader, loader->params.folder, loader->params.plant, snapshot) == 0;
}

static bool read_from_core(struct history_loader *loader, int64_t at_us, struct snapshot *snapshot)
{
    int64_t first_us;
    snapshot->taken_utc_ns = at_us * 1000;
    return core_history_instant(loader->core, at_us, snapshot, &first_us);
}

static bool read_instant(struct history_loader *loader, int64_t at_us)
{
    const struct historical_snapshot *there = snapshot_cache_take(loader->params.snapshot_cache, at_us);
    if (there) {
        snapshot_cache_give(loader->params.snapshot_cache, &there);
        return true;
    }
    struct snapshot *snapshot = snapshot_create(loader->params.plant->tag_count);
    bool good = loader->core ? read_from_core(loader, at_us, snapshot) : read_here(loader, at_us, snapshot);
    if (good)
        snapshot_cache_add(loader->params.snapshot_cache, at_us, snapshot);
    snapshot_destroy(&snapshot);
    return good;
}

static void look_at_span(struct history_loader *loader)
{
    int64_t first_us = 0, last_us, now_ns = clock_mono_ns();
    if (loader->spanned_ns && now_ns - loader->spanned_ns < SPAN_INTERVAL_NS)
        return;
    loader->spanned_ns = now_ns;
    bool any = loader->core ? core_history_instant(loader->core, 0, NULL, &first_us) && first_us > 0
                            : history_span(loader->reader, &first_us, &last_us);
    if (!any) {
        first_us = 0;
        /* 0: nothing is recorded yet, so the thread looks for the start of history again soon, and at the next request */
        loader->spanned_ns = 0;
    }
    pthread_mutex_lock(&loader->thread.lock);
    loader->first_us = first_us;
    pthread_mutex_unlock(&loader->thread.lock);
}

/* Waits until a client requests the readings of a past instant. Returns false without a request if the thread must stop, or if
   the start of recorded history must be read again. */
static bool next_wanted(struct history_loader *loader, struct wanted_instant *out, bool *stopping)
{
    int64_t until_ns = clock_mono_ns() + RETRY_DELAY_NS;
    pthread_mutex_lock(&loader->thread.lock);
    while (!loader->thread.stopping && loader->count == 0 &&
           clock_cond_wait(&loader->thread.wake, &loader->thread.lock, loader->first_us ? INT64_MAX : until_ns))
        continue;
    *stopping = loader->thread.stopping;
    bool any = !*stopping && loader->count > 0;
    if (any) {
        *out = loader->wanted[0];
        remove_at(loader, 0);
    }
    pthread_mutex_unlock(&loader->thread.lock);
    return any;
}

static void give_answer(struct history_loader *loader, const struct wanted_instant *wanted)
{
    struct history_loader_answer *answer = mem_new(sizeof(*answer));
    *answer =
        (struct history_loader_answer){ .client = wanted->client, .at_us = wanted->at_us, .good = read_instant(loader, wanted->at_us) };
    pthread_mutex_lock(&loader->thread.lock);
    *loader->last = answer;
    loader->last = &answer->next;
    pthread_mutex_unlock(&loader->thread.lock);
    loader->params.notify(loader->params.notify_arg);
}

static void *history_loader_main(void *arg)
{
    struct history_loader *loader = arg;
    struct wanted_instant wanted;
    bool stopping = false;
    while (!stopping) {
        look_at_span(loader);
        if (next_wanted(loader, &wanted, &stopping)) {
            look_at_span(loader);
            give_answer(loader, &wanted);
        }
    }
    return NULL;
}

struct history_loader *history_loader_create(const struct history_loader_params *params)
{
    struct history_loader *loader = mem_new(sizeof(*loader));
    loader->params = *params;
    if (params->folder)
        loader->reader = history_reader_create(params->log, params->folder);
    else
        loader->core = core_history_create(params->log, params->core_link, &loader->stop);
    loader->tags = history_tags(params->plant);
    loader->last = &loader->answers;
    thread_init(&loader->thread);
    if ((!loader->reader && !loader->core) || !thread_start(&loader->thread, params->log, "history: instants", history_loader_main, loader))
        history_loader_destroy(&loader);
    return loader;
}

void history_loader_destroy(struct history_loader **pointer)
{
    struct history_loader *loader = *pointer;
    if (!loader)
        return;
    atomic_store(&loader->stop, true);
    thread_stop(&loader->thread);
    for (struct history_loader_answer *answer = loader->answers, *next; answer; answer = next) {
        next = answer->next;
        mem_free(answer);
    }
    history_reader_destroy(&loader->reader);
    core_history_destroy(&loader->core);
    mem_free(loader->tags);
    mem_free(loader->wanted);
    thread_finish(&loader->thread);
    mem_free(loader);
    *pointer = NULL;
}
