/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The thread that writes the alarm journal, and functions that read the journal. */
#include "alarm/journal.h"

#include <errno.h>
#include <math.h>
#include <stdatomic.h>
#include <string.h>
#include <time.h>

#include "base/clock.h"
#include "base/files/database.h"
#include "base/mem.h"
#include "base/thread.h"
#include "history/retention.h"

enum { WAITING_MAX = 200000, RETRY_MAX_S = 30 };
static const int64_t GATHER_NS = NS_PER_S / 4, FORGET_NS = 600 * NS_PER_S;
#define US_PER_DAY INT64_C(86400000000)

struct entries {
    struct journal_entry *at;
    size_t count, capacity;
};

struct journal {
    struct log *log;
    char *folder;
    double keep_days;
    _Atomic int error; /* -errno while the journal cannot be used; 0: it can */
    struct {
        counter *rows, *lost, *waiting, *good;
    } counters;
    /* --- below: used only by the journal's thread */
    struct journal_file *file;
    struct entries taken;
    bool failing;
    int64_t retry_ns, retry_after_ns, forgot_ns;
    struct retention_clock retention_clock;
    struct thread thread;
    /* --- below: protected by thread.lock */
    struct entries waiting;
    bool asks;
    bool urgent; /* true: journal_end() was called, so rows must be written at once */
    struct settling settling;
};

/* --- writing ---------------------------------------------------------------------------------------------------------------- */

static int write_taken(struct journal *journal, int64_t mono_ns)
{
    int error = 0;
    bool renewed = false;
    if (!journal->file && !(journal->file = journal_file_open(journal->log, journal->folder, &renewed, &error)))
        return error;
    if (renewed) {
        pthread_mutex_lock(&journal->thread.lock);
        journal->asks = true;
        pthread_mutex_unlock(&journal->thread.lock);
    }
    error = journal_file_write(journal->file, journal->taken.at, journal->taken.count);
    if (!error) {
        counter_inc(journal->counters.rows, (int64_t)journal->taken.count);
        journal->taken.count = 0;
    }
    if (!error && (!journal->forgot_ns || mono_ns - journal->forgot_ns >= FORGET_NS)) {
        const int64_t utc_ns = clock_utc_ns();
        if (retention_by_age(&journal->retention_clock, journal->log, journal->folder, mono_ns, utc_ns))
            error = journal_file_forget(journal->file, utc_ns / 1000 - (int64_t)(journal->keep_days * (double)US_PER_DAY));
        journal->forgot_ns = error ? 0 : mono_ns;
    }
    if (error) /* closes the file after an error, so that reopening it before the next write detects damage */
        journal_file_close(&journal->file);
    return error;
}

/* Records the result of a write attempt for journal_settled(). count: number of journal rows that were written. */
static void count_written(struct journal *journal, size_t count, int error)
{
    pthread_mutex_lock(&journal->thread.lock);
    settling_wrote(&journal->settling, count, error);
    pthread_mutex_unlock(&journal->thread.lock);
}

static void set_error(struct journal *journal, int error)
{
    journal->failing = error != 0;
    atomic_store(&journal->error, error);
    counter_set(journal->counters.good, !error);
}

/* Writes the journal rows taken from the queue. Without rows, a file that could not be used is tried again, because a quiet plant
   may have no rows for days. now: write even if the retry delay after a failure is not over. */
