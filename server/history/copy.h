/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Copies databases to which a daemon may be writing (SQLite's online backup), and other files; checks that a copy is complete.
   Call from any thread. */
#ifndef HISTORY_COPY_H
#define HISTORY_COPY_H
#include <stdbool.h>

#include "base/log/log.h"

/* marker file in the history folder; its modification time is that of the last `plantcast backup` */
#define HISTORY_BACKUP_STAMP "last-backup"

enum { COPY_HASH_BYTES = 33 }; /* size in bytes of a file's hash as text: 32 hexadecimal digits and a terminating 0 */

/* Copies a consistent state of the database `from` to a single file, checks it and syncs it to disk. Returns false on failure
   (logged); `to` is then removed. This function and copy_file() follow no symbolic links, and read only files that belong to
   the owner of their folder or to the caller. So root can safely copy from a folder of the daemon's user. `to` must not exist;
   if root creates it, it gets the owner of its folder, and only that owner and group can read it. */
bool copy_database(struct log *log, const char *from, const char *to);
/* Copies a file byte for byte. Returns false on failure (logged); `to` is then removed. */
bool copy_file(struct log *log, const char *from, const char *to);
/* Computes a file's size and XXH3 hash (128 bits). Returns false if the file cannot be read (logged). */
bool copy_hash(struct log *log, const char *path, char hash[COPY_HASH_BYTES], long long *bytes);

#endif
