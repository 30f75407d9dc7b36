/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The build cache: files that one run of plantcast-prep leaves for the next in the folder of prepared files. An entry is a file
 * of one kind for one key: key, length and checksum, followed by its compressed bytes (cache_file.h). Entries are replaced as a
 * whole and are never required: a missing, truncated or damaged entry, or one of another version or key, counts as absent;
 * damage is logged. Call from any thread, one writer per entry. */
#ifndef PREPROCESS_CACHE_BUILD_CACHE_H
#define PREPROCESS_CACHE_BUILD_CACHE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/files/cache_file.h"

/* Kinds of entries. For each kind, the comment names the source file that packs and unpacks its contents. */
enum build_cache_kind {
    BUILD_CACHE_MODELS,   /* model data: one file for all models, with key 0 (cache/model_cache.c) */
    /* mesh and levels of detail, by geometry key, which does not depend on the asset's sensors (pipeline/geometry_cache.c) */
    BUILD_CACHE_GEOMETRY,
    /* surface on which distances are computed, by geometry key (does not depend on sensors); the daemon reads this file too
       (surface/surface_store.c) */
    BUILD_CACHE_SURFACE,
    /* triangles onto which sample points are projected, by geometry key, which does not depend on sensors
       (subdivision/sample_cache.c) */
    BUILD_CACHE_SAMPLES,
    /* distances from sensors, by distances key, which depends on the asset's sensors; cache/distance_cache.c writes parts of
       the file in place */
    BUILD_CACHE_DISTANCES,
    /* measured interpolation errors of edges and triangles, by distances key, which depends on the asset's sensors
       (subdivision/subdiv_cache.c) */
    BUILD_CACHE_SUBDIVISION,
    BUILD_CACHE_KINDS
};

/* Returns the path of the file of a cache entry. The caller frees it (mem_free). */
char *build_cache_path(const char *folder, enum build_cache_kind kind, uint64_t key);
/* Returns the part of a cache file's name after the key, such as ".surface"; NULL for BUILD_CACHE_MODELS, which has no key. */
const char *build_cache_ending(enum build_cache_kind kind);
/* Returns whether entries of this kind are looked up by the distances key, which depends on the asset's sensors. False: they
 * are looked up by the geometry key, which does not. */
bool build_cache_needs_sensors(enum build_cache_kind kind);

/* Reads the file of a cache entry into memory, decompressed; close it with cache_file_close(). Returns false if there is no valid entry;
 * then it need not be closed. Logs damaged files. */
bool build_cache_open(struct cache_file *entry, struct log *log, const char *folder, enum build_cache_kind kind, uint64_t key);
/* As build_cache_open(), but only maps and checks the file: the entry's contents stay compressed, for struct decompressor
 * (compress.h). For large entries that are opened long before they are needed. */
bool build_cache_map(struct cache_file *entry, struct log *log, const char *folder, enum build_cache_kind kind, uint64_t key);
/* Writes a cache entry whose contents are these parts, one after the other, and replaces an existing entry. Returns 0 or -errno. */
int build_cache_write(const char *folder, enum build_cache_kind kind, uint64_t key, const struct atomic_file_part *parts,
                      size_t part_count);

#endif
