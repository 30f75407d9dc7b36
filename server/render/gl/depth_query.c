/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the cells of a frame's depth grid (coarse depth for clients, render/depth_grid.h) with a compute shader. It writes the cells to
   a buffer that the CPU maps. */
#include "render/gl/depth_query.h"

#include "gpu/mesh.h"
#include "render/light/sky.h"

static bool fit(struct depth_query *query, const struct gl *gl, size_t count)
{
    GLbitfield read = GL_MAP_READ_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
    if (count <= query->capacity || gl_lost(gl))
        return count <= query->capacity;
    depth_query_finish(query);
    size_t bytes = count * sizeof(*query->cells);
    query->buffer = mesh_buffer(gl->log, "depth query", bytes, NULL, read | GL_CLIENT_STORAGE_BIT);
    query->cells = query->buffer ? glMapNamedBufferRange(query->buffer, 0, (GLsizeiptr)bytes, read) : NULL;
    query->capacity = query->cells ? count : 0;
    return query->cells != NULL;
}

bool depth_query_start(struct depth_query *query, const struct frame_context *context, const struct light *light)
{
    struct gl *gl = context->gpu_scene->gl;
    int width_px = context->view->width_px, height_px = context->view->height_px;
    int columns = depth_cells_along(width_px), rows = depth_cells_along(height_px);
    query->width_px = query->height_px = 0;
    if (!context->gives_depth)
        return true;
    if (!fit(query, gl, (size_t)columns * (size_t)rows))
        return false;
    query->width_px = width_px;
    query->height_px = height_px;
    const double *ground = sky_sees_ground(context, light) ? light->plant_from_ground : NULL;
    depth_lens_init(&query->lens, &context->constants, ground, width_px, height_px);
    gl_pass_enter("depth");
    glUseProgram(query->program);
    glUniform2i(0, columns, rows);
    glUniform2f(1, query->lens.step, query->lens.least_step);
    glBindTextureUnit(0, context->target->resolved_depth);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, query->buffer);
    glDispatchCompute(((GLuint)(columns * rows) + 63) / 64, 1, 1);
    glMemoryBarrier(GL_CLIENT_MAPPED_BUFFER_BARRIER_BIT);
    return gl_pass_leave(gl, "depth");
}

struct depth_grid *depth_query_get(const struct depth_query *query)
{
    return query->width_px ? depth_grid_create(query->cells, &query->lens, query->width_px, query->height_px) : NULL;
}

void depth_query_finish(struct depth_query *query)
{
    glDeleteBuffers(1, &query->buffer);
    *query = (struct depth_query){ .program = query->program };
}
