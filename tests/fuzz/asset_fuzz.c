/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Feeds random bytes to asset_view_init, once unchanged and once with the size and checksum in the header corrected, because
   hardly any random input passes these two checks. If a file is accepted, every byte of its sections must be readable. */
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <xxhash.h>

#include "protocol/asset_distance.h"
#include "protocol/asset_format.h"
#include "tests/fuzz/promise.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count);

static void check_primitives(const struct asset_view *view)
{
    const struct asset_header *h = view->header;
    for (uint32_t l = 0; l < h->level_count; l++)
        for (uint32_t p = 0; p < view->levels[l].primitive_count; p++) {
            const struct asset_primitive *primitive = &view->primitives[view->levels[l].first_primitive + p];
            require(primitive->material < h->material_count && memchr(view->names + primitive->name, 0, 1 << 20),
                    "primitives have a material and a name");
            for (uint32_t i = 0; i < primitive->index_count; i++)
                require(isfinite(view->positions_m[view->indices[primitive->first_index + i]][2]), "triangles have corners");
        }
}

static void check_clusters(const struct asset_view *view)
{
    uint32_t next = 0;
    for (uint32_t p = 0; p < view->header->primitive_count; p++)
        for (uint32_t at = 0; at < view->primitives[p].index_count; next++) {
            require(next < view->header->cluster_count, "clusters hold the primitives");
            const struct asset_cluster *cluster = &view->clusters[next];
            require(cluster->first_index == view->primitives[p].first_index + at, "clusters leave no gap");
            require(cluster->low_m[1] <= view->positions_m[view->indices[cluster->first_index]][1], "boxes hold their vertices");
            at += cluster->index_count;
        }
    require(next == view->header->cluster_count, "clusters are the primitives'");
}

static void check_view(const struct asset_view *view)
{
    const struct asset_header *h = view->header;
    unsigned sum = 0;
    check_primitives(view);
    check_clusters(view);
    for (uint32_t v = 0; v < h->vertex_count; v++) {
        require(isfinite(view->positions_m[v][0]) && isfinite(view->normals[v][2]), "vertices are finite");
        require(!view->texcoords || isfinite(view->texcoords[v][1]), "texture coordinates are finite");
        require(!view->second_texcoords || isfinite(view->second_texcoords[v][1]), "second texture coordinates are finite");
        sum += view->colors ? view->colors[v][3] : 0;
    }
    for (uint32_t t = 0; t < h->texture_count; t++)
        for (uint64_t i = 0; i < 4ull * view->textures[t].width_px * view->textures[t].height_px; i++)
            sum += view->texels[view->textures[t].offset + i];
    for (uint32_t m = 0; m < h->material_count; m++)
        require(view->materials[m].roughness >= 0 && memchr(view->names + view->materials[m].name, 0, 1 << 20), "materials");
    for (uint32_t s = 0; s < h->sensor_count; s++) {
        require(view->sensors[s].nearest_vertex < h->vertex_count && isfinite(view->sensors[s].surface_m[0]), "sensors");
        for (uint32_t v = 0; v < h->vertex_count; v++)
            require(asset_distance_m(view, s, v) >= 0, "distances");
    }
    volatile unsigned read = sum; /* keeps the compiler from removing the reads */
    (void)read;
}

static void try_bytes(const void *bytes, size_t count)
{
    struct asset_view view;
    char why[200] = "";
    uint16_t *codes;
    if (asset_view_init(&view, bytes, count, why)) {
        require(asset_view_unpack(&view, &codes), "memory");
        check_view(&view);
        free(codes);
    } else
        require(why[0], "a reason");
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count)
{
    void *copy;
    /* copied to a buffer of the exact size, so that reads beyond the end are detected */
    if (posix_memalign(&copy, ASSET_ALIGN, count ? count : 1) != 0)
        return 0;
    char *at = memcpy(copy, bytes, count);
    try_bytes(at, count);
    if (count >= sizeof(struct asset_header)) {
        struct asset_header *header = (struct asset_header *)copy;
        header->version = ASSET_VERSION;
        header->file_bytes = count;
        header->checksum = 0;
        header->checksum = XXH3_64bits(at, count);
        try_bytes(at, count);
    }
    free(copy);
    return 0;
}
