/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Triangles with holes from a texture's alpha mask, and blended (transparent) triangles: both let surfaces behind show through. */
#include "base/mem.h"
#include "render/soft/tile.h"

void soft_cutout_init(struct soft_cutout *cutout, const struct soft_tile *tile, const struct soft_face *face)
{
    cutout->material = tile->material;
    cutout->file = tile->mesh->file;
    soft_part_triangle(tile->parts, tile->part, face->triangle & FACE_TRIANGLE, cutout->vertices);
    soft_weights(tile->mesh, cutout->vertices, cutout->weights);
}

bool soft_is_hole(const struct soft_cutout *cutout, float x, float y)
{
    struct soft_spread spread;
    soft_spread_at(cutout->weights, (double)x, (double)y, &spread);
    return soft_alpha(cutout->material, cutout->file, cutout->vertices, &spread) < cutout->material->of->alpha_cutoff;
}

void soft_add_fragment(const struct soft_tile *tile, int sample, const struct soft_face *face, int column, int row, float depth)
{
    struct soft_fragments *fragments = tile->fragments;
    if (column >= tile->raster->width_px)
        return;
    size_t pixel = (size_t)(row - tile->rect.top) * (size_t)tile->pitch_px + (size_t)column;
    mem_grow(&fragments->at, &fragments->capacity, fragments->count + 1, sizeof(*fragments->at));
    fragments->at[fragments->count++] =
        (struct soft_fragment){ .pixel = (uint32_t)pixel, .id = soft_id(tile, face), .depth = depth, .sample = (uint8_t)sample };
}
