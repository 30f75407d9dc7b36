/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The thread that evaluates the alarms of a running plant. */
#include "alarm/alarm_service.h"

#include <errno.h>
#include <stdatomic.h>
#include <string.h>
#include <time.h>

#include "alarm/journal.h"
#include "base/clock.h"
#include "base/mem.h"
#include "base/thread.h"

enum { MAX_ROWS = 2048 /* number of the newest journal rows kept in memory; a standby that connects receives them */ };
enum { QUEUE_MAX = 1000000 /* maximum number of samples queued between two evaluations (a tenth of a second) */, RATE_SLOTS = 60 };
static const int64_t TICK_NS = NS_PER_S / 10, RATE_NS = 600 * NS_PER_S;

struct alarm_event_queue {
    struct sample_event *at;
    size_t count, capacity, lost;
};

struct alarm_service {
    struct alarm_service_params params;
    struct journal *journal;
    struct {
        counter *statuses[ALARM_STATUSES], *priorities[ALARM_PRIORITIES], *active, *standing, *chattering, *held, *rate, *raised, *lost;
    } counters;
    _Atomic uint64_t number;
    /* --- below: used only by the service's own thread */
    struct alarm_event_queue taken;
    struct snapshot *snapshot;
    int64_t counted_ns;
    int raised[RATE_SLOTS]; /* ring buffer: number of alarms raised in each time slot of RATE_NS / RATE_SLOTS nanoseconds */
    int64_t slot;
    pthread_mutex_t queue_lock; /* lock of the sample queue; may be taken while holding the store's lock */
    /* --- below: protected by queue_lock */
    struct alarm_event_queue queue;
    /* the service's own thread. Its lock protects the members below; a thread that holds this lock may also take the store's
       lock */
    struct thread thread;
    /* --- below: protected by thread.lock */
    struct alarms *alarms;
    int raised_now;
    struct journal_entry *rows; /* ring buffer of the newest journal rows; NULL: there is no journal */
    uint64_t row_count;         /* number of journal rows since the start, including those overwritten in the ring buffer */
    int last_error;             /* journal_error() of the journal when it was closed */
    bool ending, lost;          /* ending: the journal is being closed; lost: it was closed before all rows were on disk */
    void (*changed)(void *arg); /* function that is called after alarms have changed; NULL: none */
    void *changed_arg;
};

/* --- taking samples from the store, and setting the alarms of its tags ----------------------------------------------------------- */

static void on_sample(void *arg, const struct sample_event *event)
{
    struct alarm_service *service = arg;
    pthread_mutex_lock(&service->queue_lock);
    struct alarm_event_queue *queue = &service->queue;
    if (queue->count < QUEUE_MAX) {
        mem_grow(&queue->at, &queue->capacity, queue->count + 1, sizeof(*queue->at));
        queue->at[queue->count++] = *event;
    } else {
        queue->lost++;
    }
    pthread_mutex_unlock(&service->queue_lock);
}

static void add_row(struct alarm_service *service, const struct journal_entry *row)
{
    if (service->journal)
        journal_add_entry(service->journal, row);
    if (service->rows)
        service->rows[++service->row_count % MAX_ROWS] = *row;
}

static void on_change(void *arg, const struct alarm_change *change)
{
    struct alarm_service *service = arg;
    service->raised_now += change->event == ALARM_RAISE && alarm_status_is_annunciated(change->after);
    const struct journal_entry row = journal_entry_of(change, change->alarm->name, alarm_unit(service->alarms, change->alarm));
    add_row(service, &row);
}

static void on_tag(void *arg, int tag, enum alarm_kind kind, enum alarm_status status)
{
    struct alarm_service *service = arg;
    store_set_alarm(service->params.store, tag, (int)kind, (int)status);
}

/* --- the thread ------------------------------------------------------------------------------------------------------------- */

