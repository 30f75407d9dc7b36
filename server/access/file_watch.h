/* SPDX-License-Identifier: GPL-3.0-or-later */
/* File watch: detects that a file has changed since the caller last read it and must be read again. Call from one thread only. */
#ifndef ACCESS_FILE_WATCH_H
#define ACCESS_FILE_WATCH_H
#include <stdbool.h>
#include <stdint.h>
#include <sys/stat.h>

/* properties of a file from stat(), by which a changed file is recognised; all 0: the file did not exist */
struct file_stamp {
    int64_t seconds, nanoseconds, bytes;
    uint64_t inode;
    unsigned mode, owner;
};

struct file_watch { /* zero-initialise */
    struct file_stamp seen, read;
};

/* Remembers the state of the file that the caller has just read, as fstat() returned it; st NULL: the file does not exist. */
void file_watch_read(struct file_watch *watch, const struct stat *st);
/* Returns true if the file differs from the version last read and has not changed since the previous call. A file that still
   changes between two calls is being written and may be incomplete. */
bool file_watch_changed(struct file_watch *watch, const char *path);

#endif
