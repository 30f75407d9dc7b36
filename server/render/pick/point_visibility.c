/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tests the visibility of points with a compute shader. Points and results are in a buffer that CPU and GPU share. */
#include "render/pick/point_visibility.h"

#include "gpu/mesh.h"

enum { MIN_POINTS = 256 };

float (*point_visibility_reserve(struct point_visibility *queries, const struct gl *gl, size_t count))[4]
{
    GLbitfield both = GL_MAP_READ_BIT | GL_MAP_WRITE_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
    if (gl_lost(gl))
        return NULL;
    if (count <= queries->capacity)
        return queries->places;
    point_visibility_finish(queries);
    size_t capacity = count > MIN_POINTS ? count : MIN_POINTS, bytes = capacity * sizeof(*queries->places);
    queries->buffer = mesh_buffer(gl->log, "visibility query", bytes, NULL, both | GL_CLIENT_STORAGE_BIT);
    queries->places = queries->buffer ? glMapNamedBufferRange(queries->buffer, 0, (GLsizeiptr)bytes, both) : NULL;
    queries->capacity = queries->places ? capacity : 0;
    return queries->places;
}

bool point_visibility_start(const struct point_visibility *queries, const struct frame_context *context, size_t count)
{
    gl_pass_enter("queries");
    glUseProgram(queries->program);
    glUniform1i(0, (GLint)count);
    glBindTextureUnit(0, context->target->resolved_depth);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, queries->buffer);
    glDispatchCompute(((GLuint)count + 63) / 64, 1, 1);
    glMemoryBarrier(GL_CLIENT_MAPPED_BUFFER_BARRIER_BIT);
    return gl_pass_leave(context->gpu_scene->gl, "queries");
}

void point_visibility_finish(struct point_visibility *queries)
{
    glDeleteBuffers(1, &queries->buffer);
    *queries = (struct point_visibility){ .program = queries->program };
}