static void try_to_write(struct journal *journal, bool now)
{
    int64_t mono_ns = clock_mono_ns();
    size_t rows = journal->taken.count;
    if (journal->failing ? !now && mono_ns < journal->retry_ns : !rows)
        return;
    int error = write_taken(journal, mono_ns);
    if (error) {
        int64_t wait_ns = journal->retry_after_ns * 2;
        journal->retry_after_ns = wait_ns < NS_PER_S ? NS_PER_S : wait_ns > RETRY_MAX_S * NS_PER_S ? RETRY_MAX_S * NS_PER_S : wait_ns;
        journal->retry_ns = mono_ns + journal->retry_after_ns;
        if (!journal->failing || error != atomic_load(&journal->error))
            log_err(journal->log, "alarms: the alarm journal cannot be written (%s); new alarm events are kept in memory",
                    database_error_text(error));
    } else if (journal->failing) {
        log_info(journal->log, "alarms: writing the alarm journal works again%s",
                 rows > 0 ? "; the alarm events kept in memory are recorded" : "");
        journal->retry_after_ns = 0;
    }
    set_error(journal, error);
    count_written(journal, rows - journal->taken.count, error);
}

/* Moves the queued journal rows to the list that this thread writes. The caller holds the lock. */
static void take(struct journal *journal)
{
    struct entries *taken = &journal->taken, *waiting = &journal->waiting;
    size_t room = WAITING_MAX - taken->count, count = waiting->count < room ? waiting->count : room;
    if (count < waiting->count) {
        counter_inc(journal->counters.lost, (int64_t)(waiting->count - count));
        journal->settling.lost = journal->settling.queued;
        journal->settling.done += waiting->count - count;
    }
    mem_grow(&taken->at, &taken->capacity, taken->count + count, sizeof(*taken->at));
    if (count > 0)
        memcpy(taken->at + taken->count, waiting->at, count * sizeof(*waiting->at));
    taken->count += count;
    waiting->count = 0;
}

/* Waits for GATHER_NS, so that one transaction writes all rows of that period, and then, if no row is waiting, until the first
   one is queued, or a file that failed is due to be tried again. journal->urgent or the order to stop ends both waits at once.
   Takes the queued rows. *urgent: true if a caller waits for these rows to be stored. Returns false if the thread must end. */
static bool wait_for_work(struct journal *journal, bool *urgent)
{
    int64_t until_ns = clock_mono_ns() + GATHER_NS;
    bool due = false;
    pthread_mutex_lock(&journal->thread.lock);
    while (!journal->thread.stopping && !journal->urgent && clock_cond_wait(&journal->thread.wake, &journal->thread.lock, until_ns))
        continue;
    while (!journal->thread.stopping && !journal->urgent && !journal->waiting.count && !journal->taken.count && !due)
        if (journal->failing)
            due = !clock_cond_wait(&journal->thread.wake, &journal->thread.lock, journal->retry_ns);
        else
            pthread_cond_wait(&journal->thread.wake, &journal->thread.lock);
    take(journal);
    *urgent = journal->urgent;
    journal->urgent = false;
    bool stopping = journal->thread.stopping;
    pthread_mutex_unlock(&journal->thread.lock);
    counter_set(journal->counters.waiting, (int64_t)journal->taken.count);
    return !stopping;
}

static void *journal_main(void *arg)
{
    struct journal *journal = arg;
    bool urgent;
    while (wait_for_work(journal, &urgent))
        try_to_write(journal, urgent);
    if (journal->taken.count)
        try_to_write(journal, true);
    if (journal->taken.count)
        log_err(journal->log, "alarms: %zu alarm events lost: the alarm journal could not be written", journal->taken.count);
    return NULL;
}

/* --- functions that other threads call ------------------------------------------------------------------------------------------- */

static void put(struct journal *journal, const struct journal_entry *entry)
{
    pthread_mutex_lock(&journal->thread.lock);
    struct entries *waiting = &journal->waiting;
    if (waiting->count < WAITING_MAX) {
        mem_grow(&waiting->at, &waiting->capacity, waiting->count + 1, sizeof(*waiting->at));
        waiting->at[waiting->count++] = *entry;
        journal->settling.queued++;
    } else {
        counter_inc(journal->counters.lost, 1);
        settling_drop(&journal->settling);
    }
    if (waiting->count == 1)
        pthread_cond_signal(&journal->thread.wake);
    pthread_mutex_unlock(&journal->thread.lock);
}

