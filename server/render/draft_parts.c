/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Clusters of an asset file, each with its vertices numbered by itself. */
#include "render/draft_parts.h"

#include <string.h>

#include "base/mem.h"
#include "render/draft_simd.h"

struct maker {
    struct draft_parts *parts;
    const struct asset_view *file;
    uint32_t *seen; /* by vertex of the file: the part that used it last, counted from 1 */
    uint8_t *number;
    uint8_t corners[3][PART_TRIANGLES + LANES];
};

static uint32_t whole_lanes(uint32_t count)
{
    return (count + LANES - 1) / LANES * LANES;
}

static void add_vertex(struct maker *maker, struct draft_part *part, uint32_t vertex)
{
    struct draft_parts *parts = maker->parts;
    mem_grow(&parts->vertices, &parts->vertex_capacity, parts->vertex_count + 1, sizeof(*parts->vertices));
    parts->vertices[parts->vertex_count++] = vertex;
    maker->seen[vertex] = (uint32_t)parts->part_count + 1;
    maker->number[vertex] = (uint8_t)part->vertex_count++;
}

/* False: there are too many vertices for another triangle. */
static bool add_triangle(struct maker *maker, struct draft_part *part, const uint32_t *indices)
{
    uint32_t part_number = (uint32_t)maker->parts->part_count + 1, fresh = 0;
    for (int i = 0; i < 3; i++)
        fresh += maker->seen[indices[i]] != part_number;
    if (part->triangle_count == PART_TRIANGLES || part->vertex_count + fresh > PART_VERTICES)
        return false;
    for (int i = 0; i < 3; i++) {
        if (maker->seen[indices[i]] != part_number)
            add_vertex(maker, part, indices[i]);
        maker->corners[i][part->triangle_count] = maker->number[indices[i]];
    }
    part->triangle_count++;
    return true;
}

static void end_part(struct maker *maker, struct draft_part *part)
{
    struct draft_parts *parts = maker->parts;
    part->rounded = (uint16_t)whole_lanes(part->triangle_count);
    part->first_corner = (uint32_t)parts->corner_count;
    mem_grow(&parts->corners, &parts->corner_capacity, parts->corner_count + 3u * part->rounded, 1);
    for (int i = 0; i < 3; i++) {
        memset(maker->corners[i] + part->triangle_count, 0, LANES);
        memcpy(parts->corners + parts->corner_count, maker->corners[i], part->rounded);
        parts->corner_count += part->rounded;
    }
    uint32_t last = parts->vertices[parts->vertex_count - 1];
    size_t end = part->first_vertex + whole_lanes(part->vertex_count);
    mem_grow(&parts->vertices, &parts->vertex_capacity, end, sizeof(*parts->vertices));
    while (parts->vertex_count < end)
        parts->vertices[parts->vertex_count++] = last;
    mem_grow(&parts->parts, &parts->part_capacity, parts->part_count + 1, sizeof(*parts->parts));
    parts->parts[parts->part_count++] = *part;
}

/* Most are one part. */
static void add_cluster(struct maker *maker, const struct asset_cluster *cluster, const struct asset_primitive *primitive)
{
    for (uint32_t done = 0; done < cluster->index_count;) {
        struct draft_part part = {
            .cluster = *cluster,
            .first_vertex = (uint32_t)maker->parts->vertex_count,
            .material = (uint16_t)primitive->material,
            .double_sided = maker->file->materials[primitive->material].double_sided != 0,
        };
        uint32_t begin = done;
        while (done < cluster->index_count && add_triangle(maker, &part, maker->file->indices + cluster->first_index + done))
            done += 3;
        if (done - begin < cluster->index_count) {
            part.cluster.first_index += begin;
            part.cluster.index_count = done - begin;
            asset_cluster_measure(&part.cluster, maker->file->positions_m, maker->file->indices);
        }
        end_part(maker, &part);
    }
}

bool draft_parts_init(struct draft_parts *parts, const struct asset_view *file, const struct model_level *level)
{
    *parts = (struct draft_parts){ 0 };
    struct maker maker = {
        .parts = parts,
        .file = file,
        .seen = mem_try_array(level->vertex_count, sizeof(*maker.seen)),
        .number = mem_try_array(level->vertex_count, 1),
    };
    bool good = maker.seen && maker.number;
    const struct asset_cluster *cluster = &file->clusters[level->first_cluster], *last = file->clusters + file->header->cluster_count;
    for (uint32_t p = 0; p < level->primitive_count && good; p++) {
        const struct asset_primitive *primitive = &file->primitives[level->first_primitive + p];
        uint32_t end = primitive->first_index + primitive->index_count;
        for (; cluster < last && cluster->first_index < end && cluster->first_index >= primitive->first_index; cluster++)
            add_cluster(&maker, cluster, primitive);
    }
    mem_free(maker.seen);
    mem_free(maker.number);
    return good;
}

void draft_parts_finish(struct draft_parts *parts)
{
    mem_free(parts->parts);
    mem_free(parts->vertices);
    mem_free(parts->corners);
    *parts = (struct draft_parts){ 0 };
}
