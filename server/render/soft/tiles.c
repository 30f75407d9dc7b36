/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws a frame tile by tile. In each tile it draws the parts (groups of triangles) that may be visible, nearest first, and skips parts
   behind surfaces that are already drawn. */
#include "render/soft/kernels.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

struct tile_entry { /* entry for one part (group of triangles) in a tile's list of possibly visible parts */
    uint64_t order; /* sort key of the part: its depth, nearest first; parts at equal depth keep the order in which they were found */
    uint32_t mesh, item;
};

struct tile_list {
    struct tile_entry *entries;
    size_t count, capacity;
};

static bool overlap(const struct soft_rect *a, const struct soft_rect *b)
{
    return a->left <= b->right && b->left <= a->right && a->top <= b->bottom && b->top <= a->bottom;
}

static uint32_t bits_of(float x)
{
    uint32_t bits;
    memcpy(&bits, &x, sizeof(bits));
    return bits;
}

static int by_order(const void *a, const void *b)
{
    uint64_t x = ((const struct tile_entry *)a)->order, y = ((const struct tile_entry *)b)->order;
    return (x > y) - (x < y);
}

static void fill_list(const struct soft_tile *tile, struct tile_list *list)
{
    const struct raster *raster = tile->raster;
    for (size_t m = 0; m < raster->mesh_count; m++) {
        const struct soft_found *found = &raster->found[m];
        if (!overlap(&found->rect, &tile->rect))
            continue;
        mem_grow(&list->entries, &list->capacity, list->count + found->count, sizeof(*list->entries));
        for (size_t i = 0; i < found->count; i++)
            if (overlap(&found->items[i].rect, &tile->rect)) {
                uint64_t order = (uint64_t)(UINT32_MAX - bits_of(found->items[i].near)) << 32 | list->count;
                list->entries[list->count++] = (struct tile_entry){ order, (uint32_t)m, (uint32_t)i };
            }
    }
    if (list->count > 1) /* the array of an empty list may be NULL, which must not be passed to qsort() */
        qsort(list->entries, list->count, sizeof(*list->entries), by_order);
}

/* Returns the columns and rows of the tile's depth blocks (8 x 8 pixels) that a rectangle touches. */
static struct soft_rect blocks_of(const struct soft_tile *tile, const struct soft_rect *rect)
{
    const struct soft_rect *all = &tile->rect;
    return (struct soft_rect){
        ((rect->left > all->left ? rect->left : all->left) - all->left) / BLOCK_PX,
        ((rect->top > all->top ? rect->top : all->top) - all->top) / BLOCK_PX,
        ((rect->right < all->right ? rect->right : all->right) - all->left) / BLOCK_PX,
        ((rect->bottom < all->bottom ? rect->bottom : all->bottom) - all->top) / BLOCK_PX,
    };
}

static bool is_hidden(const struct soft_tile *tile, const struct soft_rect *blocks, float near)
{
    for (int row = blocks->top; row <= blocks->bottom; row++)
        for (int column = blocks->left; column <= blocks->right; column++)
            if (near >= tile->farthest[row][column])
                return false;
    return true;
}

/* Returns the smallest rectangle of pixels that encloses all faces (triangles) of the tile (tile->faces). */
static struct soft_rect faces_rect(const struct soft_tile *tile)
{
    struct soft_rect rect = { INT16_MAX, INT16_MAX, 0, 0 };
    for (int i = 0; i < tile->face_count; i++) {
        const struct soft_face *face = &tile->faces[i];
        rect.left = face->left < rect.left ? face->left : rect.left;
        rect.top = face->top < rect.top ? face->top : rect.top;
        rect.right = face->right > rect.right ? face->right : rect.right;
        rect.bottom = face->bottom > rect.bottom ? face->bottom : rect.bottom;
    }
    return rect;
}

static void begin_part(struct soft_tile *tile, const struct soft_found *found, const struct soft_item *item, int cuts)
{
    tile->mesh = &tile->raster->meshes[found - tile->raster->found];
    tile->parts = found->parts;
    tile->part = &found->parts->parts[item->part];
    tile->material = &tile->raster->soft->materials.at[found->material + tile->part->material];
    tile->cuts = cuts;
}

/* Sets a and b (colour map column and row, or light) and the flags of all vertices to 0, for output without colours. */
static void carry_nothing(struct soft_tile *tile)
{
    size_t count = (size_t)tile->corners.count;
    tile->corners.all_flags = 0;
    if (!tile->corners.cut)
        return;
    memset(tile->corners.a, 0, count * sizeof(float));
    memset(tile->corners.b, 0, count * sizeof(float));
    memset(tile->corners.flags, 0, count * sizeof(uint32_t));
}