static void take_events(struct alarm_service *service)
{
    pthread_mutex_lock(&service->queue_lock);
    struct alarm_event_queue taken = service->queue;
    service->queue = service->taken;
    pthread_mutex_unlock(&service->queue_lock);
    service->taken = taken;
    if (taken.lost) {
        counter_inc(service->counters.lost, (int64_t)taken.lost);
        log_err(service->params.log, "alarms: %zu samples were not checked for alarms: the queue is full", taken.lost);
    }
}

/* Returns the number of alarms raised within the last ten minutes. */
static int rate(struct alarm_service *service, int64_t now_ns, int raised)
{
    int64_t slot = now_ns / (RATE_NS / RATE_SLOTS);
    int all = 0;
    if (slot - service->slot > RATE_SLOTS)
        service->slot = slot - RATE_SLOTS;
    while (service->slot < slot)
        service->raised[++service->slot % RATE_SLOTS] = 0;
    service->raised[slot % RATE_SLOTS] += raised;
    for (int i = 0; i < RATE_SLOTS; i++)
        all += service->raised[i];
    return all;
}

static void count(struct alarm_service *service, const struct alarm_counts *counts)
{
    for (int i = 0; i < ALARM_STATUSES; i++)
        counter_set(service->counters.statuses[i], counts->statuses[i]);
    for (int i = 0; i < ALARM_PRIORITIES; i++)
        counter_set(service->counters.priorities[i], counts->priorities[i]);
    counter_set(service->counters.active, counts->active);
    counter_set(service->counters.standing, counts->standing);
    counter_set(service->counters.chattering, counts->chattering);
    counter_set(service->counters.held, counts->held);
}

static void keep_all(struct alarm_service *service)
{
    for (int i = alarms_newest(service->alarms); i >= 0; i = alarms_at(service->alarms, i)->older) {
        const struct alarm *alarm = alarms_at(service->alarms, i);
        if (alarm_status_of(alarm) != ALARM_NORMAL)
            journal_keep(service->journal, alarm, alarm->name, alarm_unit(service->alarms, alarm));
    }
}

/* Writes the current state of each recently changed alarm to the journal. An alarm has changed recently if its change number
   exceeds `number`, which alarms_number() returned earlier. */
static void keep_since(struct alarm_service *service, uint64_t number)
{
    for (int i = service->journal ? alarms_newest(service->alarms) : -1; i >= 0; i = alarms_at(service->alarms, i)->older) {
        const struct alarm *alarm = alarms_at(service->alarms, i);
        if (alarm->number <= number)
            break;
        journal_keep(service->journal, alarm, alarm->name, alarm_unit(service->alarms, alarm));
    }
}

/* Calls the listeners if any alarm has changed since the last call. number: current change number of the alarms. */
static void tell(struct alarm_service *service, uint64_t number)
{
    if (atomic_exchange(&service->number, number) == number)
        return;
    if (service->params.notify)
        service->params.notify(service->params.notify_arg);
    pthread_mutex_lock(&service->thread.lock);
    if (service->changed)
        service->changed(service->changed_arg);
    pthread_mutex_unlock(&service->thread.lock);
}

static void tick(struct alarm_service *service)
{
    struct alarm_counts counts;
    int64_t now_ns = clock_mono_ns();
    bool due = now_ns - service->counted_ns >= NS_PER_S;
    take_events(service);
    store_snapshot(service->params.store, now_ns, clock_plant_ns(service->params.clock), service->snapshot);
    bool asks = service->journal && journal_asks(service->journal);
    pthread_mutex_lock(&service->thread.lock);
    if (!service->params.mirrors) {
        alarms_put(service->alarms, service->taken.at, service->taken.count);
        alarms_tick(service->alarms, service->snapshot);
    }
    uint64_t number = alarms_number(service->alarms);
    int raised = service->raised_now;
    service->raised_now = 0;
    if (due)
        alarms_counts(service->alarms, now_ns, &counts);
    if (asks)
        keep_all(service);
    pthread_mutex_unlock(&service->thread.lock);
    service->taken.count = service->taken.lost = 0;
    counter_inc(service->counters.raised, raised);
    counter_set(service->counters.rate, rate(service, now_ns, raised));
    if (due) {
        service->counted_ns = now_ns;
        count(service, &counts);
    }
    tell(service, number);
}

