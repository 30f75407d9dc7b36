/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Replaces a file atomically: writes the new content to a temporary file in the same folder, and renames that once its whole
   content is on disk. Readers see either the old file or the new one. Functions that return int return 0 or -errno. Call from
   one thread at a time per file. */
#ifndef BASE_FILES_ATOMIC_FILE_H
#define BASE_FILES_ATOMIC_FILE_H
#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

#include "base/refusal.h"

struct atomic_file {
    char *path, *beside; /* path of the file, and of the temporary file next to it; NULL: no write is in progress */
    int fd; /* descriptor of the temporary file, for reading and writing; the caller may set the file's permissions and owner */
};

/* Creates the temporary file PATH.PID.new, or PATH.PID.N.new if that exists; never opens an existing file or link. `mode` is reduced by
   the umask. Returns 0 or -errno; after an error there is nothing to clean up. */
int atomic_file_begin(struct atomic_file *file, const char *path, mode_t mode);
int atomic_file_write(struct atomic_file *file, const void *bytes, size_t count);
/* Syncs the temporary file to disk and renames it to its final name, or removes it on failure. Ends the write in either case;
   memory mappings of the file stay valid. durable: also waits until the new name is on disk, which takes twice as long and is
   not needed for data that can be recomputed. Returns 0 or -errno. */
int atomic_file_commit(struct atomic_file *file, bool durable);
void atomic_file_abandon(struct atomic_file *file); /* Removes the temporary file; no-op if no write is in progress. */

/* Writes a whole file (mode 0666 less the umask) but does not wait until its name is on disk. Returns 0 or -errno. */
int atomic_file_put(const char *path, const void *bytes, size_t count);
/* Like atomic_file_put(), but returns only once the file is safely on disk: for data that the daemon confirms as saved. */
int atomic_file_keep(const char *path, const void *bytes, size_t count);
/* Converts the result of a write (0 or -errno) to the refusal for the user whose change was not saved. */
enum refusal_code atomic_file_not_kept(int error);
struct atomic_file_part {
    const void *bytes;
    size_t count;
};
/* Like atomic_file_put(), but concatenates the content from several parts. */
int atomic_file_put_parts(const char *path, const struct atomic_file_part *parts, size_t part_count);

#endif