static void carry(struct soft_tile *tile, const struct soft_found *found)
{
    if (tile->samples[0].marks)
        tile->raster->soft->kernels->carry_part(tile, tile->mesh, found->parts, tile->part);
    else
        carry_nothing(tile);
}

static void draw_part(struct soft_tile *tile, const struct soft_found *found, const struct soft_item *item)
{
    const struct soft_mesh *mesh = tile->mesh;
    const struct soft_part *part = tile->part;
    const struct soft_kernels *kernels = tile->raster->soft->kernels;
    kernels->place_part(tile, mesh, found->parts, part);
    if (item->cut)
        soft_cut_corners(tile);
    if (tile->corners.cut) {
        carry(tile, found);
        soft_cut_faces(tile, found->both_sides);
    } else {
        kernels->find_faces(tile, mesh, found, part);
        if (tile->face_count > 0)
            carry(tile, found);
    }
    if (tile->face_count == 0)
        return;
    tile->first_id = found->first_id + (uint32_t)(item - found->items) * PART_TRIANGLES;
    uint32_t mark = MARK_FIELD;
    if (mesh->pixels >= 0)
        mark = MARK_PIXELS | (uint32_t)mesh->pixels >> 8 << 16;
    else if (!mesh->has_field)
        mark = MARK_CONTEXT | tile->raster->soft->ramp_of_material[found->material + part->material] << 16;
    kernels->raster_faces(tile, mark);
    struct soft_rect rect = faces_rect(tile), blocks = blocks_of(tile, &rect);
    kernels->look_again(tile, &blocks);
}

/* Returns whether the tile's current mode draws the part (group of triangles): all parts, opaque ones or blended ones. A part that shows
   the field is never blended, since that would mix its colours. */
static bool is_drawn(const struct soft_tile *tile)
{
    bool blended = tile->part->blended && !tile->mesh->has_field;
    return tile->draws == DRAW_ALL || blended == (tile->draws == DRAW_BLENDED);
}

static void draw_list(struct soft_tile *tile, const struct tile_list *list)
{
    const struct raster *raster = tile->raster;
    for (size_t i = 0; i < list->count; i++) {
        const struct soft_found *found = &raster->found[list->entries[i].mesh];
        const struct soft_item *item = &found->items[list->entries[i].item];
        struct soft_rect blocks = blocks_of(tile, &item->rect);
        if (item->beyond || is_hidden(tile, &blocks, item->near))
            continue;
        begin_part(tile, found, item, raster->cut_count);
        if (is_drawn(tile))
            draw_part(tile, found, item);
    }
}

static void look_at_all(struct soft_tile *tile)
{
    struct soft_rect blocks = blocks_of(tile, &tile->rect);
    tile->raster->soft->kernels->look_again(tile, &blocks);
}

/* Draws the tile's section caps (cut faces of closed bodies) before all other parts, because caps hide everything behind them. */
static void draw_caps(struct soft_tile *tile, const struct tile_list *list)
{
    const struct raster *raster = tile->raster;
    for (size_t i = 0; i < list->count; i++) {
        const struct soft_found *found = &raster->found[list->entries[i].mesh];
        const struct soft_item *item = &found->items[list->entries[i].item];
        begin_part(tile, found, item, raster->entry_count);
        soft_count_part(tile, found, item);
    }
    soft_cap_tile(tile);
    look_at_all(tile);
}

static void clear(const struct soft_tile *tile)
{
    size_t bytes = (size_t)(tile->rect.right + 1 - tile->rect.left) * sizeof(float);
    for (int row = tile->rect.top; row <= tile->rect.bottom; row++) {
        size_t start = (size_t)row * (size_t)tile->raster->pitch_px + (size_t)tile->rect.left;
        memset(tile->raster->depth + start, 0, bytes);
        memset(tile->raster->marks + start, 0, bytes);
    }
}

static int columns_of(const struct raster *raster)
{
    return (raster->pitch_px + TILE_WIDTH_PX - 1) / TILE_WIDTH_PX;
}

