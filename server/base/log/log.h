/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes log lines to stderr: as text, as JSON, or as entries of the journal. Repeated lines are counted and logged once a second.
   Thread: any. */
#ifndef BASE_LOG_LOG_H
#define BASE_LOG_LOG_H
#include <stdbool.h>

enum log_level { LOG_ERROR, LOG_WARN, LOG_INFO, LOG_DEBUG };
enum log_format {
    LOG_TEXT,    /* time, level, text */
    LOG_JSON,    /* one object per line: time, level, message, plant, event, message_id */
    LOG_JOURNAL, /* entries of the journal: PRIORITY, MESSAGE, PLANT, EVENT, MESSAGE_ID; lines `<PRIORITY>text` if its socket is closed */
};
/* What programs wait for; each has a name and a MESSAGE_ID of its own (log_events.c). */
enum log_event {
    EVENT_NONE,
    EVENT_READY,
    EVENT_STOPPING,
    EVENT_RELOADED,
    EVENT_RELOAD_REFUSED,
    EVENT_CERTIFICATE_EXPIRES,
    EVENT_CERTIFICATE_REFUSED,
    EVENT_LOGIN_REFUSED,
    EVENT_HISTORY_UNWRITABLE,
    EVENT_HISTORY_WRITTEN,
    EVENT_HISTORY_LOST,
    EVENT_AUDIT,
    EVENT_AUDIT_UNWRITABLE,
    EVENT_AUDIT_WRITTEN,
    EVENT_AUDIT_BROKEN,
    EVENT_AUDIT_NOT_SENT,
    EVENT_OPENID_FAILS,
    EVENT_COUNT,
};

struct log;

/* Creates a log of text that drops lines above `level`. Never returns NULL. */
struct log *log_create(enum log_level level);
/* Writes the repeated lines still held back, and frees the log. &NULL is fine; leaves NULL. */
void log_destroy(struct log **log);
/* For before other threads use the log. journal_socket: of LOG_JOURNAL; copied; NULL: the journal's own. */
void log_set_format(struct log *log, enum log_format format, const char *journal_socket);
/* Names the plant in JSON and in the journal; likewise. */
void log_set_plant(struct log *log, const char *plant);
/* Returns whether lines are text that a person reads as they come. */
bool log_is_text(const struct log *log);

void log_event(struct log *log, enum log_level level, enum log_event event, const char *fmt, ...) __attribute__((format(printf, 4, 5)));

#define log_at(log, level, ...) log_event(log, level, EVENT_NONE, __VA_ARGS__)
#define log_err(log, ...) log_at(log, LOG_ERROR, __VA_ARGS__)
#define log_warn(log, ...) log_at(log, LOG_WARN, __VA_ARGS__)
#define log_info(log, ...) log_at(log, LOG_INFO, __VA_ARGS__)
#define log_debug(log, ...) log_at(log, LOG_DEBUG, __VA_ARGS__)

/* Returns what an event is called in JSON, and its MESSAGE_ID in the journal; NULL for EVENT_NONE. */
const char *log_event_name(enum log_event event);
const char *log_event_id(enum log_event event);

#endif
