/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes log lines to stderr: as text, as JSON, or as entries of the systemd journal. Repeated lines are counted and logged
   once a second. Call from any thread. */
#ifndef BASE_LOG_LOG_H
#define BASE_LOG_LOG_H
#include <stdbool.h>

enum log_level { LOG_ERROR, LOG_WARN, LOG_INFO, LOG_DEBUG };
enum log_format {
    LOG_TEXT, /* format of log lines for people: time, level and text */
    LOG_JSON, /* format of log lines for programs: one JSON object per line with time, level, message, plant, event, message_id */
    /* systemd journal entries with PRIORITY, MESSAGE, PLANT, EVENT, MESSAGE_ID; if the journal's socket cannot be used, lines
       `<PRIORITY>text` */
    LOG_JOURNAL,
};
/* Events that other programs watch for; each has its own name and MESSAGE_ID (log_events.c). */
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

/* Creates a log in text format that drops lines above `level`. Never returns NULL. */
struct log *log_create(enum log_level level);
/* Writes the pending counts of repeated lines, and frees the log. Accepts a pointer to NULL; sets *log to NULL. */
void log_destroy(struct log **log);
/* Sets the format. Call it before other threads use the log. journal_socket: socket for LOG_JOURNAL, copied; NULL: the system journal's
   socket. */
void log_set_format(struct log *log, enum log_format format, const char *journal_socket);
/* Sets the plant's name, which LOG_JSON and LOG_JOURNAL add to each line. Call it before other threads use the log. */
void log_set_plant(struct log *log, const char *plant);
/* Returns true if the format is LOG_TEXT, which is meant for people. */
bool log_is_text(const struct log *log);

void log_event(struct log *log, enum log_level level, enum log_event event, const char *fmt, ...) __attribute__((format(printf, 4, 5)));

/* Logs an error that an action reports again at each retry, such as a file that cannot be opened. The same text is logged again
   after a minute at the earliest, later after pauses that double up to an hour, and then with the number of repetitions. */
void log_lasting_err(struct log *log, const char *fmt, ...) __attribute__((format(printf, 2, 3)));

#define log_at(log, level, ...) log_event(log, level, EVENT_NONE, __VA_ARGS__)
#define log_err(log, ...) log_at(log, LOG_ERROR, __VA_ARGS__)
#define log_warn(log, ...) log_at(log, LOG_WARN, __VA_ARGS__)
#define log_info(log, ...) log_at(log, LOG_INFO, __VA_ARGS__)
#define log_debug(log, ...) log_at(log, LOG_DEBUG, __VA_ARGS__)

/* Returns an event's name for JSON; NULL for EVENT_NONE. log_event_id() returns the event's MESSAGE_ID for the journal. */
const char *log_event_name(enum log_event event);
const char *log_event_id(enum log_event event);

#endif
