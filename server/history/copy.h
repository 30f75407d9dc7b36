/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Copies of databases that may be written to meanwhile (SQLite's online backup), and of files; checks that a copy is whole. Thread: any. */
#ifndef HISTORY_COPY_H
#define HISTORY_COPY_H
#include <stdbool.h>

#include "base/log/log.h"

#define HISTORY_BACKUP_STAMP "last-backup" /* beside the months: its time is that of the last backup */

enum { COPY_HASH_BYTES = 33 }; /* 32 hexadecimal digits and a 0 */

/* Both functions follow no symbolic link and read no file whose owner is neither that of its folder nor the caller, so root can copy out of
   a folder of the daemon's. `to` must not exist; if root makes it, it gets the owner of its folder, and only that owner and group read it.

   One state of `from`, as of one moment, as a single file; checked, and on the disk. False: logged; `to` is removed. */
bool copy_database(struct log *log, const char *from, const char *to);
/* Copies a file byte for byte. Returns false on failure (logged); `to` is then removed. */
bool copy_file(struct log *log, const char *from, const char *to);
/* Computes the XXH3 hash (128 bits) and the size of a file. Returns false if it cannot be read (logged). */
bool copy_hash(struct log *log, const char *path, char hash[COPY_HASH_BYTES], long long *bytes);

#endif
