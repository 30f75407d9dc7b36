/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Log lines to stderr, with repeats counted. */
#include "base/log.h"

#include <pthread.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "base/clock.h"
#include "base/mem.h"

enum { LINE_BYTES = 2048 };
static const int64_t REPEAT_NS = 1000000000;

struct log {
    enum log_level level;
    pthread_mutex_t lock;
    /* --- below: under lock */
    char last[LINE_BYTES];
    enum log_level last_level;
    int64_t last_ns;
    unsigned repeats;
};

struct log *log_create(enum log_level level)
{
    struct log *log = mem_new(sizeof(*log));
    log->level = level;
    pthread_mutex_init(&log->lock, NULL);
    return log;
}

static void emit(enum log_level level, const char *text)
{
    static const char *const names[] = { "error", "warn", "info", "debug" };
    char stamp[40];
    struct timespec now;
    struct tm utc;
    clock_gettime(CLOCK_REALTIME, &now);
    gmtime_r(&now.tv_sec, &utc);
    strftime(stamp, sizeof(stamp), "%Y-%m-%dT%H:%M:%S", &utc);
    fprintf(stderr, "%s.%03ldZ %-5s %s\n", stamp, now.tv_nsec / 1000000, names[level], text);
}

static void flush_repeats(struct log *log)
{
    if (log->repeats) {
        char text[LINE_BYTES + 40];
        snprintf(text, sizeof(text), "%s (%u more)", log->last, log->repeats);
        emit(log->last_level, text);
        log->repeats = 0;
    }
}

void log_destroy(struct log **log)
{
    if (!*log)
        return;
    flush_repeats(*log);
    pthread_mutex_destroy(&(*log)->lock);
    mem_free(*log);
    *log = NULL;
}

void log_at(struct log *log, enum log_level level, const char *fmt, ...)
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
        emit(level, text);
        memcpy(log->last, text, sizeof(text));
        log->last_level = level;
        log->last_ns = now_ns;
    }
    pthread_mutex_unlock(&log->lock);
}
