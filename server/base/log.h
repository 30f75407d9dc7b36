/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes log lines to stderr: time, level, text. Repeated lines are counted and logged once a second. Thread: any. */
#ifndef BASE_LOG_H
#define BASE_LOG_H
enum log_level { LOG_ERROR, LOG_WARN, LOG_INFO, LOG_DEBUG };

struct log;

/* Creates a log that drops lines above `level`. Never returns NULL. */
struct log *log_create(enum log_level level);
/* Writes the repeated lines still held back, and frees the log. &NULL is fine; leaves NULL. */
void log_destroy(struct log **log);

void log_at(struct log *log, enum log_level level, const char *fmt, ...) __attribute__((format(printf, 3, 4)));

#define log_err(log, ...) log_at(log, LOG_ERROR, __VA_ARGS__)
#define log_warn(log, ...) log_at(log, LOG_WARN, __VA_ARGS__)
#define log_info(log, ...) log_at(log, LOG_INFO, __VA_ARGS__)
#define log_debug(log, ...) log_at(log, LOG_DEBUG, __VA_ARGS__)

#endif
