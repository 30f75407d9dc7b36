/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The loops that take most of a draft's time. Their files are compiled once for any machine and, for x86, once more for those with AVX2
   (Makefile): names end in _wide there. The same bits come out. Private to draft*.c. */
#ifndef RENDER_DRAFT_KERNELS_H
#define RENDER_DRAFT_KERNELS_H
#include "render/draft/draft_tile.h"

struct draft_kernels {
    /* The vertices of a part: first where all of them are, then what those of its faces carry of field and light; all, if some are cut. */
    void (*place_part)(struct draft_tile *tile, const struct draft_mesh *mesh, const struct draft_parts *parts,
                       const struct draft_part *part);
    void (*carry_part)(struct draft_tile *tile, const struct draft_mesh *mesh, const struct draft_parts *parts,
                       const struct draft_part *part);
    /* Its faces, out of corners that were placed and are not cut. */
    void (*find_faces)(struct draft_tile *tile, const struct draft_mesh *mesh, const struct draft_found *found,
                       const struct draft_part *part);
    /* Depth and marks of all faces. */
    void (*raster_faces)(const struct draft_tile *tile, uint32_t mark);
    /* How far these blocks reach now. */
    void (*look_again)(struct draft_tile *tile, const struct draft_rect *blocks);
    /* From marks; begins at a whole STRETCH. */
    void (*color)(const struct draft *draft, const struct draft_rect *rect);
};
extern const struct draft_kernels draft_kernels_plain, draft_kernels_wide; /* wide: on x86 only */

#ifdef DRAFT_WIDE
#define draft_place_part draft_place_part_wide
#define draft_carry_part draft_carry_part_wide
#define draft_find_faces draft_find_faces_wide
#define draft_raster_faces draft_raster_faces_wide
#define draft_look_again draft_look_again_wide
#define draft_color draft_color_wide
#endif
void draft_place_part(struct draft_tile *tile, const struct draft_mesh *mesh, const struct draft_parts *parts,
                      const struct draft_part *part);
void draft_carry_part(struct draft_tile *tile, const struct draft_mesh *mesh, const struct draft_parts *parts,
                      const struct draft_part *part);
void draft_find_faces(struct draft_tile *tile, const struct draft_mesh *mesh, const struct draft_found *found,
                      const struct draft_part *part);
void draft_raster_faces(const struct draft_tile *tile, uint32_t mark);
void draft_look_again(struct draft_tile *tile, const struct draft_rect *blocks);
void draft_color(const struct draft *draft, const struct draft_rect *rect);

#endif
