/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Maps the asset files that plantcast-prep made into memory, and checks their content. */
#include "scene/asset.h"

#include <errno.h>
#include <fcntl.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/mem.h"

/* Maps a file. Returns MAP_FAILED with errno on failure. The mapped contents never change: plantcast-prep never modifies a file
 * in place, but writes a new file and renames it over the old one. */
static void *map_file(const char *path, size_t *bytes)
{
    struct stat st;
    void *map = MAP_FAILED;
    int file = open(path, O_RDONLY | O_CLOEXEC);
    if (file < 0)
        return MAP_FAILED;
    if (fstat(file, &st) == 0) {
        *bytes = (size_t)st.st_size;
        if (S_ISREG(st.st_mode) && st.st_size > 0)
            map = mmap(NULL, *bytes, PROT_READ, MAP_PRIVATE, file, 0);
        else
            errno = S_ISDIR(st.st_mode) ? EISDIR : ENODATA;
    }
    int cause = errno;
    close(file);
    errno = cause;
    return map;
}

struct asset *asset_open(struct log *log, const char *path)
{
    size_t bytes = 0;
    char why[200];
    void *map = map_file(path, &bytes);
    if (map == MAP_FAILED) {
        log_err(log, "%s: this prepared asset file cannot be read: %s", path, strerror(errno));
        return NULL;
    }
    struct asset *asset = mem_new(sizeof(*asset));
    *asset = (struct asset){ .path = mem_strdup(path), .map = map, .bytes = bytes, .refs = 1 };
    if (!asset_view_init(&asset->view, map, bytes, why)) {
        log_err(log, "%s: %s; run plantcast-prep again", path, why);
        asset_unref(&asset);
        return NULL;
    }
    if (!asset_view_unpack(&asset->view, &asset->distances)) {
        log_err(log, "%s: cannot unpack the distances from %u sensors in this prepared asset file: out of memory", path,
                asset->view.header->sensor_count);
        asset_unref(&asset);
        return NULL;
    }
    asset->closed = mem_array(asset->view.header->level_count, sizeof(*asset->closed));
    return asset;
}

bool asset_open_influence(struct log *log, struct asset *asset)
{
    static const char ending[] = ".asset";
    if (asset->influence.header)
        return true;
    const size_t length = strlen(asset->path), stem = length > sizeof(ending) - 1 ? length - (sizeof(ending) - 1) : length;
    const struct asset_header *header = asset->view.header;
    char why[CACHE_FILE_WHY_BYTES];
    char *path = mem_printf("%.*s.influence", (int)stem, asset->path);
    bool good = cache_file_open(&asset->influence_file, path, INFLUENCE_MAGIC, header->key, why) &&
                influence_view_init(&asset->influence, asset->influence_file.bytes, asset->influence_file.count, header->vertex_count, why);
    if (!good) {
        log_err(log, "%s (the weights of an asset's sensors): %s; run plantcast-prep again", path, why);
        asset->influence = (struct influence_view){ 0 };
        cache_file_close(&asset->influence_file);
    }
    mem_free(path);
    return good;
}

struct asset *asset_stand_in(void)
{
    static const float positions_m[3][3] = { { 0, 0, 0 }, { 1e-6f, 0, 0 }, { 0, 1e-6f, 0 } };
    static const float up[3][3] = { { 0, 0, 1 }, { 0, 0, 1 }, { 0, 0, 1 } };
    static const uint32_t indices[3] = { 0, 1, 2 }, none = ASSET_NO_TEXTURE;
    const struct asset_primitive primitive = { .index_count = 3 };
    const struct asset_material plain = { .alpha_cutoff = 0.5f,
                                          .base_color_texture = none,
                                          .metallic_roughness_texture = none,
                                          .normal_texture = none,
                                          .occlusion_texture = none,
                                          .emissive_texture = none };
    const struct asset_parts parts = { .positions_m = positions_m,
                                       .normals = up,
                                       .indices = indices,
                                       .primitives = &primitive,
                                       .materials = &plain,
                                       .vertex_count = 3,
                                       .index_count = 3,
                                       .primitive_count = 1,
                                       .material_count = 1 };
    struct asset *asset = mem_new(sizeof(*asset));
    char why[200];
    *asset = (struct asset){ .path = mem_strdup(""), .refs = 1 };
    asset->made = asset_build(&parts, &asset->bytes);
    if (!asset->made || !asset_view_init(&asset->view, asset->made, asset->bytes, why)) {
        asset_unref(&asset);
        return NULL;
    }
    asset->closed = mem_array(asset->view.header->level_count, sizeof(*asset->closed));
    return asset;
}

struct asset *asset_ref(struct asset *asset)
{
    atomic_fetch_add_explicit(&asset->refs, 1, memory_order_relaxed);
    return asset;
}

void asset_unref(struct asset **asset_ptr)
{
    struct asset *asset = *asset_ptr;
    *asset_ptr = NULL;
    if (!asset || atomic_fetch_sub_explicit(&asset->refs, 1, memory_order_acq_rel) != 1)
        return;
    asset_forget_closed(asset);
    if (asset->map)
        munmap(asset->map, asset->bytes);
    free(asset->made); /* allocated with malloc() by asset_build() */
    free(asset->distances);
    cache_file_close(&asset->influence_file);
    mem_free(asset->path);
    mem_free(asset);
}

const struct closed_bodies *asset_closed(const struct asset *asset, uint32_t level)
{
    struct closed_bodies *known = atomic_load(&asset->closed[level]);
    if (known)
        return known;
    struct closed_bodies *found = mem_new(sizeof(*found));
    closed_bodies_find(&asset->view, level, found);
    if (atomic_compare_exchange_strong(&asset->closed[level], &known, found))
        return found;
    /* another thread has found and stored the closed bodies of this level first: frees this thread's result */
    closed_bodies_finish(found);
    mem_free(found);
    return known;
}

void asset_forget_closed(struct asset *asset)
{
    for (uint32_t i = 0; asset->closed && i < asset->view.header->level_count; i++) {
        struct closed_bodies *closed = atomic_load(&asset->closed[i]);
        if (closed)
            closed_bodies_finish(closed);
        mem_free(closed);
    }
    mem_free(asset->closed);
    asset->closed = NULL;
}