static void *alarm_service_main(void *arg)
{
    struct alarm_service *service = arg;
    int64_t next_ns = clock_mono_ns();
    do
        tick(service);
    while (thread_wait_for_tick(&service->thread, TICK_NS, &next_ns));
    tick(service);
    return NULL;
}

/* --- life cycle ------------------------------------------------------------------------------------------------------------------ */

static void add_counters(struct alarm_service *service)
{
    struct counters *c = service->params.counters;
    for (int i = 0; i < ALARM_STATUSES; i++) {
        char *name = mem_printf("plantcast_alarms{state=\"%s\"}", alarm_status_name((enum alarm_status)i));
        service->counters.statuses[i] = counters_add(c, name, "gauge", "Number of alarms in each state.");
        mem_free(name);
    }
    for (int i = 0; i < ALARM_PRIORITIES; i++) {
        char *name = mem_printf("plantcast_alarms_shown{priority=\"%d\"}", i + 1);
        service->counters.priorities[i] =
            counters_add(c, name, "gauge", "Number of alarms in the alarm list, by priority; 1 is the most urgent.");
        mem_free(name);
    }
    service->counters.active = counters_add(c, "plantcast_alarms_active", "gauge", "Alarms in the alarm list that are still active.");
    service->counters.standing =
        counters_add(c, "plantcast_alarms_standing", "gauge", "Alarms in the alarm list that have been active for more than a day.");
    service->counters.chattering =
        counters_add(c, "plantcast_alarms_chattering", "gauge", "Alarms raised three times or more within the last minute.");
    service->counters.held =
        counters_add(c, "plantcast_alarms_held", "gauge", "Active alarms whose state is held, because their reading is Bad.");
    service->counters.rate = counters_add(c, "plantcast_alarms_recent", "gauge", "Alarms raised within the last ten minutes.");
    service->counters.raised = counters_add(c, "plantcast_alarms_raised_total", "counter", "Alarms raised.");
    service->counters.lost =
        counters_add(c, "plantcast_alarm_samples_lost_total", "counter", "Samples not checked for alarms because the queue was full.");
}

static bool start_journal(struct alarm_service *service)
{
    const struct alarm_service_params *params = &service->params;
    const struct journal_params journal = {
        .log = params->log,
        .counters = params->counters,
        .folder = params->folder,
        .keep_days = params->keep_days,
        .reloads = params->before != NULL,
        .adds_ended = !params->before && !params->mirrors,
        .error_before = params->before ? alarm_service_journal_error(params->before) : 0,
    };
    const struct instant now = { clock_mono_ns(), clock_utc_ns() };
    if (!params->folder)
        return true;
    service->rows = mem_array(MAX_ROWS, sizeof(*service->rows));
    return (service->journal = journal_start(&journal, service->alarms, now));
}

/* Adds a journal row for each alarm that a reload ended: it was not normal, and the new plant does not have it, or has other
   settings, with which it is normal. */
static void add_ended(struct alarm_service *service, const struct alarms *before)
{
    for (int i = alarms_newest(before); i >= 0; i = alarms_at(before, i)->older) {
        const struct alarm *alarm = alarms_at(before, i);
        if (!alarms_is_ended(service->alarms, alarm))
            continue;
        const struct journal_entry row =
            journal_entry_of_ended(alarm, alarm->name, alarm_unit(before, alarm), clock_utc_ns(), "a reload removed or changed this alarm");
        add_row(service, &row);
    }
}

static void adopt(struct alarm_service *service, struct alarm_service *before)
{
    pthread_mutex_lock(&before->thread.lock);
    alarms_adopt(service->alarms, before->alarms);
    if (!service->params.mirrors) /* the core that leads sends its rows to a core that mirrors it */
        add_ended(service, before->alarms);
    memcpy(service->raised, before->raised, sizeof(service->raised));
    service->slot = before->slot;
    pthread_mutex_unlock(&before->thread.lock);
}

