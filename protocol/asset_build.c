/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Builds the bytes of an asset file in memory from the arrays of its sections (struct asset_parts). */
#include <float.h>
#include <stdlib.h>
#include <string.h>
#define XXH_STATIC_LINKING_ONLY /* makes xxhash.h declare the hash state as a complete type, so that XXH3 can keep it on the stack */
#include <xxhash.h>

#include "protocol/asset_distance.h"
#include "protocol/asset_format_impl.h"

static uint64_t align_up(uint64_t n)
{
    return (n + ASSET_ALIGN - 1) / ASSET_ALIGN * ASSET_ALIGN;
}

uint64_t asset_checksum(const void *bytes, size_t size)
{
    struct asset_header header;
    memcpy(&header, bytes, sizeof(header));
    header.checksum = 0;
    XXH3_state_t state;
    XXH3_INITSTATE(&state);
    XXH3_64bits_reset(&state);
    XXH3_64bits_update(&state, &header, sizeof(header));
    XXH3_64bits_update(&state, (const char *)bytes + sizeof(header), size - sizeof(header));
    return XXH3_64bits_digest(&state);
}

uint64_t asset_section_bytes(const struct asset_header *h, int section, bool *optional)
{
    *optional = section == ASSET_TEXCOORDS || section == ASSET_SECOND_TEXCOORDS || section == ASSET_COLORS;
    switch (section) {
    case ASSET_POSITIONS: return 12ull * h->vertex_count;
    case ASSET_NORMALS: return 12ull * h->vertex_count;
    case ASSET_TEXCOORDS:
    case ASSET_SECOND_TEXCOORDS: return 8ull * h->vertex_count;
    case ASSET_COLORS: return 4ull * h->vertex_count;
    case ASSET_INDICES: return 4ull * h->index_count;
    case ASSET_PRIMITIVES: return (uint64_t)sizeof(struct asset_primitive) * h->primitive_count;
    case ASSET_LEVELS: return (uint64_t)sizeof(struct asset_level) * h->level_count;
    case ASSET_CLUSTERS: return (uint64_t)sizeof(struct asset_cluster) * h->cluster_count;
    case ASSET_MATERIALS: return (uint64_t)sizeof(struct asset_material) * h->material_count;
    case ASSET_TEXTURES: return (uint64_t)sizeof(struct asset_texture) * h->texture_count;
    case ASSET_SENSORS: return (uint64_t)sizeof(struct asset_sensor) * h->sensor_count;
    case ASSET_GEODESIC: return 2ull * asset_distance_count(h->sensor_count, h->vertex_count);
    default: return UINT64_MAX;
    }
}

static void bounds_of(const struct asset_parts *parts, struct asset_header *h)
{
    for (int axis = 0; axis < 3; axis++) {
        h->bounds_min_m[axis] = parts->vertex_count ? FLT_MAX : 0;
        h->bounds_max_m[axis] = parts->vertex_count ? -FLT_MAX : 0;
    }
    for (uint32_t i = 0; i < parts->vertex_count; i++)
        for (int axis = 0; axis < 3; axis++) {
            float x = parts->positions_m[i][axis];
            h->bounds_min_m[axis] = x < h->bounds_min_m[axis] ? x : h->bounds_min_m[axis];
            h->bounds_max_m[axis] = x > h->bounds_max_m[axis] ? x : h->bounds_max_m[axis];
        }
}

/* Makes one cluster of each primitive, for assets that were not divided into clusters. Returns NULL if out of memory. */
static struct asset_cluster *plain_clusters(const struct asset_parts *parts, uint32_t *count)
{
    struct asset_cluster *clusters = calloc(parts->primitive_count + 1u, sizeof(*clusters));
    *count = 0;
    for (uint32_t p = 0; clusters && p < parts->primitive_count; p++) {
        const struct asset_primitive *primitive = &parts->primitives[p];
        if (primitive->index_count == 0)
            continue;
        clusters[*count] = (struct asset_cluster){ .first_index = primitive->first_index, .index_count = primitive->index_count };
        asset_cluster_measure(&clusters[(*count)++], parts->positions_m, parts->indices);
    }
    return clusters;
}

