/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files that keep what would take long to make again: one that is cut, damaged, of another kind or of another key counts as none.
   Thread: any. */
#ifndef BASE_KEPT_H
#define BASE_KEPT_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/atomic_file.h"
#include "base/text.h"

struct kept { /* mapped */
    void *map;
    size_t map_bytes;
    const char *bytes; /* what is kept */
    size_t count;
};

/* magic: 8 bytes. False: there is none that is any good; nothing to close. */
bool kept_open(struct kept *kept, const char *path, const char *magic, uint64_t key);
void kept_close(struct kept *kept); /* a zeroed one is fine */
/* 0 or -errno. */
int kept_write(const char *path, const char *magic, uint64_t key, const void *bytes, size_t count);
int kept_write_parts(const char *path, const char *magic, uint64_t key, const struct atomic_file_part *parts, size_t part_count);

#endif
