/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Copies of what a picture shows, and its tiles. */
#include "render/render_job.h"

#include <string.h>

#include "base/mem.h"
#include "gpu/mesh.h"

/* Tiles are squares of 1, 4 or 16 cells; the rasteriser works on 64 x 64 pixels at a time. */
enum { BLOCK_PX = 256, SIDE_CELLS = 4, BLOCK_CELLS = SIDE_CELLS * SIDE_CELLS };

void render_job_init(struct render_job *job, const struct frame_context *context, const struct target *target, struct frame *frame,
                     bool whole)
{
    size_t assets = context->gpu_scene->scene->asset_count;
    *job = (struct render_job){ .context = *context, .view = *context->view, .target = *target, .frame = frame };
    job->block_px = whole ? VIEW_MAX_SIDE_PX : BLOCK_PX;
    job->columns = (target->width_px + job->block_px - 1) / job->block_px;
    job->rows = (target->height_px + job->block_px - 1) / job->block_px;
    job->fields = mem_array(assets, sizeof(*job->fields));
    job->visible = mem_array(assets, sizeof(*job->visible));
    job->in_tile = mem_array(assets, sizeof(*job->in_tile));
    memcpy(job->fields, context->fields, assets * sizeof(*job->fields));
    memcpy(job->visible, context->visible, context->visible_count * sizeof(*job->visible));
    job->context.view = &job->view;
    job->context.target = &job->target;
    job->context.fields = job->fields;
    job->context.visible = job->visible;
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
static bool copy_field(const struct render_job *job, const struct fields_entry *from, struct fields_entry *copy)
{
    struct log *log = job->context.gpu_scene->gl->log;
    *copy = *from;
    copy->shown = NULL;
    copy->sensors = 0;
    copy->slice = job->refined ? NULL : pool_ref(from->slice);
    if (!job->refined)
        return !from->sensors || (copy->sensors = copy_buffer(log, from->sensors));
    copy->shown = mem_try_array(from->ready, sizeof(*copy->shown));
    if (!copy->shown) {
        log_err(log, "field of a picture: out of memory: %zu vertices", from->ready);
        return false;
    }
    memcpy(copy->shown, from->shown, from->ready * sizeof(*copy->shown));
    return true;
}

bool render_job_hold_fields(struct render_job *job)
{
    const struct gpu_scene *gpu_scene = job->context.gpu_scene;
    job->copies = mem_array(gpu_scene->scene->asset_count, sizeof(*job->copies));
    for (size_t i = 0; i < job->context.visible_count; i++) {
        int asset = job->visible[i];
        const struct fields_entry *from = job->fields[asset];
        if (!from || !from->slice)
            continue;
        if (!copy_field(job, from, &job->copies[asset]))
            return false;
        job->fields[asset] = &job->copies[asset];
    }
    return true;
}

void render_job_finish(struct render_job *job)
{
    for (size_t i = 0; job->copies && i < job->context.gpu_scene->scene->asset_count; i++) {
        pool_unref(&job->copies[i].slice);
        glDeleteBuffers(1, &job->copies[i].sensors);
        mem_free(job->copies[i].shown);
    }
    light_release(job->light);
    if (job->frame)
        frame_unref(&job->frame);
    mem_free(job->isolines.at);
    mem_free(job->copies);
    mem_free(job->fields);
    mem_free(job->visible);
    mem_free(job->in_tile);
    *job = (struct render_job){ 0 };
}

static bool is_whole(const struct render_job *job)
{
    return job->block_px == VIEW_MAX_SIDE_PX;
}

int render_job_cells(const struct render_job *job)
{
    return job->columns * job->rows * (is_whole(job) ? 1 : BLOCK_CELLS);
}

/* Every second bit of a cell's place in the Z. */
static int cell_at(int place)
{
    return (place & 1) | (place >> 1 & 2) | (place >> 2 & 4);
}

static struct tile clip_tile(const struct render_job *job, int x_px, int y_px, int side_px)
{
    struct tile tile = { .x_px = x_px, .y_px = y_px };
    int right_px = job->target.width_px - x_px, bottom_px = job->target.height_px - y_px;
    tile.width_px = right_px < side_px ? right_px : side_px;
    tile.height_px = bottom_px < side_px ? bottom_px : side_px;
    return tile.width_px > 0 && tile.height_px > 0 ? tile : (struct tile){ 0 };
}

struct tile render_job_choose_tile(struct render_job *job, double most_px)
{
    int index = job->next % render_job_cells(job), cells = is_whole(job) ? 1 : BLOCK_CELLS;
    int block = index / cells, place = index % cells, cell_px = is_whole(job) ? VIEW_MAX_SIDE_PX : BLOCK_PX / SIDE_CELLS;
    int side = 1;
    while (!job->span && !is_whole(job) && 2 * side <= SIDE_CELLS && place % (4 * side * side) == 0 &&
           4.0 * side * side * cell_px * cell_px <= most_px)
        side *= 2;
    if (!job->span)
        job->span = side * side;
    for (side = 1; side * side < job->span;)
        side *= 2;
    return clip_tile(job, block % job->columns * job->block_px + cell_at(place) * cell_px,
                     block / job->columns * job->block_px + cell_at(place >> 1) * cell_px, side * cell_px);
}

struct frame_context render_job_tile_context(struct render_job *job, const struct tile *tile)
{
    struct frame_context context = job->context;
    double width = 2.0 / job->target.width_px, height = 2.0 / job->target.height_px;
    view_constants_narrow(&context.constants, (double[2]){ tile->x_px * width - 1, 1 - (tile->y_px + tile->height_px) * height },
                          (double[2]){ (tile->x_px + tile->width_px) * width - 1, 1 - tile->y_px * height });
    context.visible = job->in_tile;
    context.visible_count = 0;
    for (size_t i = 0; i < job->context.visible_count; i++)
        if (view_constants_sees(&context.constants, &context.gpu_scene->scene->assets[job->visible[i]]))
            job->in_tile[context.visible_count++] = job->visible[i];
    return context;
}
