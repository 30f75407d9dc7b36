/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A file that is written under another name beside its own, and renamed once all of it is on disk: readers see the old file or the new
   one. Functions that return int return 0 or -errno. Thread: one at a time per file. */
#ifndef BASE_FILES_ATOMIC_FILE_H
#define BASE_FILES_ATOMIC_FILE_H
#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

#include "base/refusal.h"

struct atomic_file {
    char *path, *beside; /* NULL: none is begun */
    int fd;              /* open for reading and writing; rights and owner may be set on it */
};

/* Makes PATH.PID.new, or PATH.PID.N.new where that is there: an existing file or link is never opened. mode is less the umask. On failure
   there is nothing to end. */
int atomic_file_begin(struct atomic_file *file, const char *path, mode_t mode);
int atomic_file_write(struct atomic_file *file, const void *bytes, size_t count);
/* Brings the file to the disk and puts it in its place; on failure removes it. Ends it either way, but for mappings of it. durable: returns
   when the name is on disk too, which takes as long again; what can be made again does not need it. */
int atomic_file_commit(struct atomic_file *file, bool durable);
void atomic_file_abandon(struct atomic_file *file); /* removes it; none is fine */

/* Writes a whole file (mode 0666 less the umask) and commits it; not durable. Returns 0, or -errno. */
int atomic_file_put(const char *path, const void *bytes, size_t count);
/* The same with fsync, for data that the daemon confirms as kept. */
int atomic_file_keep(const char *path, const void *bytes, size_t count);
/* Translates the error of a write (-errno) into a sentence for the user whose change was not kept. Static. */
enum refusal_code atomic_file_not_kept(int error);
struct atomic_file_part {
    const void *bytes;
    size_t count;
};
int atomic_file_put_parts(const char *path, const struct atomic_file_part *parts, size_t part_count); /* one after the other */

#endif
