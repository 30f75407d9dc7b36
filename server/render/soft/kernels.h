/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The loops that take most of a frame's time. Their files are compiled once for any machine and, for x86, once more for those with AVX2
   and once for those with AVX-512 (Makefile): names end in _plain, _wide and _widest. The same bits come out. Private to soft/. */
#ifndef RENDER_SOFT_KERNELS_H
#define RENDER_SOFT_KERNELS_H
#include "render/soft/tile.h"

struct refined_item;
struct refined;
struct shaded_items;
struct visibility_band;

struct soft_kernels {
    /* The vertices of a part: first where all of them are, then what those of its faces carry of field and light; all, if some are cut. */
    void (*place_part)(struct soft_tile *tile, const struct soft_mesh *mesh, const struct soft_parts *parts, const struct soft_part *part);
    void (*carry_part)(struct soft_tile *tile, const struct soft_mesh *mesh, const struct soft_parts *parts, const struct soft_part *part);
    /* Its faces, out of corners that were placed and are not cut. */
    void (*find_faces)(struct soft_tile *tile, const struct soft_mesh *mesh, const struct soft_found *found, const struct soft_part *part);
    /* Depth and marks of all faces. */
    void (*raster_faces)(const struct soft_tile *tile, uint32_t mark);
    /* Of all faces: into the marks, one more where a face looks away, one less where it faces the eye. */
    void (*count_faces)(const struct soft_tile *tile);
    /* How far these blocks reach now. */
    void (*look_again)(struct soft_tile *tile, const struct soft_rect *blocks);
    /* From marks; begins at a whole SOFT_STRETCH_MOST. */
    void (*color)(const struct raster *raster, const struct soft_rect *rect);
    /* --- of refined frames */
    /* Light on surfaces that show the field; where on them they are is kept. */
    void (*shade_field)(const struct refined *refined, struct visibility_band *band, const struct refined_item *items, size_t count,
                        const struct shaded_items *out);
    /* Likewise in a glossy look: fills out->gloss, too. */
    void (*shade_gloss)(const struct refined *refined, struct visibility_band *band, const struct refined_item *items, size_t count,
                        const struct shaded_items *out);
    /* Light on other surfaces. alphas: NULL: not asked for. */
    void (*shade_surfaces)(const struct refined *refined, const struct refined_item *items, size_t count, uint32_t *colors, float *alphas);
    void (*shade_sky)(const struct refined *refined, int row, const uint8_t *wanted, uint32_t *colors);
    /* Feature edges. */
    void (*ink_band)(const struct refined *refined, int band);
};
extern const struct soft_kernels soft_kernels_plain, soft_kernels_wide, soft_kernels_widest; /* but for plain: on x86 only */

#ifndef SOFT_SET /* which of them is compiled */
#define SOFT_SET _plain
#endif
#define SOFT_JOIN(name, set) name##set
#define SOFT_IN_SET(name, set) SOFT_JOIN(name, set)
#define soft_kernels_of_set SOFT_IN_SET(soft_kernels, SOFT_SET)
#define soft_place_part SOFT_IN_SET(soft_place_part, SOFT_SET)
#define soft_carry_part SOFT_IN_SET(soft_carry_part, SOFT_SET)
#define soft_find_faces SOFT_IN_SET(soft_find_faces, SOFT_SET)
#define soft_raster_faces SOFT_IN_SET(soft_raster_faces, SOFT_SET)
#define soft_count_faces SOFT_IN_SET(soft_count_faces, SOFT_SET)
#define soft_look_again SOFT_IN_SET(soft_look_again, SOFT_SET)
#define raster_color SOFT_IN_SET(raster_color, SOFT_SET)
#define refined_shade_field SOFT_IN_SET(refined_shade_field, SOFT_SET)
#define refined_shade_gloss SOFT_IN_SET(refined_shade_gloss, SOFT_SET)
#define refined_shade_surfaces SOFT_IN_SET(refined_shade_surfaces, SOFT_SET)
#define refined_shade_sky SOFT_IN_SET(refined_shade_sky, SOFT_SET)
#define refined_ink_band SOFT_IN_SET(refined_ink_band, SOFT_SET)
void soft_place_part(struct soft_tile *tile, const struct soft_mesh *mesh, const struct soft_parts *parts, const struct soft_part *part);
void soft_carry_part(struct soft_tile *tile, const struct soft_mesh *mesh, const struct soft_parts *parts, const struct soft_part *part);
void soft_find_faces(struct soft_tile *tile, const struct soft_mesh *mesh, const struct soft_found *found, const struct soft_part *part);
void soft_raster_faces(const struct soft_tile *tile, uint32_t mark);
void soft_count_faces(const struct soft_tile *tile);
void soft_look_again(struct soft_tile *tile, const struct soft_rect *blocks);
void raster_color(const struct raster *raster, const struct soft_rect *rect);
void refined_shade_field(const struct refined *refined, struct visibility_band *band, const struct refined_item *items, size_t count,
                         const struct shaded_items *out);
void refined_shade_gloss(const struct refined *refined, struct visibility_band *band, const struct refined_item *items, size_t count,
                         const struct shaded_items *out);
void refined_shade_surfaces(const struct refined *refined, const struct refined_item *items, size_t count, uint32_t *colors, float *alphas);
void refined_shade_sky(const struct refined *refined, int row, const uint8_t *wanted, uint32_t *colors);
void refined_ink_band(const struct refined *refined, int band);

#endif
