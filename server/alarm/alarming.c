/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The thread of alarms. */
#include "alarm/alarming.h"

#include <errno.h>
#include <pthread.h>
#include <stdatomic.h>
#include <string.h>
#include <time.h>

#include "alarm/journal.h"
#include "base/clock.h"
#include "base/mem.h"

enum { TOLD_MAX = 1000000 /* samples that a tenth of a second may bring */, RATE_SLOTS = 60 };
static const int64_t TICK_NS = NS_PER_S / 10, RATE_NS = 600 * NS_PER_S;

struct told {
    struct heard *at;
    size_t count, capacity, lost;
};

struct alarming {
    struct alarming_params params;
    struct journal *journal;
    struct {
        counter *words[ALARM_WORDS], *active, *standing, *chattering, *held, *rate, *raised, *lost;
    } counters;
    pthread_t thread;
    _Atomic bool started;
    _Atomic uint64_t number;
    /* --- below: of the thread */
    struct told taken;
    struct snapshot *snapshot;
    int64_t counted_ns;
    int raised[RATE_SLOTS]; /* a ring of stretches of RATE_NS / RATE_SLOTS */
    int64_t slot;
    pthread_mutex_t told_lock; /* taken under the store's */
    /* --- below: under told_lock */
    struct told told;
    pthread_mutex_t lock;      /* the store's is taken under it */
    pthread_cond_t wake;
    /* --- below: under lock */
    struct alarms *alarms;
    int raised_now;
    bool stopping;
};

/* --- from and to the store -------------------------------------------------------------------------------------------------- */

static void on_sample(void *arg, const struct heard *heard)
{
    struct alarming *alarming = arg;
    pthread_mutex_lock(&alarming->told_lock);
    struct told *told = &alarming->told;
    if (told->count < TOLD_MAX) {
        mem_grow(&told->at, &told->capacity, told->count + 1, sizeof(*told->at));
        told->at[told->count++] = *heard;
    } else {
        told->lost++;
    }
    pthread_mutex_unlock(&alarming->told_lock);
}

static void on_change(void *arg, const struct alarm_change *change)
{
    struct alarming *alarming = arg;
    alarming->raised_now += change->event == ALARM_RAISE && alarm_word_calls(change->after);
    if (alarming->journal)
        journal_add(alarming->journal, change, change->alarm->name);
}

static void on_tag(void *arg, int tag, enum alarm_kind kind, enum alarm_word word)
{
    struct alarming *alarming = arg;
    store_set_alarm(alarming->params.store, tag, (int)kind, (int)word);
}

/* --- the thread ------------------------------------------------------------------------------------------------------------- */

static void take_told(struct alarming *alarming)
{
    pthread_mutex_lock(&alarming->told_lock);
    struct told taken = alarming->told;
    alarming->told = alarming->taken;
    pthread_mutex_unlock(&alarming->told_lock);
    alarming->taken = taken;
    if (taken.lost) {
        counter_inc(alarming->counters.lost, (int64_t)taken.lost);
        log_err(alarming->params.log, "alarms: %zu samples in a tenth of a second were too many and are lost", taken.lost);
    }
}

/* Raised within the last ten minutes. */
static int rate(struct alarming *alarming, int64_t now_ns, int raised)
{
    int64_t slot = now_ns / (RATE_NS / RATE_SLOTS);
    int all = 0;
    if (slot - alarming->slot > RATE_SLOTS)
        alarming->slot = slot - RATE_SLOTS;
    while (alarming->slot < slot)
        alarming->raised[++alarming->slot % RATE_SLOTS] = 0;
    alarming->raised[slot % RATE_SLOTS] += raised;
    for (int i = 0; i < RATE_SLOTS; i++)
        all += alarming->raised[i];
    return all;
}

static void count(struct alarming *alarming, const struct alarm_counts *counts)
{
    for (int i = 0; i < ALARM_WORDS; i++)
        counter_set(alarming->counters.words[i], counts->words[i]);
    counter_set(alarming->counters.active, counts->active);
    counter_set(alarming->counters.standing, counts->standing);
    counter_set(alarming->counters.chattering, counts->chattering);
    counter_set(alarming->counters.held, counts->held);
}

static void keep_all(struct alarming *alarming)
{
    for (int i = alarms_newest(alarming->alarms); i >= 0; i = alarms_at(alarming->alarms, i)->older) {
        const struct alarm *alarm = alarms_at(alarming->alarms, i);
        if (alarm_word_of(alarm) != ALARM_NORMAL)
            journal_keep(alarming->journal, alarm, alarm->name);
    }
}

