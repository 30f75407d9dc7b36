/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tile by tile: the parts that may be seen in it, nearest first; what lies behind what was drawn is left out. */
#include "render/draft/draft_kernels.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

struct entry {      /* of a tile's list */
    uint64_t order; /* nearest first; then as found */
    uint32_t mesh, item;
};

struct list {
    struct entry *entries;
    size_t count, capacity;
};

static bool overlap(const struct draft_rect *a, const struct draft_rect *b)
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
    uint64_t x = ((const struct entry *)a)->order, y = ((const struct entry *)b)->order;
    return (x > y) - (x < y);
}

static void fill_list(const struct draft_tile *tile, struct list *list)
{
    const struct draft *draft = tile->draft;
    for (size_t m = 0; m < draft->mesh_count; m++) {
        const struct draft_found *found = &draft->found[m];
        if (!overlap(&found->rect, &tile->rect))
            continue;
        mem_grow(&list->entries, &list->capacity, list->count + found->count, sizeof(*list->entries));
        for (size_t i = 0; i < found->count; i++)
            if (overlap(&found->items[i].rect, &tile->rect)) {
                uint64_t order = (uint64_t)(UINT32_MAX - bits_of(found->items[i].near)) << 32 | list->count;
                list->entries[list->count++] = (struct entry){ order, (uint32_t)m, (uint32_t)i };
            }
    }
    if (list->count > 1) /* where there is none, there may be no array */
        qsort(list->entries, list->count, sizeof(*list->entries), by_order);
}

/* In blocks of the tile. */
static struct draft_rect blocks_of(const struct draft_tile *tile, const struct draft_rect *rect)
{
    const struct draft_rect *all = &tile->rect;
    return (struct draft_rect){
        ((rect->left > all->left ? rect->left : all->left) - all->left) / BLOCK_PX,
        ((rect->top > all->top ? rect->top : all->top) - all->top) / BLOCK_PX,
        ((rect->right < all->right ? rect->right : all->right) - all->left) / BLOCK_PX,
        ((rect->bottom < all->bottom ? rect->bottom : all->bottom) - all->top) / BLOCK_PX,
    };
}

static bool is_hidden(const struct draft_tile *tile, const struct draft_rect *blocks, float near)
{
    for (int row = blocks->top; row <= blocks->bottom; row++)
        for (int column = blocks->left; column <= blocks->right; column++)
            if (near >= tile->farthest[row][column])
                return false;
    return true;
}

/* Where its faces are. */
static struct draft_rect faces_rect(const struct draft_tile *tile)
{
    struct draft_rect rect = { INT16_MAX, INT16_MAX, 0, 0 };
    for (int i = 0; i < tile->face_count; i++) {
        const struct draft_face *face = &tile->faces[i];
        rect.left = face->left < rect.left ? face->left : rect.left;
        rect.top = face->top < rect.top ? face->top : rect.top;
        rect.right = face->right > rect.right ? face->right : rect.right;
        rect.bottom = face->bottom > rect.bottom ? face->bottom : rect.bottom;
    }
    return rect;
}

static void begin_part(struct draft_tile *tile, const struct draft_found *found, const struct draft_item *item, int cuts)
{
    tile->mesh = &tile->draft->meshes[found - tile->draft->found];
    tile->parts = found->parts;
    tile->part = &found->parts->parts[item->part];
    tile->cuts = cuts;
}

static void draw_part(struct draft_tile *tile, const struct draft_found *found, const struct draft_item *item)
{
    const struct draft_mesh *mesh = tile->mesh;
    const struct draft_part *part = tile->part;
    const struct draft_kernels *kernels = tile->draft->kernels;
    struct draft_rect blocks = blocks_of(tile, &item->rect);
    if (item->beyond || is_hidden(tile, &blocks, item->near))
        return;
    kernels->place_part(tile, mesh, found->parts, part);
    if (item->cut)
        draft_cut_corners(tile);
    if (tile->corners.cut) {
        kernels->carry_part(tile, mesh, found->parts, part);
        draft_cut_faces(tile, found->both_sides);
    } else {
        kernels->find_faces(tile, mesh, found, part);
        if (tile->face_count > 0)
            kernels->carry_part(tile, mesh, found->parts, part);
    }
    if (tile->face_count == 0)
        return;
    tile->first_id = found->first_id + (uint32_t)(item - found->items) * PART_TRIANGLES;
    kernels->raster_faces(tile, mesh->has_field ? MARK_FIELD : MARK_CONTEXT | (found->ramp + part->material) << 16);
    struct draft_rect rect = faces_rect(tile);
    blocks = blocks_of(tile, &rect);
    kernels->look_again(tile, &blocks);
}

