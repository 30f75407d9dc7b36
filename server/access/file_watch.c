/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Detects whether a file has changed since the caller last read it. */
#include "access/file_watch.h"

#include <stddef.h>

static struct file_stamp stamp_of(const struct stat *st)
{
    if (!st)
        return (struct file_stamp){ 0 };
    return (struct file_stamp){ st->st_mtim.tv_sec, st->st_mtim.tv_nsec, st->st_size, st->st_ino, st->st_mode, st->st_uid };
}

static bool same(const struct file_stamp *a, const struct file_stamp *b)
{
    return a->seconds == b->seconds && a->nanoseconds == b->nanoseconds && a->bytes == b->bytes && a->inode == b->inode &&
           a->mode == b->mode && a->owner == b->owner;
}

void file_watch_read(struct file_watch *watch, const struct stat *st)
{
    watch->read = watch->seen = stamp_of(st);
}

bool file_watch_changed(struct file_watch *watch, const char *path)
{
    struct stat st;
    struct file_stamp now = stamp_of(stat(path, &st) == 0 ? &st : NULL);
    bool settled = same(&now, &watch->seen);
    watch->seen = now;
    return settled && !same(&now, &watch->read);
}
