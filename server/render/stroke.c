/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Copies of what a picture shows, and its tiles. */
#include "render/stroke.h"

#include <string.h>

#include "base/mem.h"
#include "gpu/mesh.h"

/* Tiles are squares of 1, 4 or 16 cells; the rasteriser works on 64 x 64 pixels at a time. */
enum { BLOCK_PX = 256, SIDE_CELLS = 4, BLOCK_CELLS = SIDE_CELLS * SIDE_CELLS };

void stroke_init(struct stroke *stroke, const struct picture *picture, const struct target *target, struct frame *frame, bool whole)
{
    size_t assets = picture->stage->scene->asset_count;
    *stroke = (struct stroke){ .picture = *picture, .view = *picture->view, .target = *target, .frame = frame };
    stroke->block_px = whole ? VIEW_MAX_SIDE_PX : BLOCK_PX;
    stroke->columns = (target->width_px + stroke->block_px - 1) / stroke->block_px;
    stroke->rows = (target->height_px + stroke->block_px - 1) / stroke->block_px;
    stroke->fields = mem_array(assets, sizeof(*stroke->fields));
    stroke->visible = mem_array(assets, sizeof(*stroke->visible));
    stroke->in_tile = mem_array(assets, sizeof(*stroke->in_tile));
    memcpy(stroke->fields, picture->fields, assets * sizeof(*stroke->fields));
    memcpy(stroke->visible, picture->visible, picture->visible_count * sizeof(*stroke->visible));
    stroke->picture.view = &stroke->view;
    stroke->picture.target = &stroke->target;
    stroke->picture.fields = stroke->fields;
    stroke->picture.visible = stroke->visible;
}

static GLuint copy_buffer(struct log *log, GLuint from)
{
    GLint64 bytes = 0;
    glGetNamedBufferParameteri64v(from, GL_BUFFER_SIZE, &bytes);
    GLuint copy = mesh_buffer(log, "sensors of a picture", (size_t)bytes, NULL, 0);
    if (copy)
        glCopyNamedBufferSubData(from, copy, 0, 0, bytes);
    return copy;
}

/* False: out of memory of some kind, logged. */
static bool copy_field(const struct stroke *stroke, const struct fields_entry *from, struct fields_entry *copy)
{
    struct log *log = stroke->picture.stage->gl->log;
    *copy = *from;
    copy->shown = NULL;
    copy->sensors = 0;
    copy->slice = stroke->plate ? NULL : pool_hold(from->slice);
    if (!stroke->plate)
        return !from->sensors || (copy->sensors = copy_buffer(log, from->sensors));
    copy->shown = mem_try_array(from->ready, sizeof(*copy->shown));
    if (!copy->shown) {
        log_err(log, "field of a picture: out of memory: %zu vertices", from->ready);
        return false;
    }
    memcpy(copy->shown, from->shown, from->ready * sizeof(*copy->shown));
    return true;
}

bool stroke_hold_fields(struct stroke *stroke)
{
    const struct stage *stage = stroke->picture.stage;
    stroke->copies = mem_array(stage->scene->asset_count, sizeof(*stroke->copies));
    for (size_t i = 0; i < stroke->picture.visible_count; i++) {
        int asset = stroke->visible[i];
        const struct fields_entry *from = stroke->fields[asset];
        if (!from || !from->slice)
            continue;
        if (!copy_field(stroke, from, &stroke->copies[asset]))
            return false;
        stroke->fields[asset] = &stroke->copies[asset];
    }
    return true;
}

void stroke_finish(struct stroke *stroke)
{
    for (size_t i = 0; stroke->copies && i < stroke->picture.stage->scene->asset_count; i++) {
        pool_release(&stroke->copies[i].slice);
        glDeleteBuffers(1, &stroke->copies[i].sensors);
        mem_free(stroke->copies[i].shown);
    }
    light_release(stroke->light);
    if (stroke->frame)
        frame_unref(&stroke->frame);
    mem_free(stroke->isolines.at);
    mem_free(stroke->copies);
    mem_free(stroke->fields);
    mem_free(stroke->visible);
    mem_free(stroke->in_tile);
    *stroke = (struct stroke){ 0 };
}

static bool is_whole(const struct stroke *stroke)
{
    return stroke->block_px == VIEW_MAX_SIDE_PX;
}

int stroke_cells(const struct stroke *stroke)
{
    return stroke->columns * stroke->rows * (is_whole(stroke) ? 1 : BLOCK_CELLS);
}

/* Every second bit of a cell's place in the Z. */
static int cell_at(int place)
{
    return (place & 1) | (place >> 1 & 2) | (place >> 2 & 4);
}

static struct tile clip_tile(const struct stroke *stroke, int x_px, int y_px, int side_px)
{
    struct tile tile = { .x_px = x_px, .y_px = y_px };
    int right_px = stroke->target.width_px - x_px, bottom_px = stroke->target.height_px - y_px;
    tile.width_px = right_px < side_px ? right_px : side_px;
    tile.height_px = bottom_px < side_px ? bottom_px : side_px;
    return tile.width_px > 0 && tile.height_px > 0 ? tile : (struct tile){ 0 };
}

struct tile stroke_choose_tile(struct stroke *stroke, double most_px)
{
    int index = stroke->next % stroke_cells(stroke), cells = is_whole(stroke) ? 1 : BLOCK_CELLS;
    int block = index / cells, place = index % cells, cell_px = is_whole(stroke) ? VIEW_MAX_SIDE_PX : BLOCK_PX / SIDE_CELLS;
    int side = 1;
    while (!stroke->span && !is_whole(stroke) && 2 * side <= SIDE_CELLS && place % (4 * side * side) == 0 &&
           4.0 * side * side * cell_px * cell_px <= most_px)
        side *= 2;
    if (!stroke->span)
        stroke->span = side * side;
    for (side = 1; side * side < stroke->span;)
        side *= 2;
    return clip_tile(stroke, block % stroke->columns * stroke->block_px + cell_at(place) * cell_px,
                     block / stroke->columns * stroke->block_px + cell_at(place >> 1) * cell_px, side * cell_px);
}

struct picture stroke_tile_picture(struct stroke *stroke, const struct tile *tile)
{
    struct picture picture = stroke->picture;
    double width = 2.0 / stroke->target.width_px, height = 2.0 / stroke->target.height_px;
    shot_narrow(&picture.shot, (double[2]){ tile->x_px * width - 1, 1 - (tile->y_px + tile->height_px) * height },
                (double[2]){ (tile->x_px + tile->width_px) * width - 1, 1 - tile->y_px * height });
    picture.visible = stroke->in_tile;
    picture.visible_count = 0;
    for (size_t i = 0; i < stroke->picture.visible_count; i++)
        if (shot_sees(&picture.shot, &picture.stage->scene->assets[stroke->visible[i]]))
            stroke->in_tile[picture.visible_count++] = stroke->visible[i];
    return picture;
}