/* Before all else: what is behind a body that is cut open is hidden. */
static void draw_caps(struct draft_tile *tile, const struct list *list)
{
    const struct draft *draft = tile->draft;
    for (size_t i = 0; i < list->count; i++) {
        const struct draft_found *found = &draft->found[list->entries[i].mesh];
        const struct draft_item *item = &found->items[list->entries[i].item];
        begin_part(tile, found, item, draft->entry_count);
        draft_count_part(tile, found, item);
    }
    draft_cap_tile(tile);
    struct draft_rect blocks = blocks_of(tile, &tile->rect);
    draft->kernels->look_again(tile, &blocks);
}

static void clear(const struct draft_tile *tile)
{
    size_t bytes = (size_t)(tile->rect.right + 1 - tile->rect.left) * sizeof(float);
    for (int row = tile->rect.top; row <= tile->rect.bottom; row++) {
        size_t start = (size_t)row * (size_t)tile->draft->pitch_px + (size_t)tile->rect.left;
        memset(tile->draft->depth + start, 0, bytes);
        memset(tile->draft->marks + start, 0, bytes);
    }
}

static int columns_of(const struct draft *draft)
{
    return (draft->pitch_px + TILE_WIDTH_PX - 1) / TILE_WIDTH_PX;
}

static void draw_tile(const struct draft *draft, int number, enum draft_output output, struct list *list)
{
    struct draft_tile tile; /* not set to anything: corners and faces are large, and few are used */
    int left = number % columns_of(draft) * TILE_WIDTH_PX, top = number / columns_of(draft) * TILE_HEIGHT_PX;
    tile.draft = draft;
    tile.rect = (struct draft_rect){ left, top, left + TILE_WIDTH_PX - 1, top + TILE_HEIGHT_PX - 1 };
    if (tile.rect.right >= draft->pitch_px)
        tile.rect.right = draft->pitch_px - 1;
    if (tile.rect.bottom >= draft->height_px)
        tile.rect.bottom = draft->height_px - 1;
    memset(tile.farthest, 0, sizeof(tile.farthest));
    clear(&tile);
    fill_list(&tile, list);
    if (draft->counts_bodies)
        draw_caps(&tile, list);
    for (size_t i = 0; i < list->count && output != DRAFT_CAPS; i++) {
        const struct draft_found *found = &draft->found[list->entries[i].mesh];
        const struct draft_item *item = &found->items[list->entries[i].item];
        begin_part(&tile, found, item, draft->cut_count);
        draw_part(&tile, found, item);
    }
}

struct drawing {
    const struct draft *draft;
    enum draft_output output;
};

static void draw_tiles(void *arg, size_t begin, size_t end)
{
    const struct drawing *drawing = arg;
    const struct draft *draft = drawing->draft;
    struct list list = { 0 };
    for (size_t t = begin; t < end; t++) {
        list.count = 0;
        draw_tile(draft, (int)t, drawing->output, &list);
        if (drawing->output == DRAFT_COLORS) {
            int left = (int)t % columns_of(draft) * TILE_WIDTH_PX, top = (int)t / columns_of(draft) * TILE_HEIGHT_PX;
            int right = left + TILE_WIDTH_PX < draft->width_px ? left + TILE_WIDTH_PX : draft->width_px;
            int bottom = top + TILE_HEIGHT_PX < draft->height_px ? top + TILE_HEIGHT_PX : draft->height_px;
            draft->kernels->color(draft, &(struct draft_rect){ left, top, right - 1, bottom - 1 });
        }
    }
    mem_free(list.entries);
}

void draft_tiles(struct draft *draft, enum draft_output output)
{
    struct drawing drawing = { draft, output };
    int rows = (draft->height_px + TILE_HEIGHT_PX - 1) / TILE_HEIGHT_PX;
    workers_for(draft->workers, (size_t)(columns_of(draft) * rows), 1, draw_tiles, &drawing);
}