static void write_codes(const struct asset_parts *parts, uint16_t *to)
{
    const size_t vertices = parts->vertex_count;
    for (size_t block = 0; block < vertices; block += ASSET_DISTANCE_BLOCK)
        for (size_t s = 0; s < parts->sensor_count; s++, to += ASSET_DISTANCE_BLOCK)
            for (size_t j = 0; j < ASSET_DISTANCE_BLOCK; j++)
                to[j] = block + j < vertices ? asset_distance_code(parts->geodesic_m[s * vertices + block + j]) : ASSET_DISTANCE_NONE;
}

static void *lay_out(const struct asset_parts *parts, size_t *out_bytes)
{
    const struct asset_level all = { .primitive_count = parts->primitive_count, .vertex_count = parts->vertex_count };
    struct asset_header h = {
        .version = ASSET_VERSION,
        .header_bytes = sizeof(h),
        .key = parts->key,
        .vertex_count = parts->vertex_count,
        .index_count = parts->index_count,
        .primitive_count = parts->primitive_count,
        .level_count = parts->levels ? parts->level_count : 1,
        .material_count = parts->material_count,
        .texture_count = parts->texture_count,
        .sensor_count = parts->sensor_count,
        .cluster_count = parts->cluster_count,
    };
    const void *from[ASSET_SECTION_COUNT] = {
        parts->positions_m,
        parts->normals,
        parts->texcoords,
        parts->second_texcoords,
        parts->colors,
        parts->indices,
        parts->primitives,
        parts->levels ? parts->levels : &all,
        parts->clusters,
        parts->materials,
        parts->textures,
        parts->texels,
        parts->sensors,
        parts->geodesic_m,
        parts->names ? parts->names : "",
    };
    memcpy(h.magic, ASSET_MAGIC, sizeof(h.magic));
    memcpy(h.origin_m, parts->origin_m, sizeof(h.origin_m));
    bounds_of(parts, &h);
    uint64_t end = sizeof(h);
    for (int i = 0; i < ASSET_SECTION_COUNT; i++) {
        bool optional;
        uint64_t need = asset_section_bytes(&h, i, &optional);
        if (i == ASSET_TEXELS)
            need = parts->texel_bytes;
        else if (i == ASSET_NAMES)
            need = parts->names ? parts->name_bytes : 1;
        else if (i == ASSET_GEODESIC && parts->packed_bytes)
            need = parts->packed_bytes;
        h.sections[i].offset = align_up(end);
        h.sections[i].bytes = from[i] || (i == ASSET_GEODESIC && parts->write_geodesic) ? need : 0;
        end = h.sections[i].offset + h.sections[i].bytes;
    }
    h.file_bytes = align_up(end);
    char *bytes = parts->make_room ? parts->make_room(parts->room_arg, h.file_bytes) : aligned_alloc(ASSET_ALIGN, h.file_bytes);
    if (!bytes)
        return NULL;
    end = sizeof(h);
    for (int i = 0; i < ASSET_SECTION_COUNT; i++) {
        char *to = bytes + h.sections[i].offset;
        memset(bytes + end, 0, h.sections[i].offset - end);
        if (i == ASSET_GEODESIC && parts->write_geodesic && h.sections[i].bytes)
            parts->write_geodesic(parts->write_arg, (uint16_t *)(void *)to);
        else if (i == ASSET_GEODESIC && h.sections[i].bytes)
            write_codes(parts, (uint16_t *)(void *)to);
        else if (h.sections[i].bytes)
            memcpy(to, from[i], h.sections[i].bytes);
        end = h.sections[i].offset + h.sections[i].bytes;
    }
    memset(bytes + end, 0, h.file_bytes - end);
    memcpy(bytes, &h, sizeof(h));
    h.checksum = asset_checksum(bytes, h.file_bytes);
    memcpy(bytes, &h, sizeof(h));
    *out_bytes = h.file_bytes;
    return bytes;
}

void *asset_build(const struct asset_parts *parts, size_t *bytes)
{
    if (parts->clusters)
        return lay_out(parts, bytes);
    struct asset_parts with = *parts;
    struct asset_cluster *clusters = plain_clusters(parts, &with.cluster_count);
    with.clusters = clusters;
    void *file = clusters ? lay_out(&with, bytes) : NULL;
    free(clusters);
    return file;
}
