/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes log lines in three formats, and counts repeated lines. */
#include "base/log/log.h"

#include <pthread.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "base/clock.h"
#include "base/log/log_pace.h"
#include "base/mem.h"
#include "base/system/service_manager.h"
#include "base/text/json_text.h"

enum { LINE_BYTES = 2048, LASTING = 16 };
static const int64_t REPEAT_NS = 1000000000, LASTING_FIRST_NS = 60 * NS_PER_S, LASTING_LONGEST_NS = 3600 * NS_PER_S;

struct log {
    enum log_level level;
    enum log_format format;
    char *plant, *journal_socket; /* plant: name of the plant, NULL: none; journal_socket: path of the journal's socket, NULL: the
                                     system's */
    pthread_mutex_t lock;
    /* --- below: under `lock` */
    char last[LINE_BYTES];
    enum log_level last_level;
    enum log_event last_event;
    int64_t last_ns;
    unsigned repeats;
    struct lasting {
        char *text; /* NULL: unused */
        struct log_pace pace;
    } lasting[LASTING]; /* newest texts of log_lasting_err() */
};

struct log *log_create(enum log_level level)
{
    struct log *log = mem_new(sizeof(*log));
    log->level = level;
    pthread_mutex_init(&log->lock, NULL);
    return log;
}

void log_set_format(struct log *log, enum log_format format, const char *journal_socket)
{
    log->format = format;
    mem_free(log->journal_socket);
    log->journal_socket = journal_socket ? mem_strdup(journal_socket) : NULL;
}

void log_set_plant(struct log *log, const char *plant)
{
    mem_free(log->plant);
    log->plant = mem_strdup(plant);
}

bool log_is_text(const struct log *log)
{
    return log->format == LOG_TEXT;
}

static const char *const names[] = { "error", "warn", "info", "debug" };
static const char *const priorities[] = { "3", "4", "6", "7" }; /* syslog priorities, by log level */

static void stamp_now(char *out, size_t size)
{
    char seconds[32];
    struct timespec now;
    struct tm utc;
    clock_gettime(CLOCK_REALTIME, &now);
    gmtime_r(&now.tv_sec, &utc);
    strftime(seconds, sizeof(seconds), "%Y-%m-%dT%H:%M:%S", &utc);
    snprintf(out, size, "%s.%03ldZ", seconds, now.tv_nsec / 1000000);
}

static void emit_text(enum log_level level, const char *text)
{
    char stamp[48];
    stamp_now(stamp, sizeof(stamp));
    fprintf(stderr, "%s %-5s %s\n", stamp, names[level], text);
}

static void emit_json(const struct log *log, enum log_level level, enum log_event event, const char *text)
{
    char stamp[48];
    stamp_now(stamp, sizeof(stamp));
    json_t *object = json_pack("{s:s, s:s, s:o}", "time", stamp, "level", names[level], "message", json_of_text(text));
    if (log->plant)
        json_object_set_new(object, "plant", json_of_text(log->plant));
    if (event) {
        json_object_set_new(object, "event", json_string(log_event_name(event)));
        json_object_set_new(object, "message_id", json_string(log_event_id(event)));
    }
    char *line = json_text(object, 0);
    fprintf(stderr, "%s\n", line);
    mem_free(line);
}

static void emit_journal(const struct log *log, enum log_level level, enum log_event event, const char *text)
{
    const struct service_field fields[] = {
        { "MESSAGE", text },     { "PRIORITY", priorities[level] },  { "SYSLOG_IDENTIFIER", "plantcastd" },
        { "PLANT", log->plant }, { "EVENT", log_event_name(event) }, { "MESSAGE_ID", log_event_id(event) },
    };
    if (!service_journal_send(log->journal_socket ? log->journal_socket : SERVICE_JOURNAL_SOCKET, fields,
                              sizeof(fields) / sizeof(fields[0])))
        fprintf(stderr, "<%s>%s\n", priorities[level], text);
}

static void emit(const struct log *log, enum log_level level, enum log_event event, const char *text)
{
    switch (log->format) {
    case LOG_TEXT: emit_text(level, text); break;
    case LOG_JSON: emit_json(log, level, event, text); break;
    case LOG_JOURNAL: emit_journal(log, level, event, text); break;
    }
}

static void flush_repeats(struct log *log)
{
    if (log->repeats) {
        char text[LINE_BYTES + 40];
        snprintf(text, sizeof(text), "%s (%u more)", log->last, log->repeats);
        emit(log, log->last_level, log->last_event, text);
        log->repeats = 0;
    }
}

void log_destroy(struct log **log)
{
    if (!*log)
        return;
    flush_repeats(*log);
    pthread_mutex_destroy(&(*log)->lock);
    for (int i = 0; i < LASTING; i++)
        mem_free((*log)->lasting[i].text);
    mem_free((*log)->plant);
    mem_free((*log)->journal_socket);
    mem_free(*log);
    *log = NULL;
}

void log_event(struct log *log, enum log_level level, enum log_event event, const char *fmt, ...)
{
    char text[LINE_BYTES];
    va_list ap;
    if (level > log->level)
        return;
    va_start(ap, fmt);
    vsnprintf(text, sizeof(text), fmt, ap);
    va_end(ap);
    pthread_mutex_lock(&log->lock);
    int64_t now_ns = clock_mono_ns();
    if (level == log->last_level && now_ns - log->last_ns < REPEAT_NS && !strcmp(text, log->last)) {
        log->repeats++;
    } else {
        flush_repeats(log);
        emit(log, level, event, text);
        memcpy(log->last, text, sizeof(text));
        log->last_level = level;
        log->last_event = event;
        log->last_ns = now_ns;
    }
    pthread_mutex_unlock(&log->lock);
}

/* Returns the entry of a text. If there is none, replaces the entry that was logged least recently. Call with the lock. */
static struct lasting *find_lasting(struct log *log, const char *text)
{
    struct lasting *oldest = &log->lasting[0];
    for (int i = 0; i < LASTING; i++) {
        struct lasting *entry = &log->lasting[i];
        if (entry->text && !strcmp(entry->text, text))
            return entry;
        if (entry->pace.next_ns < oldest->pace.next_ns)
            oldest = entry;
    }
    mem_free(oldest->text);
    *oldest = (struct lasting){ .text = mem_strdup(text), .pace = { .first_ns = LASTING_FIRST_NS, .longest_ns = LASTING_LONGEST_NS } };
    return oldest;
}

void log_lasting_err(struct log *log, const char *fmt, ...)
{
    char text[LINE_BYTES], more[LOG_PACE_BYTES];
    va_list ap;
    va_start(ap, fmt);
    vsnprintf(text, sizeof(text), fmt, ap);
    va_end(ap);
    pthread_mutex_lock(&log->lock);
    bool due = log_pace_take(&find_lasting(log, text)->pace, clock_mono_ns(), more);
    pthread_mutex_unlock(&log->lock);
    if (due)
        log_err(log, "%s%s", text, more);
}