static void tick(struct alarming *alarming)
{
    struct alarm_counts counts;
    int64_t now_ns = clock_mono_ns();
    bool due = now_ns - alarming->counted_ns >= NS_PER_S;
    take_told(alarming);
    store_snapshot(alarming->params.store, now_ns, clock_utc_ns(), alarming->snapshot);
    bool asks = alarming->journal && journal_asks(alarming->journal);
    pthread_mutex_lock(&alarming->lock);
    alarms_hear(alarming->alarms, alarming->taken.at, alarming->taken.count);
    alarms_tick(alarming->alarms, alarming->snapshot);
    uint64_t number = alarms_number(alarming->alarms);
    int raised = alarming->raised_now;
    alarming->raised_now = 0;
    if (due)
        alarms_counts(alarming->alarms, now_ns, &counts);
    if (asks)
        keep_all(alarming);
    pthread_mutex_unlock(&alarming->lock);
    alarming->taken.count = alarming->taken.lost = 0;
    counter_inc(alarming->counters.raised, raised);
    counter_set(alarming->counters.rate, rate(alarming, now_ns, raised));
    if (due) {
        alarming->counted_ns = now_ns;
        count(alarming, &counts);
    }
    if (atomic_exchange(&alarming->number, number) != number && alarming->params.notify)
        alarming->params.notify(alarming->params.notify_arg);
}

static bool wait_for_tick(struct alarming *alarming, int64_t *next_ns)
{
    int64_t now_ns = clock_mono_ns();
    *next_ns = *next_ns + TICK_NS < now_ns ? now_ns : *next_ns + TICK_NS;
    struct timespec until = { *next_ns / NS_PER_S, *next_ns % NS_PER_S };
    pthread_mutex_lock(&alarming->lock);
    while (!alarming->stopping && pthread_cond_timedwait(&alarming->wake, &alarming->lock, &until) != ETIMEDOUT)
        continue;
    bool stopping = alarming->stopping;
    pthread_mutex_unlock(&alarming->lock);
    return !stopping;
}

static void *run(void *arg)
{
    struct alarming *alarming = arg;
    int64_t next_ns = clock_mono_ns();
    do
        tick(alarming);
    while (wait_for_tick(alarming, &next_ns));
    tick(alarming);
    return NULL;
}

/* --- life ------------------------------------------------------------------------------------------------------------------- */

static void add_counters(struct alarming *alarming)
{
    struct counters *c = alarming->params.counters;
    for (int i = 0; i < ALARM_WORDS; i++) {
        char *name = mem_printf("plantcast_alarms{state=\"%s\"}", alarm_word_name((enum alarm_word)i));
        alarming->counters.words[i] = counters_add(c, name, "gauge", "Alarms by their state.");
        mem_free(name);
    }
    alarming->counters.active = counters_add(c, "plantcast_alarms_active", "gauge", "Alarms that are to be seen and whose cause is there.");
    alarming->counters.standing = counters_add(c, "plantcast_alarms_standing", "gauge", "Of these, there for more than a day.");
    alarming->counters.chattering =
        counters_add(c, "plantcast_alarms_chattering", "gauge", "Alarms raised three times or more within the last minute.");
    alarming->counters.held = counters_add(c, "plantcast_alarms_held", "gauge", "Of the active ones, those whose measurement is bad.");
    alarming->counters.rate = counters_add(c, "plantcast_alarms_per_10_minutes", "gauge", "Alarms raised within the last ten minutes.");
    alarming->counters.raised = counters_add(c, "plantcast_alarms_raised_total", "counter", "Alarms raised.");
    alarming->counters.lost = counters_add(c, "plantcast_alarm_samples_lost_total", "counter", "Samples too many to be looked at.");
}

static bool start_journal(struct alarming *alarming)
{
    const struct alarming_params *params = &alarming->params;
    const struct journal_params journal = {
        .log = params->log, .counters = params->counters, .folder = params->folder, .keep_days = params->keep_days
    };
    const struct instant now = { clock_mono_ns(), clock_utc_ns() };
    return !params->folder || (alarming->journal = journal_start(&journal, alarming->alarms, now));
}

