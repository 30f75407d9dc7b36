/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes parts (groups of triangles, soft/parts.h) from the clusters of an asset file. Within a part, a vertex has a local index that fits
   in a byte. */
#include "render/soft/parts.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "render/soft/lanes.h"

struct parts_maker {
    struct soft_parts *parts;
    const struct asset_view *file;
    uint32_t *seen; /* by vertex of the file: 1 + index of the newest part that uses the vertex; 0: none */
    uint8_t *number;
    uint8_t corners[3][PART_TRIANGLES];
};

static uint32_t whole_lanes(uint32_t count)
{
    return (count + LANES - 1) / LANES * LANES;
}

static void add_vertex(struct parts_maker *maker, struct soft_part *part, uint32_t vertex)
{
    struct soft_parts *parts = maker->parts;
    mem_grow(&parts->vertices, &parts->vertex_capacity, parts->vertex_count + 1, sizeof(*parts->vertices));
    parts->vertices[parts->vertex_count++] = vertex;
    maker->seen[vertex] = (uint32_t)parts->part_count + 1;
    maker->number[vertex] = (uint8_t)part->vertex_count++;
}

/* Adds a triangle to the part (group of triangles). Returns false if the part has no room for the triangle's vertices. */
static bool add_triangle(struct parts_maker *maker, struct soft_part *part, const uint32_t *indices)
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

/* --- sorting by direction of the normal ----------------------------------------------------------------------------------- */

/* Triangles are sorted by the direction of their normals. Octahedral mapping unfolds all directions into a square; the sort key
   is the index of a cell of this square. */
enum { DIRECTION_CELLS = 8, DIRECTION_COUNT = DIRECTION_CELLS * DIRECTION_CELLS };

struct plane_of_triangle {
    float normal[3], along;
};

static struct plane_of_triangle plane_of_triangle(const float *a, const float *b, const float *c)
{
    double u[3], v[3], n[3], square = 0, along = 0;
    struct plane_of_triangle plane = { 0 };
    for (int i = 0; i < 3; i++) {
        u[i] = (double)b[i] - (double)a[i];
        v[i] = (double)c[i] - (double)a[i];
    }
    for (int i = 0; i < 3; i++) {
        n[i] = u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3];
        square += n[i] * n[i];
    }
    for (int i = 0; i < 3 && square > 0; i++) {
        plane.normal[i] = (float)(n[i] / sqrt(square));
        along += n[i] / sqrt(square) * (double)a[i];
    }
    plane.along = (float)along;
    return plane;
}

static int step_of(float x)
{
    int step = (int)((x + 1) * (DIRECTION_CELLS / 2));
    return step < DIRECTION_CELLS ? step : DIRECTION_CELLS - 1;
}

/* Returns the direction of a normal as the index of a cell (0 to DIRECTION_COUNT - 1). Normals with close indices mostly point in similar
   directions. */
static int direction_of(const float n[3])
{
    float sum = fabsf(n[0]) + fabsf(n[1]) + fabsf(n[2]);
    if (sum == 0)
        return 0;
    float x = n[0] / sum, y = n[1] / sum;
    if (n[2] < 0) {
        float folded = copysignf(1 - fabsf(y), x);
        y = copysignf(1 - fabsf(x), y);
        x = folded;
    }
    int row = step_of(y), column = step_of(x);
    return row * DIRECTION_CELLS + (row % 2 ? DIRECTION_CELLS - 1 - column : column);
}

