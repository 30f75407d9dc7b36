/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Render jobs: hold copies of a frame's view, fields and visible assets while the frame is drawn in steps. */
#include "render/render_job.h"

#include <string.h>

#include "base/mem.h"
#include "gpu/mesh.h"
#include "render/gl/sensor_cells.h"

void render_job_init(struct render_job *job, const struct frame_context *context, struct frame *frame)
{
    size_t assets = context->gpu_scene->scene->asset_count;
    *job = (struct render_job){ .context = *context, .view = *context->view, .frame = frame };
    job->fields = mem_array(assets, sizeof(*job->fields));
    job->visible = mem_array(assets, sizeof(*job->visible));
    memcpy(job->fields, context->fields, assets * sizeof(*job->fields));
    memcpy(job->visible, context->visible, context->visible_count * sizeof(*job->visible));
    job->context.view = &job->view;
    job->context.fields = job->fields;
    job->context.visible = job->visible;
}

static GLuint copy_buffer(struct log *log, GLuint from)
{
    GLint64 bytes = 0;
    glGetNamedBufferParameteri64v(from, GL_BUFFER_SIZE, &bytes);
    GLuint copy = mesh_buffer(log, "copy of the sensors for a picture in progress", (size_t)bytes, NULL, 0);
    if (copy)
        glCopyNamedBufferSubData(from, copy, 0, 0, bytes);
    return copy;
}

/* Copies one asset's field. Logs and returns false when out of memory (main or GPU). */
static bool copy_field(const struct render_job *job, const struct fields_entry *from, bool on_gpu, struct fields_entry *copy)
{
    struct log *log = job->context.gpu_scene->gl->log;
    *copy = *from;
    copy->shown = NULL;
    copy->sensors = 0;
    copy->cells = on_gpu ? sensor_cells_ref(from->cells) : NULL;
    copy->pixels = (struct pixel_field){ 0 };
    pixel_field_copy(&copy->pixels, &from->pixels);
    copy->slice = on_gpu ? pool_ref(from->slice) : NULL;
    if (on_gpu)
        return !from->sensors || (copy->sensors = copy_buffer(log, from->sensors));
    copy->shown = mem_try_array(from->ready, sizeof(*copy->shown));
    if (!copy->shown) {
        log_err(log, "a picture was not drawn: out of memory for the colours at %zu vertices", from->ready);
        return false;
    }
    memcpy(copy->shown, from->shown, from->ready * sizeof(*copy->shown));
    return true;
}

bool render_job_hold_fields(struct render_job *job, bool on_gpu)
{
    const struct gpu_scene *gpu_scene = job->context.gpu_scene;
    job->copies = mem_array(gpu_scene->scene->asset_count, sizeof(*job->copies));
    for (size_t i = 0; i < job->context.visible_count; i++) {
        int asset = job->visible[i];
        const struct fields_entry *from = job->fields[asset];
        if (!from || !(on_gpu ? from->slice != NULL : from->shown != NULL))
            continue;
        if (!copy_field(job, from, on_gpu, &job->copies[asset]))
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
        sensor_cells_unref(&job->copies[i].cells);
        mem_free(job->copies[i].shown);
        pixel_field_finish(&job->copies[i].pixels);
    }
    light_release(job->light);
    if (job->frame)
        frame_unref(&job->frame);
    mem_free(job->isolines.at);
    mem_free(job->copies);
    mem_free(job->fields);
    mem_free(job->visible);
    *job = (struct render_job){ 0 };
}
