/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cache files: results of long computations, stored under a key. A file that is missing, damaged, of another kind or under
   another key is not used. Call from any thread. */
#ifndef BASE_FILES_CACHE_FILE_H
#define BASE_FILES_CACHE_FILE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/files/atomic_file.h"
#include "base/log/log.h"
#include "base/text/text.h"

enum { CACHE_FILE_WHY_BYTES = 200 };

struct cache_file { /* a cache file that is open for reading (cache_file_open() and similar functions) */
    void *map;      /* mapping of the file; NULL: the file is compressed, and its content is in `decompressed` */
    size_t map_bytes;
    void *decompressed;
    const char *bytes; /* content of the file, without its header; aligned for any type */
    size_t count;
};

/* Maps the file into memory. `magic`: 8 bytes that identify the kind of file. Returns false with the reason in `why` if there is no valid
   file; then cache_file_close() is not needed. */
bool cache_file_open(struct cache_file *file, const char *path, const char *magic, uint64_t key, char why[CACHE_FILE_WHY_BYTES]);
/* Like cache_file_open(), for files that the caller can generate again. Logs a damaged or unreadable file, with its path and
   what is wrong; does not log a missing file, or one of another kind or key. */
bool cache_file_open_if_good(struct cache_file *file, struct log *log, const char *path, const char *magic, uint64_t key);
/* As cache_file_open_if_good(), for files of cache_file_write_compressed(). Reads the whole content into memory, decompressed. */
bool cache_file_open_compressed(struct cache_file *file, struct log *log, const char *path, const char *magic, uint64_t key);
/* As cache_file_open_compressed(), but only maps the file: the content stays compressed, for struct decompressor
   (compress.h). */
bool cache_file_map_compressed(struct cache_file *file, struct log *log, const char *path, const char *magic, uint64_t key);
void cache_file_close(struct cache_file *file); /* Unmaps the file or frees its content; a zeroed struct is fine. */
/* Writes a file by concatenating the parts. Returns 0 or -errno. */
int cache_file_write_parts(const char *path, const char *magic, uint64_t key, const struct atomic_file_part *parts, size_t part_count);
/* As cache_file_write_parts(), compressed (compress.h). Readers that map a file, and readers of compressed files, need different values of
   `magic`. */
int cache_file_write_compressed(const char *path, const char *magic, uint64_t key, const struct atomic_file_part *parts, size_t part_count);

#endif
