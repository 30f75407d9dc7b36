/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Maps each kind of build cache entry to its file name extension and its file format. */
#include "preprocess/cache/build_cache.h"

#include <inttypes.h>

#include "base/mem.h"
#include "surface/surface_store.h"

static const struct {
    const char *ending;
    const char *magic; /* first 8 bytes (format and version) of this kind's cache files; NULL: these files have their own format */
    bool needs_sensors;
} kinds[BUILD_CACHE_KINDS] = {
    [BUILD_CACHE_MODELS] = { NULL, "PLCCUTS2", false },           [BUILD_CACHE_GEOMETRY] = { ".stock", "PLCSTCK2", false },
    [BUILD_CACHE_SURFACE] = { ".surface", SURFACE_MAGIC, false }, [BUILD_CACHE_SAMPLES] = { ".spots", "PLCSPTS2", false },
    [BUILD_CACHE_DISTANCES] = { ".columns", NULL, true },         [BUILD_CACHE_SUBDIVISION] = { ".splitting", "PLCSPLT3", true },
};

char *build_cache_path(const char *folder, enum build_cache_kind kind, uint64_t key)
{
    const char *ending = kinds[kind].ending;
    return ending ? mem_printf("%s/%016" PRIx64 "%s", folder, key, ending) : mem_printf("%s/cuts", folder);
}

const char *build_cache_ending(enum build_cache_kind kind)
{
    return kinds[kind].ending;
}

bool build_cache_needs_sensors(enum build_cache_kind kind)
{
    return kinds[kind].needs_sensors;
}

bool build_cache_open(struct cache_file *entry, struct log *log, const char *folder, enum build_cache_kind kind, uint64_t key)
{
    char *path = build_cache_path(folder, kind, key);
    bool good = cache_file_open_compressed(entry, log, path, kinds[kind].magic, key);
    mem_free(path);
    return good;
}

bool build_cache_map(struct cache_file *entry, struct log *log, const char *folder, enum build_cache_kind kind, uint64_t key)
{
    char *path = build_cache_path(folder, kind, key);
    bool good = cache_file_map_compressed(entry, log, path, kinds[kind].magic, key);
    mem_free(path);
    return good;
}

int build_cache_write(const char *folder, enum build_cache_kind kind, uint64_t key, const struct atomic_file_part *parts, size_t part_count)
{
    char *path = build_cache_path(folder, kind, key);
    int status = cache_file_write_compressed(path, kinds[kind].magic, key, parts, part_count);
    mem_free(path);
    return status;
}
