/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Databases copied while somebody writes to them (SQLite's online backup), and the check that a copy is whole. Thread: any. */
#ifndef HISTORY_COPY_H
#define HISTORY_COPY_H
#include <stdbool.h>

#include "base/log.h"

enum { COPY_HASH_BYTES = 33 }; /* 32 hexadecimal digits and a 0 */

/* Neither follows a link, nor reads what belongs to somebody else than its folder does (or us): root may copy out of a folder of the
   daemon's. `to` is new, has the folder's owner if root makes it, and is read by nobody but that one and his group.

   One state of `from`, as of one moment, as a single file; checked, and on the disk. False: logged; `to` is removed. */
bool copy_database(struct log *log, const char *from, const char *to);
/* Bytes as they are, likewise. */
bool copy_file(struct log *log, const char *from, const char *to);
/* XXH3, 128 bits, of the whole file. False: it cannot be read (logged). */
bool copy_hash(struct log *log, const char *path, char hash[COPY_HASH_BYTES], long long *bytes);

#endif