/* Writes the triangles into the part (group of triangles), sorted by direction. */
static void write_triangles(const struct parts_maker *maker, const struct soft_part *part)
{
    struct soft_parts *parts = maker->parts;
    struct plane_of_triangle planes[PART_TRIANGLES];
    uint8_t directions[PART_TRIANGLES];
    uint16_t starts[DIRECTION_COUNT + 1] = { 0 };
    float *out = parts->planes + 4 * (size_t)(part->first_corner / 3);
    for (int t = 0; t < part->triangle_count; t++) {
        const float *at[3];
        for (int i = 0; i < 3; i++)
            at[i] = maker->file->positions_m[parts->vertices[part->first_vertex + maker->corners[i][t]]];
        planes[t] = plane_of_triangle(at[0], at[1], at[2]);
        directions[t] = (uint8_t)direction_of(planes[t].normal);
        starts[directions[t] + 1]++;
    }
    for (int way = 0; way < DIRECTION_COUNT; way++)
        starts[way + 1] = (uint16_t)(starts[way + 1] + starts[way]);
    for (int t = 0; t < part->triangle_count; t++) {
        size_t to = starts[directions[t]]++;
        for (size_t i = 0; i < 3; i++) {
            parts->corners[part->first_corner + i * part->rounded + to] = maker->corners[i][t];
            out[i * part->rounded + to] = planes[t].normal[i];
        }
        out[3 * (size_t)part->rounded + to] = planes[t].along;
    }
}

static void write_places(const struct parts_maker *maker, const struct soft_part *part)
{
    size_t rounded = whole_lanes(part->vertex_count);
    float *out = maker->parts->places_m + 3 * (size_t)part->first_vertex;
    for (size_t i = 0; i < 3 * rounded; i++)
        out[i] = maker->file->positions_m[maker->parts->vertices[part->first_vertex + i % rounded]][i / rounded];
}

/* --- parts ------------------------------------------------------------------------------------------------------------------ */

static void end_part(struct parts_maker *maker, struct soft_part *part)
{
    struct soft_parts *parts = maker->parts;
    part->rounded = (uint16_t)whole_lanes(part->triangle_count);
    part->first_corner = (uint32_t)parts->corner_count;
    size_t corners = parts->corner_count + 3u * part->rounded, vertices = part->first_vertex + whole_lanes(part->vertex_count);
    mem_grow(&parts->corners, &parts->corner_capacity, corners, 1);
    mem_grow(&parts->planes, &parts->plane_capacity, corners / 3 * 4, sizeof(*parts->planes));
    mem_grow(&parts->vertices, &parts->vertex_capacity, vertices, sizeof(*parts->vertices));
    mem_grow(&parts->places_m, &parts->place_capacity, 3 * vertices, sizeof(*parts->places_m));
    memset(parts->corners + parts->corner_count, 0, 3u * part->rounded);
    memset(parts->planes + parts->corner_count / 3 * 4, 0, 4u * part->rounded * sizeof(*parts->planes));
    parts->corner_count = corners;
    while (parts->vertex_count < vertices) {
        parts->vertices[parts->vertex_count] = parts->vertices[parts->vertex_count - 1];
        parts->vertex_count++;
    }
    write_triangles(maker, part);
    write_places(maker, part);
    parts->blended |= part->blended;
    mem_grow(&parts->parts, &parts->part_capacity, parts->part_count + 1, sizeof(*parts->parts));
    parts->parts[parts->part_count++] = *part;
}

/* Splits a cluster into parts (groups of triangles); most clusters are one part. */
static void add_cluster(struct parts_maker *maker, const struct asset_cluster *cluster, const struct asset_primitive *primitive)
{
    for (uint32_t done = 0; done < cluster->index_count;) {
        struct soft_part part = {
            .cluster = *cluster,
            .first_vertex = (uint32_t)maker->parts->vertex_count,
            .material = (uint16_t)primitive->material,
            .double_sided = maker->file->materials[primitive->material].double_sided != 0,
            .blended = maker->file->materials[primitive->material].alpha == ASSET_ALPHA_BLEND,
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

bool soft_parts_init(struct soft_parts *parts, const struct asset_view *file, const struct model_level *level)
{
    *parts = (struct soft_parts){ 0 };
    struct parts_maker maker = {
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

void soft_parts_finish(struct soft_parts *parts)
{
    mem_free(parts->parts);
    mem_free(parts->vertices);
    mem_free(parts->corners);
    mem_free(parts->places_m);
    mem_free(parts->planes);
    mem_free(parts->closed);
    *parts = (struct soft_parts){ 0 };
}
