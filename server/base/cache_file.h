/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files that keep what would take long to make again: one that is cut, damaged, of another kind or of another key counts as none.
   Thread: any. */
#ifndef BASE_CACHE_FILE_H
#define BASE_CACHE_FILE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/atomic_file.h"
#include "base/text.h"

struct cache_file { /* mapped */
    void *map;
    size_t map_bytes;
    const char *bytes; /* what is kept */
    size_t count;
};

/* magic: 8 bytes. False: there is none that is any good; nothing to close. */
bool cache_file_open(struct cache_file *file, const char *path, const char *magic, uint64_t key);
void cache_file_close(struct cache_file *file); /* a zeroed one is fine */
/* 0 or -errno. */
int cache_file_write(const char *path, const char *magic, uint64_t key, const void *bytes, size_t count);
int cache_file_write_parts(const char *path, const char *magic, uint64_t key, const struct atomic_file_part *parts, size_t part_count);

#endif