static bool start_thread(struct alarming *alarming)
{
    int error = pthread_create(&alarming->thread, NULL, run, alarming);
    atomic_store(&alarming->started, !error);
    if (error)
        log_err(alarming->params.log, "alarms: no thread: %s", strerror(error));
    return !error;
}

static void adopt(struct alarming *alarming, struct alarming *before)
{
    pthread_mutex_lock(&before->lock);
    alarms_adopt(alarming->alarms, before->alarms);
    memcpy(alarming->raised, before->raised, sizeof(alarming->raised));
    alarming->slot = before->slot;
    pthread_mutex_unlock(&before->lock);
}

struct alarming *alarming_start(const struct alarming_params *params)
{
    struct alarming *alarming = mem_new(sizeof(*alarming));
    const struct alarms_listener listener = { on_change, on_tag, alarming };
    pthread_condattr_t attributes;
    pthread_condattr_init(&attributes);
    pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
    pthread_cond_init(&alarming->wake, &attributes);
    pthread_condattr_destroy(&attributes);
    pthread_mutex_init(&alarming->lock, NULL);
    pthread_mutex_init(&alarming->told_lock, NULL);
    alarming->params = *params;
    alarming->snapshot = snapshot_create(params->plant->tag_count);
    alarming->alarms = alarms_create(params->plant, &listener);
    add_counters(alarming);
    store_listen(params->store, on_sample, alarming);
    bool good = start_journal(alarming);
    if (params->before)
        adopt(alarming, params->before);
    alarming->params.before = NULL;
    if (!good || !start_thread(alarming))
        alarming_stop(&alarming);
    return alarming;
}

void alarming_halt(struct alarming *alarming)
{
    store_unlisten(alarming->params.store, on_sample, alarming);
    pthread_mutex_lock(&alarming->lock);
    alarming->stopping = true;
    pthread_cond_signal(&alarming->wake);
    pthread_mutex_unlock(&alarming->lock);
    if (alarming->started)
        pthread_join(alarming->thread, NULL);
    alarming->started = false;
    journal_stop(&alarming->journal);
}

void alarming_stop(struct alarming **pointer)
{
    struct alarming *alarming = *pointer;
    if (!alarming)
        return;
    alarming_halt(alarming);
    alarms_destroy(&alarming->alarms);
    snapshot_destroy(&alarming->snapshot);
    mem_free(alarming->told.at);
    mem_free(alarming->taken.at);
    pthread_cond_destroy(&alarming->wake);
    pthread_mutex_destroy(&alarming->lock);
    pthread_mutex_destroy(&alarming->told_lock);
    mem_free(alarming);
    *pointer = NULL;
}

/* --- asking ----------------------------------------------------------------------------------------------------------------- */

uint64_t alarming_number(const struct alarming *alarming)
{
    return atomic_load(&alarming->number);
}

uint64_t alarming_changes(struct alarming *alarming, uint64_t since, void (*each)(void *arg, const struct alarm *alarm), void *arg)
{
    pthread_mutex_lock(&alarming->lock);
    const struct alarms *alarms = alarming->alarms;
    uint64_t number = alarms_number(alarms);
    for (int i = alarms_newest(alarms); i >= 0; i = alarms_at(alarms, i)->older) {
        const struct alarm *alarm = alarms_at(alarms, i);
        if (alarm->number <= since)
            break;
        if (since || alarm_word_of(alarm) != ALARM_NORMAL)
            each(arg, alarm);
    }
    pthread_mutex_unlock(&alarming->lock);
    return number;
}

const char *alarming_act(struct alarming *alarming, const char *name, enum alarm_kind kind, const struct alarm_act *act)
{
    const char *why = "there is no such alarm";
    if (!alarming->started)
        return "the plant is being loaded anew; try again";
    pthread_mutex_lock(&alarming->lock);
    int index = alarms_find_named(alarming->alarms, name, kind);
    if (index >= 0)
        why = alarms_act(alarming->alarms, index, act, (struct instant){ clock_mono_ns(), clock_utc_ns() });
    uint64_t number = alarms_number(alarming->alarms);
    pthread_mutex_unlock(&alarming->lock);
    if (atomic_exchange(&alarming->number, number) != number && alarming->params.notify)
        alarming->params.notify(alarming->params.notify_arg);
    return why;
}

void alarming_counts(struct alarming *alarming, struct alarm_counts *out)
{
    pthread_mutex_lock(&alarming->lock);
    alarms_counts(alarming->alarms, clock_mono_ns(), out);
    pthread_mutex_unlock(&alarming->lock);
}
