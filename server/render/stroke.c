/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Copies of what a picture shows, and its tiles. */
#include "render/stroke.h"

#include <string.h>

#include "base/mem.h"
#include "gpu/mesh.h"

void stroke_init(struct stroke *stroke, const struct picture *picture, const struct target *target, struct frame *frame, int tile_px)
{
    size_t assets = picture->stage->scene->asset_count;
    *stroke = (struct stroke){ .picture = *picture, .view = *picture->view, .target = *target, .frame = frame, .tile_px = tile_px };
    stroke->columns = (target->width_px + tile_px - 1) / tile_px;
    stroke->rows = (target->height_px + tile_px - 1) / tile_px;
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
    GLuint copy = mesh_buffer(log, "field of a picture", (size_t)bytes, NULL, 0);
    if (copy)
        glCopyNamedBufferSubData(from, copy, 0, 0, bytes);
    return copy;
}

bool stroke_hold_fields(struct stroke *stroke)
{
    const struct stage *stage = stroke->picture.stage;
    stroke->copies = mem_array(stage->scene->asset_count, sizeof(*stroke->copies));
    for (size_t i = 0; i < stroke->picture.visible_count; i++) {
        int asset = stroke->visible[i];
        const struct fields_entry *from = stroke->fields[asset];
        if (!from || !from->buffer)
            continue;
        struct fields_entry *copy = &stroke->copies[asset];
        *copy = *from;
        copy->shown = NULL;
        copy->sensors = 0;
        copy->buffer = copy_buffer(stage->gl->log, from->buffer);
        if (!copy->buffer)
            return false;
        if (from->sensors && !(copy->sensors = copy_buffer(stage->gl->log, from->sensors)))
            return false;
        stroke->fields[asset] = copy;
    }
    return true;
}

void stroke_finish(struct stroke *stroke)
{
    for (size_t i = 0; stroke->copies && i < stroke->picture.stage->scene->asset_count; i++)
        glDeleteBuffers(2, (GLuint[2]){ stroke->copies[i].buffer, stroke->copies[i].sensors });
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

int stroke_tile_count(const struct stroke *stroke)
{
    return stroke->columns * stroke->rows;
}

struct tile stroke_tile(const struct stroke *stroke, int index)
{
    struct tile tile = { .x_px = index % stroke->columns * stroke->tile_px, .y_px = index / stroke->columns * stroke->tile_px };
    int right_px = tile.x_px + stroke->tile_px, bottom_px = tile.y_px + stroke->tile_px;
    tile.width_px = (right_px < stroke->target.width_px ? right_px : stroke->target.width_px) - tile.x_px;
    tile.height_px = (bottom_px < stroke->target.height_px ? bottom_px : stroke->target.height_px) - tile.y_px;
    return tile;
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