struct alarm_service *alarm_service_start(const struct alarm_service_params *params)
{
    struct alarm_service *service = mem_new(sizeof(*service));
    const struct alarms_listener listener = { on_change, on_tag, service };
    thread_init(&service->thread);
    pthread_mutex_init(&service->queue_lock, NULL);
    service->params = *params;
    service->snapshot = snapshot_create(params->plant->tag_count);
    service->alarms = alarms_create(params->plant, &listener);
    add_counters(service);
    if (!params->mirrors)
        store_listen(params->store, on_sample, service);
    bool good = start_journal(service);
    if (params->before)
        adopt(service, params->before);
    service->params.before = NULL;
    if (!good || !thread_start(&service->thread, params->log, "alarms", alarm_service_main, service))
        alarm_service_stop(&service);
    return service;
}

void alarm_service_halt(struct alarm_service *service)
{
    store_unlisten(service->params.store, on_sample, service);
    thread_stop(&service->thread);
    pthread_mutex_lock(&service->thread.lock);
    struct journal *journal = service->journal;
    service->journal = NULL;
    service->last_error = journal ? journal_error(journal) : 0;
    service->ending = journal != NULL;
    pthread_mutex_unlock(&service->thread.lock);
    bool all_written = journal_stop(&journal);
    pthread_mutex_lock(&service->thread.lock);
    service->lost = !all_written;
    service->ending = false;
    pthread_mutex_unlock(&service->thread.lock);
}

void alarm_service_stop(struct alarm_service **pointer)
{
    struct alarm_service *service = *pointer;
    if (!service)
        return;
    alarm_service_halt(service);
    alarms_destroy(&service->alarms);
    snapshot_destroy(&service->snapshot);
    mem_free(service->rows);
    mem_free(service->queue.at);
    mem_free(service->taken.at);
    thread_finish(&service->thread);
    pthread_mutex_destroy(&service->queue_lock);
    mem_free(service);
    *pointer = NULL;
}

void alarm_service_listen(struct alarm_service *service, void (*changed)(void *arg), void *arg)
{
    pthread_mutex_lock(&service->thread.lock);
    service->changed = changed;
    service->changed_arg = arg;
    pthread_mutex_unlock(&service->thread.lock);
}

/* --- queries --------------------------------------------------------------------------------------------------------------------- */

uint64_t alarm_service_number(const struct alarm_service *service)
{
    return atomic_load(&service->number);
}

uint64_t alarm_service_changes(struct alarm_service *service, uint64_t since, void (*each)(void *arg, const struct alarm *alarm), void *arg)
{
    pthread_mutex_lock(&service->thread.lock);
    const struct alarms *alarms = service->alarms;
    uint64_t number = alarms_number(alarms);
    for (int i = alarms_newest(alarms); i >= 0; i = alarms_at(alarms, i)->older) {
        const struct alarm *alarm = alarms_at(alarms, i);
        if (alarm->number <= since)
            break;
        if (since || alarm_status_of(alarm) != ALARM_NORMAL)
            each(arg, alarm);
    }
    pthread_mutex_unlock(&service->thread.lock);
    return number;
}

enum refusal_code alarm_service_act(struct alarm_service *service, const char *name, enum alarm_kind kind, const struct alarm_act *act)
{
    enum refusal_code why = REFUSAL_OTHERWISE;
    if (thread_is_stopping(&service->thread))
        return REFUSAL_ANEW;
    pthread_mutex_lock(&service->thread.lock);
    int index = alarms_find_named(service->alarms, name, kind);
    if (index >= 0)
        why = alarms_act(service->alarms, index, act, (struct instant){ clock_mono_ns(), clock_utc_ns() });
    uint64_t number = alarms_number(service->alarms);
    pthread_mutex_unlock(&service->thread.lock);
    tell(service, number);
    return why;
}

