/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Deletes history files of whole months by age and size, or only the oldest points of a month if that suffices. */
#include "history/retention.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/files/database.h"
#include "base/mem.h"
#include "history/month.h"
#include "history/month_file.h"
#include "history/month_outbox.h"

static const char *const parts[] = { "", "-wal", "-shm" };
/* CUT_BYTES: maximum number of bytes deleted from a month in one call, because the recording thread has to wait */
enum { PARTS = sizeof(parts) / sizeof(parts[0]), CUT_BYTES = 16000000 };
static const int64_t NEWEST_US = 600 * US_PER_S; /* the size limit never deletes the last ten minutes of history */
/* Limits on age are not applied for KEEP_AFTER_JUMP_NS after the clock was set forward by more than JUMP_US, or after nothing was
   recorded for more than JUMP_US. */
static const int64_t JUMP_US = 7 * 86400 * US_PER_S, KEEP_AFTER_JUMP_NS = 7 * 86400 * NS_PER_S;
/* fraction of the size limit that is freed in addition when the limit is exceeded, so that it is not soon exceeded again */
#define CUT_BELOW 0.01

static char *path_of(const char *folder, int month, int part)
{
    char name[MONTH_NAME_BYTES];
    month_name(month, name);
    return mem_printf("%s/%s%s", folder, name, parts[part]);
}

static int64_t part_bytes(const char *folder, int month, int part)
{
    struct stat st;
    char *path = path_of(folder, month, part);
    int64_t bytes = stat(path, &st) == 0 ? st.st_size : 0;
    mem_free(path);
    return bytes;
}

static bool delete_month(struct log *log, const char *folder, int month, const char *why)
{
    bool gone = true;
    for (int part = 0; part < PARTS; part++) {
        char *path = path_of(folder, month, part);
        if (unlink(path) != 0 && errno != ENOENT) {
            log_err(log, "%s: cannot be deleted: %s", path, strerror(errno));
            gone = false;
        } else if (part == 0) {
            log_info(log, "%s: deleted: %s", path, why);
        }
        mem_free(path);
    }
    return gone;
}

/* Returns the used bytes of a month's file. Free space in the file counts as used, except in the newest month, whose new points
   will fill it. */
static int64_t used_bytes(struct log *log, const char *folder, int month, bool newest)
{
    struct month_file_size size = { 0 };
    int error;
    struct month_file *file = newest ? month_file_read(log, folder, month, &error) : NULL;
    if (!file || month_file_size(file, &size))
        size.bytes = part_bytes(folder, month, 0);
    month_file_close(&file);
    return size.bytes - size.free_bytes;
}

/* Deletes the oldest points of a month, at most CUT_BYTES. Returns 0, or -errno; cannot_be_cut() tells whether another attempt may
   succeed. */
static int cut_month(struct log *log, const char *folder, int month, bool newest, int64_t too_many, int64_t *unsent)
{
    struct month_file_size size = { 0 };
    int64_t first_us = INT64_MAX, last_us = INT64_MIN;
    int error;
    /* opens the file for reading first, because month_file_open() would rename a damaged one */
    struct month_file *file = month_file_read(log, folder, month, &error);
    if (file && !(error = month_file_size(file, &size)))
        error = month_file_span(file, &first_us, &last_us);
    month_file_close(&file);
    if (error)
        return error;
    if ((!size.shrinks && !newest) || first_us > last_us)
        return -ENOTSUP;
    if (!(file = month_file_open(log, folder, month, NULL, 0, &error)))
        return error;
    /* the free space within the file counts as freed, because the cut returns it to the disk, together with the space of the
       deleted points */
    if (!newest)
        too_many = too_many > size.free_bytes ? too_many - size.free_bytes : 0;
    double share = (double)(too_many < CUT_BYTES ? too_many : CUT_BYTES) / (double)(size.bytes - size.free_bytes);
    int64_t until_us = first_us + (int64_t)((double)(last_us - first_us) * share), latest_us = last_us - NEWEST_US;
    error = month_file_cut(file, until_us < latest_us ? until_us : latest_us, !newest, unsent);
    month_file_close(&file);
    return error;
}