static void draw_tile(const struct raster *raster, int number, enum soft_output output, struct tile_list *list)
{
    /* sets only some members of `tile`: zeroing the whole struct would take long, because its arrays of corners and faces are
       large and mostly unused */
    struct soft_tile tile;
    int left = number % columns_of(raster) * TILE_WIDTH_PX, top = number / columns_of(raster) * TILE_HEIGHT_PX;
    tile.raster = raster;
    tile.rect = (struct soft_rect){ left, top, left + TILE_WIDTH_PX - 1, top + TILE_HEIGHT_PX - 1 };
    if (tile.rect.right >= raster->pitch_px)
        tile.rect.right = raster->pitch_px - 1;
    if (tile.rect.bottom >= raster->height_px)
        tile.rect.bottom = raster->height_px - 1;
    size_t first = (size_t)top * (size_t)raster->pitch_px + (size_t)left;
    tile.samples[0] = (struct soft_sample){ raster->depth + first, raster->marks + first, raster->ids ? raster->ids + first : NULL, 0, 0 };
    tile.sample_count = 1;
    tile.pitch_px = raster->pitch_px;
    tile.reach_px = 0;
    tile.draws = DRAW_ALL;
    memset(tile.farthest, 0, sizeof(tile.farthest));
    clear(&tile);
    fill_list(&tile, list);
    if (raster->counts_bodies)
        draw_caps(&tile, list);
    if (output != SOFT_CAPS)
        draw_list(&tile, list);
}

void raster_samples(const struct raster *raster, const struct soft_rect *rect, const struct soft_sample samples[MOST_SAMPLES], int pitch_px,
                    float reach_px, struct soft_fragments *fragments)
{
    struct soft_tile tile;
    struct tile_list list = { 0 };
    tile.raster = raster;
    tile.rect = *rect;
    memcpy(tile.samples, samples, sizeof(tile.samples));
    tile.sample_count = MOST_SAMPLES;
    tile.pitch_px = pitch_px;
    tile.reach_px = reach_px;
    tile.draws = raster->blends ? DRAW_OPAQUE : DRAW_ALL;
    tile.fragments = fragments;
    look_at_all(&tile);
    fill_list(&tile, &list);
    draw_list(&tile, &list);
    if (raster->blends) {
        tile.draws = DRAW_BLENDED;
        draw_list(&tile, &list);
    }
    mem_free(list.entries);
}

struct tile_drawing {
    const struct raster *raster;
    enum soft_output output;
};

static void draw_tiles(void *arg, size_t begin, size_t end)
{
    const struct tile_drawing *drawing = arg;
    const struct raster *raster = drawing->raster;
    struct tile_list list = { 0 };
    for (size_t t = begin; t < end; t++) {
        list.count = 0;
        draw_tile(raster, (int)t, drawing->output, &list);
        if (drawing->output == SOFT_COLORS) {
            int left = (int)t % columns_of(raster) * TILE_WIDTH_PX, top = (int)t / columns_of(raster) * TILE_HEIGHT_PX;
            int right = left + TILE_WIDTH_PX < raster->width_px ? left + TILE_WIDTH_PX : raster->width_px;
            int bottom = top + TILE_HEIGHT_PX < raster->height_px ? top + TILE_HEIGHT_PX : raster->height_px;
            raster->soft->kernels->color(raster, &(struct soft_rect){ left, top, right - 1, bottom - 1 });
            raster_find_cells(raster, &(struct soft_rect){ left, top, right - 1, bottom - 1 });
        }
    }
    mem_free(list.entries);
}

void raster_tiles(struct raster *raster, enum soft_output output)
{
    struct tile_drawing drawing = { raster, output };
    int rows = (raster->height_px + TILE_HEIGHT_PX - 1) / TILE_HEIGHT_PX;
    workers_for(raster->soft->workers, (size_t)(columns_of(raster) * rows), 1, draw_tiles, &drawing);
}

size_t raster_bytes(const struct raster *raster)
{
    size_t bytes = raster->pixel_capacity * (sizeof(*raster->depth) + sizeof(*raster->marks)) +
                   raster->cell_capacity * sizeof(*raster->cells) +
                   raster->mesh_capacity * sizeof(*raster->meshes) + raster->pixels_capacity * sizeof(*raster->pixels) +
                   raster->found_capacity * sizeof(*raster->found);
    for (size_t i = 0; i < raster->found_capacity; i++)
        bytes += raster->found[i].capacity * sizeof(*raster->found[i].items);
    return bytes;
}

void raster_finish(struct raster *raster)
{
    struct soft *soft = raster->soft;
    for (size_t i = 0; i < raster->found_capacity; i++)
        mem_free(raster->found[i].items);
    mem_free(raster->found);
    mem_free(raster->meshes);
    for (size_t i = 0; i < raster->pixels_capacity; i++)
        pixel_field_finish(&raster->pixels[i].field);
    mem_free(raster->pixels);
    mem_free(raster->depth);
    mem_free(raster->marks);
    mem_free(raster->cells);
    *raster = (struct raster){ .soft = soft };
}