struct settling_ticket alarm_service_begin(struct alarm_service *service)
{
    pthread_mutex_lock(&service->thread.lock);
    struct settling_ticket ticket = service->journal ? journal_begin(service->journal) : (struct settling_ticket){ 0 };
    pthread_mutex_unlock(&service->thread.lock);
    return ticket;
}

void alarm_service_end(struct alarm_service *service, struct settling_ticket *ticket)
{
    pthread_mutex_lock(&service->thread.lock);
    if (service->journal)
        journal_end(service->journal, ticket);
    /* The service was halted after alarm_service_begin(), and its journal is closed. It is unknown whether the caller's changes were
       written, so they must not count as saved. */
    else if (service->ending || service->lost)
        ticket->last = UINT64_MAX;
    pthread_mutex_unlock(&service->thread.lock);
}

int alarm_service_settled(struct alarm_service *service, const struct settling_ticket *ticket)
{
    bool any = ticket->last > ticket->first;
    pthread_mutex_lock(&service->thread.lock);
    int state = service->journal         ? journal_settled(service->journal, ticket)
                : any && service->ending ? -EINPROGRESS
                : any && service->lost   ? -EIO
                                         : 0;
    pthread_mutex_unlock(&service->thread.lock);
    return state;
}

int alarm_service_journal_error(struct alarm_service *service)
{
    pthread_mutex_lock(&service->thread.lock);
    int error = service->journal ? journal_error(service->journal) : service->last_error;
    pthread_mutex_unlock(&service->thread.lock);
    return error;
}

const char *alarm_service_mirror(struct alarm_service *service, const struct alarm *list, size_t count, bool whole)
{
    pthread_mutex_lock(&service->thread.lock);
    uint64_t before = alarms_number(service->alarms);
    const char *why = alarms_mirror(service->alarms, list, count, whole)
                          ? NULL
                          : "the core's message has an alarm that this plant does not have: copy the core's tag list to this machine, "
                            "then reload";
    uint64_t number = alarms_number(service->alarms);
    keep_since(service, before);
    pthread_mutex_unlock(&service->thread.lock);
    tell(service, number);
    return why;
}

uint64_t alarm_service_rows(struct alarm_service *service, uint64_t since, void (*each)(void *arg, const struct journal_entry *row),
                            void *arg)
{
    pthread_mutex_lock(&service->thread.lock);
    uint64_t last = service->row_count, first = last > MAX_ROWS && since < last - MAX_ROWS ? last - MAX_ROWS : since;
    for (uint64_t i = first + 1; i <= last; i++)
        each(arg, &service->rows[i % MAX_ROWS]);
    pthread_mutex_unlock(&service->thread.lock);
    return last;
}

void alarm_service_mirror_row(struct alarm_service *service, const struct journal_entry *row)
{
    if (!service->journal)
        return;
    journal_add_entry(service->journal, row);
    pthread_mutex_lock(&service->thread.lock);
    /* keeps the mirrored journal row in memory, to send it later: the former leader may lack the row when it returns as a
       standby */
    service->rows[++service->row_count % MAX_ROWS] = *row;
    pthread_mutex_unlock(&service->thread.lock);
}

void alarm_service_lead(struct alarm_service *service)
{
    pthread_mutex_lock(&service->thread.lock);
    alarms_lead(service->alarms, (struct instant){ clock_mono_ns(), clock_utc_ns() });
    service->params.mirrors = false;
    uint64_t number = alarms_number(service->alarms);
    pthread_mutex_unlock(&service->thread.lock);
    store_listen(service->params.store, on_sample, service);
    tell(service, number);
}

void alarm_service_counts(struct alarm_service *service, struct alarm_counts *out)
{
    pthread_mutex_lock(&service->thread.lock);
    alarms_counts(service->alarms, clock_mono_ns(), out);
    pthread_mutex_unlock(&service->thread.lock);
}
