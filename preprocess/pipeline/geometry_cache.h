/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cache of what preparing an asset needs again when only its sensors change, so that the model need not be parsed: KEY.stock holds geometry
   and levels before subdivision, KEY.surface the surface that distances are computed on (surface_store.h). Safe to delete; damaged files
   count as absent. Thread: one per cache. */
#ifndef PREPROCESS_PIPELINE_GEOMETRY_CACHE_H
#define PREPROCESS_PIPELINE_GEOMETRY_CACHE_H
#include "base/files/cache_file.h"
#include "preprocess/pipeline/build_io.h"

#define GEOMETRY_CACHE_TRIANGLES 10000u /* of assets with fewer, making it all again is about as quick */

struct geometry_cache { /* checked files; what it points to is its own */
    struct cache_file parts, surface;
    struct build_report report;
};

/* Maps and checks the files of this key. Returns false if either is missing or damaged, and then there is nothing to close. */
bool geometry_cache_open(struct geometry_cache *cache, const char *folder, uint64_t key);
/* Unmaps the files. A zeroed cache is fine. */
void geometry_cache_close(struct geometry_cache *cache);

/* Copies geometry, levels and surface out of the cache; the caller owns all three. Returns false if the contents are damaged after all, and
   then there is nothing to finish. */
bool geometry_cache_unpack(const struct geometry_cache *cache, struct log *log, struct workers *workers, struct geometry *geometry,
                           struct levels *levels, struct surface **surface);

/* Appends geometry and levels to *parts as bytes. To be called before the levels are subdivided. */
void geometry_cache_pack(struct text *parts, const struct geometry *geometry, const struct levels *levels);
/* Writes KEY.stock from the bytes that geometry_cache_pack() made, and the report. Returns 0 or -errno. */
int geometry_cache_write(const char *folder, uint64_t key, const void *parts, size_t size, const struct build_report *report);

#endif
