/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The thread that reads instants. */
#include "service/history_loader.h"

#include <errno.h>
#include <pthread.h>
#include <string.h>

#include "alarm/alarms_at_instant.h"
#include "base/clock.h"
#include "base/mem.h"
#include "history/history.h"

static const int64_t SPAN_NS = 60 * NS_PER_S; /* months come and go no more often than that */
static const int64_t LOOK_NS = 2 * NS_PER_S;  /* while nothing is recorded */

struct wanted {
    uint64_t client;
    int64_t at_us;
};

struct history_loader {
    struct history_loader_params params;
    struct history_reader *reader; /* of the thread; so below */
    struct history_tag *tags;
    int64_t spanned_ns;
    pthread_t thread;
    bool started;
    pthread_mutex_t lock;
    pthread_cond_t wake;
    /* --- below: under lock */
    struct wanted *wanted; /* oldest first */
    size_t count, capacity;
    struct history_loader_answer *answers, **last;
    int64_t first_us;
    bool stopping;
};

/* --- what is wanted, any thread ------------------------------------------------------------------------------------------------ */

/* Under lock. */
static void remove_at(struct history_loader *past, size_t i)
{
    past->count--;
    memmove(&past->wanted[i], &past->wanted[i + 1], (past->count - i) * sizeof(*past->wanted));
}

/* Under lock. */
static size_t find(const struct history_loader *past, uint64_t client)
{
    size_t i = 0;
    while (i < past->count && past->wanted[i].client != client)
        i++;
    return i;
}

void history_loader_ask(struct history_loader *past, uint64_t client, int64_t at_us)
{
    pthread_mutex_lock(&past->lock);
    size_t i = find(past, client);
    if (i == past->count)
        mem_grow(&past->wanted, &past->capacity, ++past->count, sizeof(*past->wanted));
    past->wanted[i] = (struct wanted){ client, at_us };
    pthread_cond_signal(&past->wake);
    pthread_mutex_unlock(&past->lock);
}

void history_loader_forget(struct history_loader *past, uint64_t client)
{
    pthread_mutex_lock(&past->lock);
    size_t i = find(past, client);
    if (i < past->count)
        remove_at(past, i);
    pthread_mutex_unlock(&past->lock);
}

struct history_loader_answer *history_loader_collect(struct history_loader *past)
{
    pthread_mutex_lock(&past->lock);
    struct history_loader_answer *answers = past->answers;
    past->answers = NULL;
    past->last = &past->answers;
    pthread_mutex_unlock(&past->lock);
    return answers;
}

int64_t history_loader_first_us(struct history_loader *past)
{
    pthread_mutex_lock(&past->lock);
    int64_t first_us = past->first_us;
    pthread_mutex_unlock(&past->lock);
    return first_us;
}

/* --- the thread ---------------------------------------------------------------------------------------------------------------- */

static bool read_moment(struct history_loader *past, int64_t at_us)
{
    const struct historical_snapshot *there = snapshot_cache_take(past->params.snapshot_cache, at_us);
    if (there) {
        snapshot_cache_give(past->params.snapshot_cache, &there);
        return true;
    }
    struct snapshot *snapshot = snapshot_create(past->params.plant->tag_count);
    bool good = history_at(past->reader, past->tags, at_us, snapshot) == 0 &&
                alarms_at_instant(past->params.log, past->reader, past->params.folder, past->params.plant, snapshot) == 0;
    if (good)
        snapshot_cache_add(past->params.snapshot_cache, at_us, snapshot);
    snapshot_destroy(&snapshot);
    return good;
}

static void look_at_span(struct history_loader *past)
{
    int64_t first_us = 0, last_us, now_ns = clock_mono_ns();
    if (past->spanned_ns && now_ns - past->spanned_ns < SPAN_NS)
        return;
    past->spanned_ns = now_ns;
    if (!history_span(past->reader, &first_us, &last_us)) {
        first_us = 0;
        past->spanned_ns = 0; /* nothing is there yet: look again soon, and with the next question */
    }
    pthread_mutex_lock(&past->lock);
    past->first_us = first_us;
    pthread_mutex_unlock(&past->lock);
}

/* False: nothing is, and it is time to look again for the beginning of what is recorded, or to stop. */
static bool next_wanted(struct history_loader *past, struct wanted *out, bool *stopping)
{
    int64_t until_ns = clock_mono_ns() + LOOK_NS;
    struct timespec until = { .tv_sec = until_ns / NS_PER_S, .tv_nsec = until_ns % NS_PER_S };
    int status = 0;
    pthread_mutex_lock(&past->lock);
    while (!past->stopping && past->count == 0 && status != ETIMEDOUT) {
        if (past->first_us)
            pthread_cond_wait(&past->wake, &past->lock);
        else
            status = pthread_cond_timedwait(&past->wake, &past->lock, &until);
    }
    *stopping = past->stopping;
    bool any = !*stopping && past->count > 0;
    if (any) {
        *out = past->wanted[0];
        remove_at(past, 0);
    }
    pthread_mutex_unlock(&past->lock);
    return any;
}

static void give_answer(struct history_loader *past, const struct wanted *wanted)
{
    struct history_loader_answer *answer = mem_new(sizeof(*answer));
    *answer = (struct history_loader_answer){ .client = wanted->client, .at_us = wanted->at_us, .good = read_moment(past, wanted->at_us) };
    pthread_mutex_lock(&past->lock);
    *past->last = answer;
    past->last = &answer->next;
    pthread_mutex_unlock(&past->lock);
    past->params.notify(past->params.notify_arg);
}

static void *run(void *arg)
{
    struct history_loader *past = arg;
    struct wanted wanted;
    bool stopping = false;
    while (!stopping) {
        look_at_span(past);
        if (next_wanted(past, &wanted, &stopping)) {
            look_at_span(past);
            give_answer(past, &wanted);
        }
    }
    return NULL;
}

struct history_loader *history_loader_create(const struct history_loader_params *params)
{
    struct history_loader *past = mem_new(sizeof(*past));
    past->params = *params;
    past->reader = history_reader_create(params->log, params->folder);
    past->tags = history_tags(params->plant);
    past->last = &past->answers;
    pthread_mutex_init(&past->lock, NULL);
    clock_cond_init(&past->wake);
    int error = pthread_create(&past->thread, NULL, run, past);
    past->started = !error;
    if (error) {
        log_err(params->log, "history: no thread to read instants of it: %s", strerror(error));
        history_loader_destroy(&past);
    }
    return past;
}

void history_loader_destroy(struct history_loader **pointer)
{
    struct history_loader *past = *pointer;
    if (!past)
        return;
    pthread_mutex_lock(&past->lock);
    past->stopping = true;
    pthread_cond_signal(&past->wake);
    pthread_mutex_unlock(&past->lock);
    if (past->started)
        pthread_join(past->thread, NULL);
    for (struct history_loader_answer *answer = past->answers, *next; answer; answer = next) {
        next = answer->next;
        mem_free(answer);
    }
    history_reader_destroy(&past->reader);
    mem_free(past->tags);
    mem_free(past->wanted);
    pthread_cond_destroy(&past->wake);
    pthread_mutex_destroy(&past->lock);
    mem_free(past);
    *pointer = NULL;
}
