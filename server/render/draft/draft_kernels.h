/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The loops that take most of a draft's time. Their files are compiled once for any machine and, for x86, once more for those with AVX2
   and once for those with AVX-512 (Makefile): names end in _plain, _wide and _widest. The same bits come out. Private to draft*.c. */
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
    /* Of all faces: into the marks, one more where a face looks away, one less where it faces the eye. */
    void (*count_faces)(const struct draft_tile *tile);
    /* How far these blocks reach now. */
    void (*look_again)(struct draft_tile *tile, const struct draft_rect *blocks);
    /* From marks; begins at a whole DRAFT_STRETCH_MOST. */
    void (*color)(const struct draft *draft, const struct draft_rect *rect);
};
extern const struct draft_kernels draft_kernels_plain, draft_kernels_wide, draft_kernels_widest; /* but for plain: on x86 only */

#ifndef DRAFT_SET /* which of them is compiled */
#define DRAFT_SET _plain
#endif
#define DRAFT_JOIN(name, set) name##set
#define DRAFT_IN_SET(name, set) DRAFT_JOIN(name, set)
#define draft_kernels_of_set DRAFT_IN_SET(draft_kernels, DRAFT_SET)
#define draft_place_part DRAFT_IN_SET(draft_place_part, DRAFT_SET)
#define draft_carry_part DRAFT_IN_SET(draft_carry_part, DRAFT_SET)
#define draft_find_faces DRAFT_IN_SET(draft_find_faces, DRAFT_SET)
#define draft_raster_faces DRAFT_IN_SET(draft_raster_faces, DRAFT_SET)
#define draft_count_faces DRAFT_IN_SET(draft_count_faces, DRAFT_SET)
#define draft_look_again DRAFT_IN_SET(draft_look_again, DRAFT_SET)
#define draft_color DRAFT_IN_SET(draft_color, DRAFT_SET)
void draft_place_part(struct draft_tile *tile, const struct draft_mesh *mesh, const struct draft_parts *parts,
                      const struct draft_part *part);
void draft_carry_part(struct draft_tile *tile, const struct draft_mesh *mesh, const struct draft_parts *parts,
                      const struct draft_part *part);
void draft_find_faces(struct draft_tile *tile, const struct draft_mesh *mesh, const struct draft_found *found,
                      const struct draft_part *part);
void draft_raster_faces(const struct draft_tile *tile, uint32_t mark);
void draft_count_faces(const struct draft_tile *tile);
void draft_look_again(struct draft_tile *tile, const struct draft_rect *blocks);
void draft_color(const struct draft *draft, const struct draft_rect *rect);

#endif
