/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Deletes months by age and size. */
#include "history/retention.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/mem.h"
#include "history/month.h"

static const char *const parts[] = { "", "-wal", "-shm" };
enum { PARTS = sizeof(parts) / sizeof(parts[0]) };

static char *path_of(const char *folder, int month, int part)
{
    char name[MONTH_NAME_BYTES];
    month_name(month, name);
    return mem_printf("%s/%s%s", folder, name, parts[part]);
}

static int64_t bytes_of(const char *folder, int month)
{
    int64_t bytes = 0;
    for (int part = 0; part < PARTS; part++) {
        struct stat st;
        char *path = path_of(folder, month, part);
        if (stat(path, &st) == 0)
            bytes += st.st_size;
        mem_free(path);
    }
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

int64_t retention_apply(struct log *log, const char *folder, const struct retention_limits *limits, int64_t now_us)
{
    size_t count;
    int *months = month_list(folder, &count);
    int64_t bytes = 0, oldest_us = now_us - (int64_t)(limits->days * 86400 * US_PER_S);
    for (size_t i = 0; i < count; i++)
        bytes += bytes_of(folder, months[i]);
    for (size_t i = 0; i + 1 < count; i++) {
        bool old = limits->days > 0 && month_begin_us(months[i] + 1) <= oldest_us;
        bool large = limits->bytes > 0 && (double)bytes > limits->bytes;
        if (!old && !large)
            break;
        int64_t of_month = bytes_of(folder, months[i]);
        char *why = old ? mem_printf("older than %g days", limits->days)
                        : mem_printf("history takes %.1f MB, more than %.1f MB", (double)bytes / 1e6, limits->bytes / 1e6);
        if (delete_month(log, folder, months[i], why))
            bytes -= of_month;
        mem_free(why);
    }
    mem_free(months);
    return bytes;
}
