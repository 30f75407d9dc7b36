/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Section caps: where a section plane cuts a closed body, the plane is drawn as if the body were solid. Along the view ray of each pixel,
   behind the cut, each exit from a body counts +1 and each entry -1. A positive sum means that the ray began inside a body, so the pixel
   shows the cap. */
#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "render/soft/kernels.h"

/* Returns whether a triangle of the part (group of neighbouring triangles, soft/parts.h) belongs to a closed body. */
static bool bounds_bodies(const struct soft_parts *parts, const struct soft_part *part)
{
    return parts->closed && memchr(parts->closed + part->first_vertex, 1, part->vertex_count);
}

static void keep_closed_faces(struct soft_tile *tile)
{
    const uint8_t *corners = tile->parts->corners + tile->part->first_corner, *closed = tile->parts->closed + tile->part->first_vertex;
    int kept = 0;
    for (int i = 0; i < tile->face_count; i++) {
        tile->faces[kept] = tile->faces[i];
        kept += closed[corners[tile->faces[i].triangle & FACE_TRIANGLE]];
    }
    tile->face_count = kept;
}

void soft_count_part(struct soft_tile *tile, const struct soft_found *found, const struct soft_item *item)
{
    const struct soft_kernels *kernels = tile->raster->soft->kernels;
    const struct soft_part *part = tile->part;
    if (!tile->mesh->cut || !bounds_bodies(found->parts, part))
        return;
    kernels->place_part(tile, tile->mesh, found->parts, part);
    if (item->cut)
        soft_cut_corners(tile);
    if (tile->corners.cut) {
        kernels->carry_part(tile, tile->mesh, found->parts, part);
        soft_cut_faces(tile, true);
    } else {
        kernels->find_faces(tile, tile->mesh, found, part);
    }
    keep_closed_faces(tile);
    kernels->count_faces(tile);
}

float raster_entry_depth(const struct raster *raster, float x, float y)
{
    float top = 1, bottom = 0;
    for (int i = 0; i < raster->cut_count; i++) {
        const float *plane = raster->cuts[i];
        float here = plane[0] * x + plane[1] * y + plane[3];
        if (plane[2] > 0)
            bottom = fmaxf(bottom, -here / plane[2]);
        else if (plane[2] < 0)
            top = fminf(top, -here / plane[2]);
        else if (here < 0)
            return 0;
    }
    return top > bottom && top < 1 ? top : 0;
}

void soft_cap_tile(struct soft_tile *tile)
{
    const struct raster *raster = tile->raster;
    for (int row = tile->rect.top; row <= tile->rect.bottom; row++) {
        size_t start = (size_t)row * (size_t)raster->pitch_px;
        for (int column = tile->rect.left; column <= tile->rect.right; column++) {
            uint32_t *mark = &raster->marks[start + (size_t)column];
            float depth = (int32_t)*mark > 0 ? raster_entry_depth(raster, (float)column + 0.5f, (float)row + 0.5f) : 0;
            *mark = depth > 0 ? MARK_CAP : 0;
            raster->depth[start + (size_t)column] = depth;
        }
    }
}

/* --- triangles of closed bodies --------------------------------------------------------------------------------------------------- */

bool soft_parts_close(struct soft_parts *parts, const struct asset_view *file, const struct closed_bodies *closed, uint32_t vertex_count)
{
    uint8_t *of_file = mem_try_array(vertex_count, 1);
    if (!of_file || parts->closed) {
        mem_free(of_file);
        return parts->closed != NULL;
    }
    for (size_t r = 0; r < closed->run_count; r++)
        for (uint32_t i = 0; i < closed->runs[r].index_count; i++)
            /* one flag per vertex suffices to mark closed bodies: no vertex belongs to both a closed and an open body */
            of_file[file->indices[closed->runs[r].first_index + i]] = 1;
    parts->closed = mem_try_array(parts->vertex_count, 1);
    for (size_t i = 0; i < parts->vertex_count && parts->closed; i++)
        parts->closed[i] = of_file[parts->vertices[i]];
    mem_free(of_file);
    return parts->closed != NULL;
}