/* Returns true if the error means that points can never be deleted from this file: it is damaged, is of a newer version, has no
   points, or cannot be shrunk. Other errors may pass, such as a full disk or a lock. */
static bool cannot_be_cut(int error)
{
    return error == -ENOTSUP || error == -EBADMSG || error == -DATABASE_NEWER || error == -ENOENT;
}

/* Returns the number of points in a month's outbox that are still to be sent to PostgreSQL; 1 if the outbox cannot be read, so
   that the month is not deleted for its age. */
static int64_t waiting_in(struct log *log, const char *folder, int month)
{
    int error;
    int64_t count = 0;
    struct month_outbox *outbox = month_outbox_open(log, folder, month, &error);
    if (outbox ? month_outbox_count(outbox, &count) != 0 : error != -ENOENT)
        count = 1;
    month_outbox_close(&outbox);
    return count;
}

/* Returns the total of the used bytes of all monthly files, without SQLite's companion files (write-ahead log), whose size is bounded. */
static int64_t all_used(struct log *log, const char *folder, const int *months, size_t count)
{
    int64_t bytes = 0;
    for (size_t i = 0; i < count; i++)
        bytes += used_bytes(log, folder, months[i], i + 1 == count);
    return bytes;
}

/* Finds the times of a month's first and last point; the whole month if its file cannot be read. Returns false if the month has no
   points. */
static bool span_of(struct log *log, const char *folder, int month, int64_t *first_us, int64_t *last_us)
{
    int error;
    *first_us = INT64_MAX;
    *last_us = INT64_MIN;
    struct month_file *file = month_file_read(log, folder, month, &error);
    if (file)
        error = month_file_span(file, first_us, last_us);
    month_file_close(&file);
    if (error) {
        *first_us = month_begin_us(month);
        *last_us = month_begin_us(month + 1);
    }
    return *first_us <= *last_us;
}

/* Finds a pause of the history of more than a week: before the present, one that ended within the last week, or one between the newest
   two months. Skips months of the future: they are left from a clock that was set back. Returns false if there is none. */
static bool find_pause(struct log *log, const char *folder, int64_t now_us, int64_t *from_us, int64_t *to_us)
{
    size_t count;
    int *months = month_list(folder, &count), seen = 0;
    int64_t since_us = now_us, first_us, last_us;
    bool found = false;
    for (size_t i = count; i > 0 && (seen < 2 || since_us > now_us - KEEP_AFTER_JUMP_NS / 1000) && !found; i--) {
        if (!span_of(log, folder, months[i - 1], &first_us, &last_us) || first_us > now_us)
            continue;
        found = since_us - last_us > JUMP_US;
        *from_us = last_us;
        *to_us = since_us;
        since_us = first_us;
        seen++;
    }
    mem_free(months);
    return found;
}

bool retention_by_age(struct retention_clock *clock, struct log *log, const char *folder, int64_t mono_ns, int64_t utc_ns)
{
    const int64_t ahead_ns = utc_ns - mono_ns;
    int64_t from_us = 0, to_us = 0;
    bool jumped = clock->was_called && ahead_ns - clock->ahead_ns > JUMP_US * 1000;
    if (!clock->was_called)
        jumped = find_pause(log, folder, utc_ns / 1000, &from_us, &to_us);
    if (jumped) {
        clock->applies_from_ns = mono_ns + KEEP_AFTER_JUMP_NS;
        clock->pause_from_us = from_us;
        clock->pause_to_us = to_us;
    }
    clock->was_called = true;
    clock->ahead_ns = ahead_ns;
    return mono_ns >= clock->applies_from_ns;
}

