/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Whether a file has become another since it was read. */
#ifndef ACCESS_FILE_WATCH_H
#define ACCESS_FILE_WATCH_H
#include <stdbool.h>
#include <stdint.h>
#include <sys/stat.h>

struct file_stamp { /* all 0: no file */
    int64_t seconds, nanoseconds, bytes;
    uint64_t inode;
    unsigned mode, owner;
};

struct file_watch { /* zero-initialise */
    struct file_stamp seen, read;
};

/* What was read now; st NULL: there was none. */
void file_watch_read(struct file_watch *watch, const struct stat *st);
/* True: it is another than what was read, and was the same at the last look: a file that is being written may be half a file. */
bool file_watch_changed(struct file_watch *watch, const char *path);

#endif
