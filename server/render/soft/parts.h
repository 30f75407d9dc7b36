/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A level of detail cut into parts: at most 256 neighbouring triangles with vertices of their own numbers, so that a part is placed,
   tested and drawn without leaving the nearest cache. In a part those that look the same way are next to each other, so that what looks
   away goes eight at a time. Private to soft/. */
#ifndef RENDER_SOFT_PARTS_H
#define RENDER_SOFT_PARTS_H
#include "render/gl/model.h"

enum { PART_TRIANGLES = 256, PART_VERTICES = 256 };

struct soft_part {
    struct asset_cluster cluster; /* its box and cone */
    uint32_t first_vertex;        /* in soft_parts.vertices */
    uint32_t first_corner;        /* in soft_parts.corners: its first corners, then its second, then its third ones */
    uint16_t vertex_count, triangle_count;
    uint16_t rounded; /* triangles, up to whole lanes; what is beyond has no area */
    uint16_t material;
    bool double_sided;
    bool blended; /* its material is, where no field is shown */
};

struct soft_parts {
    struct soft_part *parts;
    uint32_t *vertices; /* of the file; each part's up to whole lanes, beyond by the last one again */
    float *places_m;    /* of the same: three times as many; each part's x, then its y, then its z */
    uint8_t *corners;   /* vertices of the part */
    float *planes;      /* four for three corners: each part's normals (x, then y, then z), then how far along them its triangles lie */
    uint8_t *closed;    /* as vertices: 1 where they are of a closed body. NULL: not asked for yet */
    bool blended;       /* some part is */
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

/* Vertices of the file, of one of its triangles. */
static inline void soft_part_triangle(const struct soft_parts *parts, const struct soft_part *part, uint32_t triangle, uint32_t vertices[3])
{
    const uint8_t *corners = parts->corners + part->first_corner + triangle;
    for (int i = 0; i < 3; i++)
        vertices[i] = parts->vertices[part->first_vertex + corners[i * part->rounded]];
}

/* False: out of memory. Finish in both cases. */
bool soft_parts_init(struct soft_parts *parts, const struct asset_view *file, const struct model_level *level);
/* Finds out which vertices are of closed bodies, if that is not known. vertex_count: of the level. False: out of memory. */
bool soft_parts_close(struct soft_parts *parts, const struct asset_view *file, const struct closed_bodies *closed, uint32_t vertex_count);
void soft_parts_finish(struct soft_parts *parts);

#endif
