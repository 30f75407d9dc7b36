/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The thread that writes the audit trail to its file, the log and a syslog server. */
#include "audit/audit.h"

#include <errno.h>
#include <inttypes.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>

#include "audit/audit_file.h"
#include "audit/audit_syslog.h"
#include "base/clock.h"
#include "base/mem.h"
#include "base/thread.h"

enum { MAX_QUEUED = 10000, FILE_BYTES = 64 << 20 };
static const int64_t RETRY_NS = NS_PER_S;

struct queued_entry {
    struct audit_entry entry; /* the entry; its texts follow this struct in the same block of memory, so they need no free of their own */
    int64_t utc_us;
    bool said; /* true: the entry is already in the log, because the audit file could not be written */
    struct queued_entry *next;
};

struct audit {
    struct audit_params params;
    char *path;
    struct audit_file file; /* the open audit file; used only by the audit thread */
    struct audit_syslog *syslog;
    _Atomic int error; /* -errno of the last write to the audit file; only the audit thread sets it */
    counter *good, *lines, *lost;
    struct thread thread;
    /* --- below: protected by thread.lock */
    struct queued_entry *first, **last;
    size_t count;
    int64_t lost_count; /* number of entries lost since the last successful write to the audit file */
    struct settling settling;
    pthread_cond_t settled;
};

/* --- queued entries ----------------------------------------------------------------------------------------------------------- */

static struct queued_entry *copy_entry(const struct audit_entry *entry)
{
    const char *const texts[] = { entry->event, entry->result,  entry->who,  entry->role, entry->from,
                                  entry->how,   entry->through, entry->what, entry->why };
    enum { COUNT = sizeof(texts) / sizeof(*texts) };
    size_t bytes = 0, lengths[COUNT];
    for (size_t i = 0; i < COUNT; i++)
        bytes += lengths[i] = texts[i] ? strlen(texts[i]) + 1 : 0;
    struct queued_entry *waiting = mem_new(sizeof(*waiting) + bytes);
    const char **members[COUNT] = { &waiting->entry.event,   &waiting->entry.result, &waiting->entry.who,
                                    &waiting->entry.role,    &waiting->entry.from,   &waiting->entry.how,
                                    &waiting->entry.through, &waiting->entry.what,   &waiting->entry.why };
    char *at = (char *)(waiting + 1);
    for (size_t i = 0; i < COUNT; at += lengths[i++])
        if (texts[i])
            *members[i] = memcpy(at, texts[i], lengths[i]);
    waiting->utc_us = clock_utc_ns() / 1000;
    return waiting;
}

void audit_say(struct audit *audit, const struct audit_entry *entry)
{
    if (!audit)
        return;
    pthread_mutex_lock(&audit->thread.lock);
    if (audit->count >= MAX_QUEUED) {
        counter_inc(audit->lost, 1);
        audit->lost_count++;
        settling_drop(&audit->settling);
    } else {
        struct queued_entry *waiting = copy_entry(entry);
        *audit->last = waiting;
        audit->last = &waiting->next;
        audit->count++;
        audit->settling.queued++;
        pthread_cond_signal(&audit->thread.wake);
    }
    pthread_mutex_unlock(&audit->thread.lock);
}

struct settling_ticket audit_begin(struct audit *audit)
{
    if (!audit)
        return (struct settling_ticket){ 0 };
    pthread_mutex_lock(&audit->thread.lock);
    struct settling_ticket ticket = settling_begin(&audit->settling);
    pthread_mutex_unlock(&audit->thread.lock);
    return ticket;
}

void audit_end(struct audit *audit, struct settling_ticket *ticket)
{
    if (!audit)
        return;
    pthread_mutex_lock(&audit->thread.lock);
    settling_end(&audit->settling, ticket, clock_mono_ns());
    pthread_cond_signal(&audit->thread.wake);
    pthread_mutex_unlock(&audit->thread.lock);
}

