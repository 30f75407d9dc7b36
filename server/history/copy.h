/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Copies databases into which a daemon may write meanwhile (SQLite's online backup), and other files; checks that a copy is complete.
   Thread: any. */
#ifndef HISTORY_COPY_H
#define HISTORY_COPY_H
#include <stdbool.h>

#include "base/log/log.h"

/* marker file in the history folder; `plantcast backup` sets its modification time to the time of the backup */
#define HISTORY_BACKUP_STAMP "last-backup"

enum { COPY_HASH_BYTES = 33 }; /* length of a file's hash as text: 32 hexadecimal digits and a terminating 0 */

/* Copies the state of the database `from` at one moment to a single file, checks it and syncs it to disk. Returns false on failure
   (logged); `to` is then removed. This function and copy_file() follow no symbolic link and read no file whose owner is neither the
   owner of its folder nor the caller, so that root can safely copy from a folder of the daemon's user. `to` must not exist; if root
   creates it, it gets the owner of its folder, and only that owner and group can read it. */
bool copy_database(struct log *log, const char *from, const char *to);
/* Copies a file byte for byte. Returns false on failure (logged); `to` is then removed. */
bool copy_file(struct log *log, const char *from, const char *to);
/* Computes the XXH3 hash (128 bits) and the size of a file. Returns false if the file cannot be read (logged). */
bool copy_hash(struct log *log, const char *path, char hash[COPY_HASH_BYTES], long long *bytes);

#endif