struct settling_ticket journal_begin(struct journal *journal)
{
    pthread_mutex_lock(&journal->thread.lock);
    struct settling_ticket ticket = settling_begin(&journal->settling);
    pthread_mutex_unlock(&journal->thread.lock);
    return ticket;
}

void journal_end(struct journal *journal, struct settling_ticket *ticket)
{
    pthread_mutex_lock(&journal->thread.lock);
    settling_end(&journal->settling, ticket, clock_mono_ns());
    journal->urgent |= ticket->last > ticket->first;
    pthread_cond_signal(&journal->thread.wake);
    pthread_mutex_unlock(&journal->thread.lock);
}

int journal_settled(struct journal *journal, const struct settling_ticket *ticket)
{
    pthread_mutex_lock(&journal->thread.lock);
    int state = settling_state(&journal->settling, ticket, clock_mono_ns());
    pthread_mutex_unlock(&journal->thread.lock);
    return state;
}

static void set_unit(struct journal_entry *entry, const char *unit)
{
    entry->has_unit = unit && strlen(unit) < sizeof(entry->unit);
    if (entry->has_unit)
        strcpy(entry->unit, unit);
}

struct journal_entry journal_entry_of(const struct alarm_change *change, const char *tag, const char *unit)
{
    struct journal_entry entry = {
        .alarm = *change->alarm,
        .changed = true,
        .event = change->event,
        .before = change->before,
        .after = change->after,
        .utc_ns = change->utc_ns,
        .value = change->value,
    };
    strncpy(entry.tag, tag, sizeof(entry.tag) - 1);
    set_unit(&entry, unit);
    strncpy(entry.who, change->who, sizeof(entry.who) - 1);
    strncpy(entry.reason, change->reason, sizeof(entry.reason) - 1);
    return entry;
}

struct journal_entry journal_entry_of_ended(const struct alarm *alarm, const char *tag, const char *unit, int64_t utc_ns,
                                            const char *reason)
{
    struct alarm ended = *alarm;
    const struct alarm_change change = { .alarm = &ended,
                                         .event = ALARM_CLEAR,
                                         .before = alarm_status_of(alarm),
                                         .after = ALARM_NORMAL,
                                         .utc_ns = utc_ns,
                                         .value = NAN,
                                         .who = "",
                                         .reason = reason };
    ended.state = (struct alarm_state){ 0 };
    return journal_entry_of(&change, tag, unit);
}

void journal_add_entry(struct journal *journal, const struct journal_entry *entry)
{
    put(journal, entry);
}

void journal_keep(struct journal *journal, const struct alarm *alarm, const char *tag, const char *unit)
{
    struct journal_entry entry = { .alarm = *alarm };
    strncpy(entry.tag, tag, sizeof(entry.tag) - 1);
    set_unit(&entry, unit);
    put(journal, &entry);
}

int journal_error(struct journal *journal)
{
    return atomic_load(&journal->error);
}

bool journal_asks(struct journal *journal)
{
    pthread_mutex_lock(&journal->thread.lock);
    bool asks = journal->asks;
    journal->asks = false;
    pthread_mutex_unlock(&journal->thread.lock);
    return asks;
}

/* --- life cycle ------------------------------------------------------------------------------------------------------------------ */

struct restoring {
    struct journal *journal;
    struct alarms *alarms;
    struct instant now;
    bool adds_ended;
};

static void restore(void *arg, const char *tag, const char *unit, const struct alarm *alarm)
{
    const struct restoring *restoring = arg;
    int index = alarms_find_named(restoring->alarms, tag, alarm->kind);
    struct alarm saved = *alarm;
    saved.name = tag;
    saved.limit = NAN;
    if (index >= 0) {
        const char *is = alarm_unit(restoring->alarms, alarms_at(restoring->alarms, index));
        saved.value = unit ? alarm_value_in_unit(alarm->value, unit, is) : NAN;
        alarms_restore(restoring->alarms, index, &saved, restoring->now);
    }
    if (restoring->adds_ended && alarm->kind != ALARM_NONE && alarms_is_ended(restoring->alarms, &saved)) {
        const struct journal_entry row =
            journal_entry_of_ended(&saved, tag, unit, restoring->now.utc_ns, "a restart removed or changed this alarm");
        put(restoring->journal, &row);
    }
}

