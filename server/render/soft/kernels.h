/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Table of kernels: the loops that take most of a frame's time. The Makefile compiles their source files for any machine (suffix _plain)
   and, on x86, also for AVX2 (_wide) and AVX-512 (_widest). All three give identical bits. Private to soft/. */
#ifndef RENDER_SOFT_KERNELS_H
#define RENDER_SOFT_KERNELS_H
#include "render/soft/tile.h"

struct depth_cell;
struct depth_source;
struct refined_item;
struct refined;
struct shaded_items;
struct visibility_band;

struct soft_kernels {
    /* place_part projects the vertices of a part (soft/parts.h). carry_part then computes field value and light of the vertices
       used by the faces that find_faces listed. If some faces are clipped, it does so for all vertices of the part. */
    void (*place_part)(struct soft_tile *tile, const struct soft_mesh *mesh, const struct soft_parts *parts, const struct soft_part *part);
    void (*carry_part)(struct soft_tile *tile, const struct soft_mesh *mesh, const struct soft_parts *parts, const struct soft_part *part);
    /* Lists the faces (front-facing triangles) of a part (group of triangles) that need no clipping and whose corners are all projected. */
    void (*find_faces)(struct soft_tile *tile, const struct soft_mesh *mesh, const struct soft_found *found, const struct soft_part *part);
    /* Draws all faces that find_faces listed: writes the depth and the mark (32-bit content, soft_impl.h) of each pixel. */
    void (*raster_faces)(const struct soft_tile *tile, uint32_t mark);
    /* Counts the closed bodies along the view ray of each pixel, for section caps, and stores the count in place of the pixel's
       colour code (mark). A listed face that faces away from the eye adds 1, a face towards the eye subtracts 1. */
    void (*count_faces)(const struct soft_tile *tile);
    /* Recomputes tile->farthest, the farthest depth in each block of 8 x 8 pixels, for the given blocks of the tile. */
    void (*look_again)(struct soft_tile *tile, const struct soft_rect *blocks);
    /* Turns the marks (contents of pixels, soft_impl.h) in a rectangle into colours. The rectangle begins at a multiple of
       SOFT_STRETCH_MOST pixels. */
    void (*color)(const struct raster *raster, const struct soft_rect *rect);
    /* Finds the depth grid cells (squares of pixels) in rows `first_row` to `end_row` - 1 and columns `first_column` to
       `end_column` - 1. cells: all cells of the frame, row by row. */
    void (*find_cells)(const struct depth_source *source, int first_row, int end_row, int first_column, int end_column,
                       struct depth_cell *cells);
    /* --- of refined frames */
    /* Shades surfaces that show the field. For each item (surface to shade), writes to `out` its triangle, its corner weights in the
       triangle, and its row of the colour map (brightness). */
    void (*shade_field)(const struct refined *refined, struct visibility_band *band, const struct refined_item *items, size_t count,
                        const struct shaded_items *out);
    /* Shades surfaces that show the field in the glossy look: writes the same as shade_field, and also the reflected light to
       out->gloss. */
    void (*shade_gloss)(const struct refined *refined, struct visibility_band *band, const struct refined_item *items, size_t count,
                        const struct shaded_items *out);
    /* Shades the surfaces that show no field and writes their colours. alphas: receives their opacity, 0..1; NULL: not needed. */
    void (*shade_surfaces)(const struct refined *refined, const struct refined_item *items, size_t count, uint32_t *colors, float *alphas);
    void (*shade_sky)(const struct refined *refined, int row, const uint8_t *wanted, uint32_t *colors);
    /* Draws the feature edges of a band (group of pixel rows) into the visibility buffer's `ink`, that is, each pixel's coverage by
       dark lines. */
    void (*ink_band)(const struct refined *refined, int band);
    /* Colours bands (groups of pixel rows) of a visibility buffer: a task of workers_for(). arg: struct resolve_job */
    void (*color_bands)(void *arg, size_t begin, size_t end);
};
/* one table for each instruction set: _plain for any machine; _wide (AVX2) and _widest (AVX-512) exist on x86 only */
extern const struct soft_kernels soft_kernels_plain, soft_kernels_wide, soft_kernels_widest;

#define soft_kernels_of_set SOFT_IN_SET(soft_kernels, SOFT_SET)
#define soft_place_part SOFT_IN_SET(soft_place_part, SOFT_SET)
#define soft_carry_part SOFT_IN_SET(soft_carry_part, SOFT_SET)
#define soft_find_faces SOFT_IN_SET(soft_find_faces, SOFT_SET)
#define soft_raster_faces SOFT_IN_SET(soft_raster_faces, SOFT_SET)
#define soft_count_faces SOFT_IN_SET(soft_count_faces, SOFT_SET)
#define soft_look_again SOFT_IN_SET(soft_look_again, SOFT_SET)
#define raster_color SOFT_IN_SET(raster_color, SOFT_SET)
#define soft_find_cells SOFT_IN_SET(soft_find_cells, SOFT_SET)
#define refined_shade_field SOFT_IN_SET(refined_shade_field, SOFT_SET)
#define refined_shade_gloss SOFT_IN_SET(refined_shade_gloss, SOFT_SET)
#define refined_shade_surfaces SOFT_IN_SET(refined_shade_surfaces, SOFT_SET)
#define refined_shade_sky SOFT_IN_SET(refined_shade_sky, SOFT_SET)
#define refined_ink_band SOFT_IN_SET(refined_ink_band, SOFT_SET)
#define resolve_color_bands SOFT_IN_SET(resolve_color_bands, SOFT_SET)
void soft_place_part(struct soft_tile *tile, const struct soft_mesh *mesh, const struct soft_parts *parts, const struct soft_part *part);
void soft_carry_part(struct soft_tile *tile, const struct soft_mesh *mesh, const struct soft_parts *parts, const struct soft_part *part);
void soft_find_faces(struct soft_tile *tile, const struct soft_mesh *mesh, const struct soft_found *found, const struct soft_part *part);
void soft_raster_faces(const struct soft_tile *tile, uint32_t mark);
void soft_count_faces(const struct soft_tile *tile);
void soft_look_again(struct soft_tile *tile, const struct soft_rect *blocks);
void raster_color(const struct raster *raster, const struct soft_rect *rect);
void soft_find_cells(const struct depth_source *source, int first_row, int end_row, int first_column, int end_column,
                     struct depth_cell *cells);
void refined_shade_field(const struct refined *refined, struct visibility_band *band, const struct refined_item *items, size_t count,
                         const struct shaded_items *out);
void refined_shade_gloss(const struct refined *refined, struct visibility_band *band, const struct refined_item *items, size_t count,
                         const struct shaded_items *out);
void refined_shade_surfaces(const struct refined *refined, const struct refined_item *items, size_t count, uint32_t *colors, float *alphas);
void refined_shade_sky(const struct refined *refined, int row, const uint8_t *wanted, uint32_t *colors);
void refined_ink_band(const struct refined *refined, int band);
void resolve_color_bands(void *arg, size_t begin, size_t end);

#endif