int audit_settled(struct audit *audit, const struct settling_ticket *ticket)
{
    if (!audit)
        return 0;
    pthread_mutex_lock(&audit->thread.lock);
    int state = settling_state(&audit->settling, ticket, clock_mono_ns());
    pthread_mutex_unlock(&audit->thread.lock);
    return state;
}

int audit_wait(struct audit *audit, const struct settling_ticket *ticket)
{
    int state;
    if (!audit)
        return 0;
    pthread_mutex_lock(&audit->thread.lock);
    while ((state = settling_state(&audit->settling, ticket, clock_mono_ns())) == -EINPROGRESS)
        clock_cond_wait(&audit->settled, &audit->thread.lock, ticket->until_ns);
    pthread_mutex_unlock(&audit->thread.lock);
    return state;
}

int audit_error(const struct audit *audit)
{
    return audit ? atomic_load(&audit->error) : 0;
}

/* --- writing -------------------------------------------------------------------------------------------------------------- */

static bool is_good(const struct audit_entry *entry)
{
    return !strcmp(entry->result, "done");
}

static void log_entry(struct audit *audit, const struct audit_entry *entry, const char *head, const char *tail)
{
    const char *what = entry->what ? entry->what : "", *why = entry->why ? entry->why : "";
    log_event(audit->params.log, LOG_INFO, EVENT_AUDIT, "%s: %s %s: %s%s%s from %s%s%s%s%s%s%s%s%s%s%s", head, entry->event, entry->result,
              entry->who ? entry->who : "(nobody)", entry->role ? ", " : "", entry->role ? entry->role : "",
              entry->from ? entry->from : "this daemon", entry->how ? " by " : "", entry->how ? entry->how : "",
              entry->through ? " through " : "", entry->through ? entry->through : "", *what ? ": " : "", what, *why ? ": " : "", why,
              *tail ? "; " : "", tail);
}

static void say_written(struct audit *audit, int error)
{
    int before = audit_error(audit);
    if (error && !before)
        log_event(audit->params.log, LOG_ERROR, EVENT_AUDIT_UNWRITABLE,
                  "audit: %s cannot be written (%s); entries are kept in memory and logged here", audit->path, strerror(-error));
    else if (!error && before)
        log_event(audit->params.log, LOG_WARN, EVENT_AUDIT_WRITTEN, "audit: writing to %s works again", audit->path);
    atomic_store(&audit->error, error);
    counter_set(audit->good, !error);
}

/* Appends an entry to the audit file, the log and the queue for the syslog server. Returns 0, or -errno if the entry is not on disk. */
static int write_entry(struct audit *audit, const struct audit_entry *entry, int64_t utc_us)
{
    struct text line = { 0 };
    char *finding;
    int error = audit_file_append(&audit->file, entry, utc_us, &line, &finding);
    if (finding)
        audit_say(audit, &(struct audit_entry){ .event = "audit", .result = "failed", .what = finding });
    mem_free(finding);
    say_written(audit, error);
    if (!error) {
        char head[32], tail[80];
        snprintf(head, sizeof(head), "audit %" PRIu64, audit->file.chain.seq);
        snprintf(tail, sizeof(tail), "hash %s", audit->file.chain.hash);
        counter_inc(audit->lines, 1);
        log_entry(audit, entry, head, tail);
        if (audit->syslog)
            audit_syslog_send(audit->syslog, entry->event, is_good(entry), utc_us, line.at, line.length - 1);
    }
    text_finish(&line);
    return error;
}

/* Removes the oldest queued entry. The caller holds the lock. */
static void free_first(struct audit *audit)
{
    struct queued_entry *first = audit->first;
    audit->first = first->next;
    if (!audit->first)
        audit->last = &audit->first;
    audit->count--;
    mem_free(first);
}

/* Logs the queued entries that cannot be written to the audit file now. The caller holds the lock; only this thread removes entries. */
static void log_waiting(struct audit *audit)
{
    for (struct queued_entry *waiting = audit->first; waiting; waiting = waiting->next) {
        if (!waiting->said)
            log_entry(audit, &waiting->entry, "audit, not written", "");
        waiting->said = true;
    }
}