/* Restores the alarm states from the journal's file. Skips a damaged file, which the thread renames before it writes. Runs before
   that thread starts. */
static void restore_all(struct journal *journal, const struct journal_params *params, struct alarms *alarms, struct instant now)
{
    struct restoring restoring = { journal, alarms, now, params->adds_ended };
    int error;
    struct journal_file *file = journal_file_read(journal->log, journal->folder, &error);
    if (file)
        error = journal_file_states(file, restore, &restoring);
    journal_file_close(&file);
    if (!error)
        return;
    log_err(journal->log,
            params->reloads
                ? "alarms: the alarm journal in %s cannot be read (%s): alarms keep their states, but the states of new tags' alarms "
                  "are not restored"
                : "alarms: the alarm journal in %s cannot be read (%s): acknowledged, shelved and suppressed alarms are not restored",
            journal->folder, database_error_text(error));
    if (error != -EBADMSG)
        set_error(journal, error);
}

static void add_counters(struct journal *journal, struct counters *counters)
{
    journal->counters.rows =
        counters_add(counters, "plantcast_alarm_journal_rows_total", "counter", "Alarm state changes written to the journal.");
    journal->counters.lost =
        counters_add(counters, "plantcast_alarm_journal_lost_total", "counter", "Alarm state changes that could not be stored.");
    journal->counters.waiting =
        counters_add(counters, "plantcast_alarm_journal_waiting", "gauge", "Alarm state changes waiting to be written.");
    journal->counters.good = counters_add(counters, "plantcast_alarm_journal_good", "gauge", "1 while the alarm journal can be written.");
    counter_set(journal->counters.good, 1);
}

struct journal *journal_start(const struct journal_params *params, struct alarms *alarms, struct instant now)
{
    struct journal *journal = mem_new(sizeof(*journal));
    thread_init(&journal->thread);
    journal->log = params->log;
    journal->folder = mem_strdup(params->folder);
    journal->keep_days = params->keep_days;
    add_counters(journal, params->counters);
    restore_all(journal, params, alarms, now);
    if (!journal->failing && params->error_before)
        set_error(journal, params->error_before);
    if (!thread_start(&journal->thread, params->log, "alarms: journal", journal_main, journal))
        journal_stop(&journal);
    return journal;
}

bool journal_stop(struct journal **pointer)
{
    struct journal *journal = *pointer;
    if (!journal)
        return true;
    thread_stop(&journal->thread);
    bool all_written = journal->taken.count == 0;
    journal_file_close(&journal->file);
    mem_free(journal->waiting.at);
    mem_free(journal->taken.at);
    mem_free(journal->folder);
    thread_finish(&journal->thread);
    mem_free(journal);
    *pointer = NULL;
    return all_written;
}

int journal_read(struct log *log, const char *folder, const struct journal_query *query,
                 void (*each)(void *arg, const struct journal_row *row), void *arg)
{
    int error;
    struct journal_file *file = journal_file_read(log, folder, &error);
    if (file)
        error = journal_file_rows(file, query, each, arg);
    journal_file_close(&file);
    return error;
}

int journal_at(struct log *log, const char *folder, int64_t t_us, void (*each)(void *arg, const struct journal_row *row), void *arg)
{
    int error;
    struct journal_file *file = journal_file_read(log, folder, &error);
    if (file)
        error = journal_file_at(file, t_us, each, arg);
    journal_file_close(&file);
    return error;
}
