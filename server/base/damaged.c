/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A database is a file, and the two of its write-ahead log. */
#include "base/damaged.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "base/mem.h"

bool damaged_set_aside(struct log *log, const char *path)
{
    static const char *const parts[] = { "", "-wal", "-shm" };
    char stamp[32];
    time_t now = time(NULL);
    struct tm tm;
    strftime(stamp, sizeof(stamp), "%Y%m%dT%H%M%SZ", gmtime_r(&now, &tm));
    int stem = (int)(strlen(path) - strlen(".sqlite"));
    bool moved = false;
    for (size_t i = 0; i < sizeof(parts) / sizeof(parts[0]); i++) {
        char *from = mem_printf("%s%s", path, parts[i]);
        char *to = mem_printf("%.*s.damaged-%s.sqlite%s", stem, path, stamp, parts[i]);
        bool good = rename(from, to) == 0;
        if (i == 0) {
            moved = good;
            if (good)
                log_err(log, "%s: is damaged; it was set aside as %s and a new one is begun", path, to);
            else
                log_err(log, "%s: is damaged and cannot be set aside: %s", path, strerror(errno));
        }
        mem_free(from);
        mem_free(to);
    }
    return moved;
}
