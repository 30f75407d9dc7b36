/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Divides a frame into tiles and chooses the next tile and its size. */
#include "render/gl/frame_tiles.h"

#include "base/mem.h"

/* Tiles are squares of 1, 4 or 16 cells. A cell is 64 x 64 pixels, the unit in which the GL rasterizer works. */
enum { TILE_BLOCK_PX = 256, SIDE_CELLS = 4, BLOCK_CELLS = SIDE_CELLS * SIDE_CELLS };

void frame_tiles_init(struct frame_tiles *tiles, const struct frame_context *context, bool whole)
{
    *tiles = (struct frame_tiles){ .width_px = context->view->width_px, .height_px = context->view->height_px };
    tiles->block_px = whole ? VIEW_MAX_SIDE_PX : TILE_BLOCK_PX;
    tiles->columns = (tiles->width_px + tiles->block_px - 1) / tiles->block_px;
    tiles->rows = (tiles->height_px + tiles->block_px - 1) / tiles->block_px;
    tiles->in_tile = mem_array(context->gpu_scene->scene->asset_count, sizeof(*tiles->in_tile));
}

void frame_tiles_finish(struct frame_tiles *tiles)
{
    mem_free(tiles->in_tile);
}

static bool is_whole(const struct frame_tiles *tiles)
{
    return tiles->block_px == VIEW_MAX_SIDE_PX;
}

int frame_tiles_cells(const struct frame_tiles *tiles)
{
    return tiles->columns * tiles->rows * (is_whole(tiles) ? 1 : BLOCK_CELLS);
}

/* Returns a cell's column within its block. Cells (squares of 64 x 64 pixels) are numbered in Z-order (Morton code), so every
   second bit of the index belongs to the column. For index >> 1, returns the row. */
static int cell_at(int place)
{
    return (place & 1) | (place >> 1 & 2) | (place >> 2 & 4);
}

static struct tile clip_tile(const struct frame_tiles *tiles, int x_px, int y_px, int side_px)
{
    struct tile tile = { .x_px = x_px, .y_px = y_px };
    int right_px = tiles->width_px - x_px, bottom_px = tiles->height_px - y_px;
    tile.width_px = right_px < side_px ? right_px : side_px;
    tile.height_px = bottom_px < side_px ? bottom_px : side_px;
    return tile.width_px > 0 && tile.height_px > 0 ? tile : (struct tile){ 0 };
}

struct tile frame_tiles_choose(struct frame_tiles *tiles, double most_px)
{
    int index = tiles->next % frame_tiles_cells(tiles), cells = is_whole(tiles) ? 1 : BLOCK_CELLS;
    int block = index / cells, place = index % cells, cell_px = is_whole(tiles) ? VIEW_MAX_SIDE_PX : TILE_BLOCK_PX / SIDE_CELLS;
    int side = 1;
    while (!tiles->span && !is_whole(tiles) && 2 * side <= SIDE_CELLS && place % (4 * side * side) == 0 &&
           4.0 * side * side * cell_px * cell_px <= most_px)
        side *= 2;
    if (!tiles->span)
        tiles->span = side * side;
    for (side = 1; side * side < tiles->span;)
        side *= 2;
    return clip_tile(tiles, block % tiles->columns * tiles->block_px + cell_at(place) * cell_px,
                     block / tiles->columns * tiles->block_px + cell_at(place >> 1) * cell_px, side * cell_px);
}

struct frame_context frame_tiles_context(struct frame_tiles *tiles, const struct frame_context *frame, const struct tile *tile)
{
    struct frame_context context = *frame;
    double width = 2.0 / tiles->width_px, height = 2.0 / tiles->height_px;
    view_constants_narrow(&context.constants, (double[2]){ tile->x_px * width - 1, 1 - (tile->y_px + tile->height_px) * height },
                          (double[2]){ (tile->x_px + tile->width_px) * width - 1, 1 - tile->y_px * height });
    context.visible = tiles->in_tile;
    context.visible_count = 0;
    for (size_t i = 0; i < frame->visible_count; i++)
        if (view_constants_sees(&context.constants, &context.gpu_scene->scene->assets[frame->visible[i]]))
            tiles->in_tile[context.visible_count++] = frame->visible[i];
    return context;
}
