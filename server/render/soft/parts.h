/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A level of detail cut into parts of up to 256 neighbouring triangles with locally numbered vertices. A part is small enough
   to be projected, tested and drawn within the L1 cache. Triangles of similar direction are adjacent in a part, so that back
   faces are skipped eight at a time. Private to soft/. */
#ifndef RENDER_SOFT_PARTS_H
#define RENDER_SOFT_PARTS_H
#include "render/gl/model.h"

enum { PART_TRIANGLES = 256, PART_VERTICES = 256 };

struct soft_part {
    struct asset_cluster cluster; /* bounding box and normal cone */
    uint32_t first_vertex;        /* index of the part's first vertex in the array soft_parts.vertices */
    /* index of the part's first value in soft_parts.corners. A part has three consecutive lists there, each with one corner of all its
       triangles: first corners, second corners, third corners */
    uint32_t first_corner;
    uint16_t vertex_count, triangle_count;
    uint16_t rounded; /* triangle_count rounded up to a multiple of LANES; the padding triangles have no area */
    uint16_t material;
    bool double_sided;
    bool blended; /* true: the material is transparent, so the part (group of triangles) is blended unless it shows a field */
};

struct soft_parts {
    struct soft_part *parts;
    /* indices of vertices in the asset file, part by part; each part's list is padded to a multiple of LANES with its last vertex */
    uint32_t *vertices;
    float *places_m;  /* positions of `vertices` in metres, part by part; for each part first all x, then all y, then all z */
    uint8_t *corners; /* corners of triangles: indices of vertices within the part; see soft_part.first_corner for the order */
    float *planes; /* planes of the triangles (n . p + d = 0), part by part; for each part first all n.x, then all n.y, all n.z and all d */
    uint8_t *closed; /* by index in `vertices`: 1: the vertex belongs to a closed body; 0: it belongs to none. NULL: not computed yet */
    bool blended;    /* true: at least one part (group of triangles) is transparent, so it is blended */
    size_t part_count, vertex_count, corner_count;
    size_t part_capacity, vertex_capacity, place_capacity, corner_capacity, plane_capacity;
};

static inline const float *soft_part_places(const struct soft_parts *parts, const struct soft_part *part)
{
    return parts->places_m + 3 * (size_t)part->first_vertex;
}

static inline const float *soft_part_planes(const struct soft_parts *parts, const struct soft_part *part)
{
    return parts->planes + 4 * (size_t)(part->first_corner / 3);
}

/* Writes the indices, in the asset file, of the vertices of one triangle of the part. */
static inline void soft_part_triangle(const struct soft_parts *parts, const struct soft_part *part, uint32_t triangle, uint32_t vertices[3])
{
    const uint8_t *corners = parts->corners + part->first_corner + triangle;
    for (int i = 0; i < 3; i++)
        vertices[i] = parts->vertices[part->first_vertex + corners[i * part->rounded]];
}

/* Makes the parts (groups of triangles) of a level of detail. Returns false when out of memory. Call soft_parts_finish() in either case. */
bool soft_parts_init(struct soft_parts *parts, const struct asset_view *file, const struct model_level *level);
/* Computes parts->closed (which vertices belong to closed bodies) unless that is done already. vertex_count: number of vertices of the
   level of detail. Returns false when out of memory. */
bool soft_parts_close(struct soft_parts *parts, const struct asset_view *file, const struct closed_bodies *closed, uint32_t vertex_count);
void soft_parts_finish(struct soft_parts *parts);

#endif