/* If entries were lost, queues an entry with their number. The caller holds the lock, which is released during the call. */
static void say_lost(struct audit *audit)
{
    int64_t lost = audit->lost_count;
    audit->lost_count = 0;
    if (!lost)
        return;
    char *what = mem_printf("%" PRId64 " audit entries were lost while the audit file could not be written", lost);
    pthread_mutex_unlock(&audit->thread.lock);
    audit_say(audit, &(struct audit_entry){ .event = "audit", .result = "failed", .what = what });
    pthread_mutex_lock(&audit->thread.lock);
    mem_free(what);
}

static void *audit_main(void *arg)
{
    struct audit *audit = arg;
    pthread_mutex_lock(&audit->thread.lock);
    for (;;) {
        while (!audit->first && !audit->thread.stopping)
            pthread_cond_wait(&audit->thread.wake, &audit->thread.lock);
        struct queued_entry *first = audit->first;
        if (!first)
            break;
        pthread_mutex_unlock(&audit->thread.lock);
        int error = write_entry(audit, &first->entry, first->utc_us);
        pthread_mutex_lock(&audit->thread.lock);
        settling_wrote(&audit->settling, !error, error);
        pthread_cond_broadcast(&audit->settled);
        if (!error) {
            free_first(audit);
            say_lost(audit);
        } else if (audit->thread.stopping) {
            log_waiting(audit);
            break;
        } else {
            log_waiting(audit);
            clock_cond_wait(&audit->thread.wake, &audit->thread.lock, clock_mono_ns() + RETRY_NS);
        }
    }
    pthread_mutex_unlock(&audit->thread.lock);
    return NULL;
}

/* --- life cycle --------------------------------------------------------------------------------------------------------------- */

static void finish(struct audit *audit)
{
    audit_syslog_stop(&audit->syslog);
    while (audit->first)
        free_first(audit);
    audit_file_close(&audit->file);
    thread_finish(&audit->thread);
    pthread_cond_destroy(&audit->settled);
    mem_free(audit->path);
    mem_free(audit);
}

static bool start(struct audit *audit)
{
    const struct audit_params *params = &audit->params;
    char *finding;
    int error = audit_file_open(&audit->file, params->path, params->most_bytes ? params->most_bytes : FILE_BYTES, &finding);
    if (finding) {
        log_event(params->log, LOG_ERROR, EVENT_AUDIT_BROKEN, "audit: %s", finding);
        audit_say(audit, &(struct audit_entry){ .event = "audit", .result = "failed", .what = finding });
    }
    mem_free(finding);
    if (error)
        log_err(params->log, "audit: %s: %s", params->path, strerror(-error));
    if (error || (params->syslog && !(audit->syslog = audit_syslog_start(params))))
        return false;
    return thread_start(&audit->thread, params->log, "audit", audit_main, audit);
}

struct audit *audit_start(const struct audit_params *params)
{
    struct audit *audit = mem_new(sizeof(*audit));
    *audit = (struct audit){ .params = *params, .path = mem_strdup(params->path), .file.fd = -1, .last = &audit->first };
    audit->good =
        counters_add(params->counters, "plantcast_audit_good", "gauge", "1 while the daemon can write its audit trail (--audit).");
    audit->lines = counters_add(params->counters, "plantcast_audit_lines_total", "counter", "Lines of the audit trail written.");
    audit->lost = counters_add(params->counters, "plantcast_audit_lost_total", "counter",
                               "Entries lost because the audit trail could not be written.");
    counter_set(audit->good, 1);
    thread_init(&audit->thread);
    clock_cond_init(&audit->settled);
    if (start(audit))
        return audit;
    finish(audit);
    return NULL;
}

void audit_stop(struct audit **pointer)
{
    struct audit *audit = *pointer;
    if (!audit)
        return;
    thread_stop(&audit->thread);
    finish(audit);
    *pointer = NULL;
}