/* Deletes the files of a whole month, and adds its number of unsent points (`waiting`) to *unsent. Returns false if its file
   could not be deleted. */
static bool drop_month(struct log *log, const char *folder, int month, const char *why, int64_t waiting, int64_t *unsent)
{
    bool gone = delete_month(log, folder, month, why);
    *unsent += gone ? waiting : 0;
    return gone;
}

int64_t retention_apply(struct log *log, const char *folder, const struct retention_limits *limits, int64_t now_us, int64_t *unsent)
{
    size_t count;
    int *months = month_list(folder, &count);
    int64_t left = 0, used = all_used(log, folder, months, count), oldest_us = now_us - (int64_t)(limits->days * 86400 * US_PER_S);
    *unsent = 0;
    for (size_t i = 0; i < count; i++) {
        bool newest = i + 1 == count, old = limits->days > 0 && month_begin_us(months[i] + 1) <= oldest_us && !newest;
        double too_many = limits->bytes > 0 ? (double)used - limits->bytes : 0;
        int64_t of_month = part_bytes(folder, months[i], 0);
        if (!old && too_many <= 0)
            break;
        int64_t waiting = limits->sends && !newest ? waiting_in(log, folder, months[i]) : 0;
        if (waiting > 0 && too_many <= 0)
            continue;
        bool whole = !newest && ((old && waiting == 0) || too_many >= (double)of_month);
        int error = whole ? 0 : cut_month(log, folder, months[i], newest, (int64_t)(too_many + limits->bytes * CUT_BELOW), unsent);
        if (newest || (!whole && !cannot_be_cut(error)))
            break;
        char *why = old ? mem_printf("older than %g days", limits->days)
                        : mem_printf("history takes %.1f MB, more than the limit of %.1f MB", (double)used / 1e6, limits->bytes / 1e6);
        if (drop_month(log, folder, months[i], why, waiting, unsent))
            used -= of_month;
        mem_free(why);
    }
    if (!limits->sends)
        /* points that an earlier configuration left to be sent to PostgreSQL do not count as lost, because no database is
           configured now */
        *unsent = 0;
    if (*unsent)
        log_event(log, LOG_ERROR, EVENT_HISTORY_LOST,
                  "history: keep_gb: deleted %lld of the oldest points before they were sent to PostgreSQL", (long long)*unsent);
    for (size_t i = 0; i < count; i++)
        for (int part = 0; part < PARTS; part++)
            left += part_bytes(folder, months[i], part);
    mem_free(months);
    return left;
}

/* Returns the used bytes per day of history in a month's file; 0: the file covers less than a day. */
static double bytes_per_day(struct log *log, const char *folder, int month, bool newest)
{
    int error;
    int64_t first_us = INT64_MAX, last_us = INT64_MIN;
    struct month_file *file = month_file_read(log, folder, month, &error);
    bool good = file && month_file_span(file, &first_us, &last_us) == 0 && first_us <= last_us;
    month_file_close(&file);
    double days = good ? (double)(last_us - first_us) / (86400.0 * US_PER_S) : 0;
    return days >= 1 ? (double)used_bytes(log, folder, month, newest) / days : 0;
}

double retention_check(struct log *log, const char *folder, const struct retention_limits *limits)
{
    size_t count;
    double rate = 0;
    int *months = month_list(folder, &count);
    for (size_t i = count; i > 0 && rate <= 0; i--)
        rate = bytes_per_day(log, folder, months[i - 1], i == count);
    double days = limits->bytes > 0 && rate > 0 ? limits->bytes / rate : INFINITY;
    if (days < limits->days)
        log_warn(log,
                 "history: keep_days is %g, but at %.2f GB a day, keep_gb %g is reached after %.0f days; set keep_gb to %.0f,"
                 " or increase deadbands",
                 limits->days, rate / 1e9, limits->bytes / 1e9, days, ceil(rate * limits->days / 1e9));
    mem_free(months);
    return days;
}
