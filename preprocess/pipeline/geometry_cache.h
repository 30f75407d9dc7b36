/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cache of everything that can be reused when only an asset's sensors change, so that the model need not be parsed. KEY.stock
 * contains geometry and levels before subdivision; KEY.surface contains the surface for computing distances (surface_store.h).
 * Both files can be deleted at any time; damaged files are logged and count as missing. Use each cache in one thread only. */
#ifndef PREPROCESS_PIPELINE_GEOMETRY_CACHE_H
#define PREPROCESS_PIPELINE_GEOMETRY_CACHE_H
#include "base/files/cache_file.h"
#include "preprocess/cache/build_cache.h"
#include "preprocess/pipeline/build_io.h"

/* assets with fewer triangles are not cached, because rebuilding them takes about as long as reading the cache */
#define GEOMETRY_CACHE_TRIANGLES 10000u

struct geometry_cache { /* an asset's cached geometry files, mapped into memory and checked */
    struct cache_file parts, surface;
    struct build_report report;
};

/* Maps and checks an asset's two cache files (KEY.stock, KEY.surface) for a geometry key, which does not depend on the asset's
   sensors. Returns false if either is missing or damaged; geometry_cache_close() then need not be called. */
bool geometry_cache_open(struct geometry_cache *cache, struct log *log, const char *folder, uint64_t key);
/* Unmaps the files of the geometry cache. The cache may be open or zeroed. */
void geometry_cache_close(struct geometry_cache *cache);

/* Copies geometry, levels and surface out of the cache; the caller owns all three. Returns false, with nothing to free, if out
 * of memory or if the contents are damaged in spite of the check; *damaged then receives the kind of the file that could not be
 * read. */
bool geometry_cache_unpack(const struct geometry_cache *cache, struct log *log, struct workers *workers, struct geometry *geometry,
                           struct levels *levels, struct surface **surface, enum build_cache_kind *damaged);

/* Serialises geometry and levels of detail to *parts. Must be called before the levels are subdivided. */
void geometry_cache_pack(struct text *parts, const struct geometry *geometry, const struct levels *levels);
/* Writes KEY.stock from the output of geometry_cache_pack() and the report. Returns 0 or -errno. */
int geometry_cache_write(const char *folder, uint64_t key, const void *parts, size_t size, const struct build_report *report);

#endif
