/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The build cache: what one run of plantcast-prep keeps for the next in the folder of prepared files. An entry is a file of one kind for
   one key: its bytes, with key, length and checksum before them (cache_file.h). Entries are replaced as a whole and never needed: one
   that is missing, cut, damaged, of another version or another key counts as absent. Thread: any, one writer per entry. */
#ifndef PREPROCESS_CACHE_BUILD_CACHE_H
#define PREPROCESS_CACHE_BUILD_CACHE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/files/cache_file.h"

/* Each kind's contents are packed and unpacked by the file named here. */
enum build_cache_kind {
    BUILD_CACHE_MODELS,      /* one for all models, of key 0: cache/model_cache.c */
    BUILD_CACHE_GEOMETRY,    /* by geometry key: pipeline/geometry_cache.c */
    BUILD_CACHE_SURFACE,     /* by geometry key: surface/surface_store.c; the daemon reads it too */
    BUILD_CACHE_SAMPLES,     /* by geometry key: subdivision/sample_cache.c */
    BUILD_CACHE_DISTANCES,   /* by distances key: cache/distance_cache.c, which writes parts of it in place */
    BUILD_CACHE_SUBDIVISION, /* by distances key: subdivision/subdiv_cache.c */
    BUILD_CACHE_KINDS
};

/* Returns the path of an entry's file. The caller frees it (mem_free). */
char *build_cache_path(const char *folder, enum build_cache_kind kind, uint64_t key);
/* Returns what follows the key in the names of this kind's files, such as ".surface"; NULL for BUILD_CACHE_MODELS, which has no key. */
const char *build_cache_ending(enum build_cache_kind kind);
/* Returns whether entries of this kind are found by the distances key, which changes with sensors; else by the geometry key. */
bool build_cache_needs_sensors(enum build_cache_kind kind);

/* Maps an entry for reading, until cache_file_close(). Returns false if there is none that is valid, and then there is nothing to close. */
bool build_cache_open(struct cache_file *entry, const char *folder, enum build_cache_kind kind, uint64_t key);
/* Writes an entry of these parts, one after the other, in place of what is there. Returns 0 or -errno. */
int build_cache_write(const char *folder, enum build_cache_kind kind, uint64_t key, const struct atomic_file_part *parts,
                      size_t part_count);

#endif
