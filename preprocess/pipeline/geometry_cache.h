/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What preparing an asset needs again when only its sensors change, so that the model need not be read: KEY.stock beside the asset files
   holds geometry and levels before they are split, KEY.surface the surface that distances are found on (surface_store.h). Both are safe to
   delete; one that is no good counts as none. */
#ifndef PREPROCESS_PIPELINE_GEOMETRY_CACHE_H
#define PREPROCESS_PIPELINE_GEOMETRY_CACHE_H
#include "base/cache_file.h"
#include "preprocess/pipeline/build_io.h"

#define GEOMETRY_CACHE_TRIANGLES 10000u /* of assets with fewer, making it all again is about as quick */

struct geometry_cache { /* checked files; what it points to is its own */
    struct cache_file parts, surface;
    struct build_report report;
};

/* False: there is none that is any good; nothing to close. */
bool geometry_cache_open(struct geometry_cache *stock, const char *folder, uint64_t key);
void geometry_cache_close(struct geometry_cache *stock); /* a zeroed one is fine */

/* Copies of all three are made. False: it is no good after all; nothing to finish. */
bool geometry_cache_unpack(const struct geometry_cache *cache, struct log *log, struct workers *workers, struct geometry *geometry,
                           struct levels *levels, struct surface **surface);

/* Before levels are split. */
void geometry_cache_pack(struct text *parts, const struct geometry *geometry, const struct levels *levels);
/* The parts just packed. 0 or -errno. */
int geometry_cache_write(const char *folder, uint64_t key, const void *parts, size_t size, const struct build_report *report);

#endif
