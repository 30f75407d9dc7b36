/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A buffer that both sides see, and a compute shader. */
#include "render/sights.h"

#include "gpu/mesh.h"

enum { LEAST_PLACES = 256 };

float (*sights_fit(struct sights *sights, const struct gl *gl, size_t count))[4]
{
    GLbitfield both = GL_MAP_READ_BIT | GL_MAP_WRITE_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
    if (gl_lost(gl))
        return NULL;
    if (count <= sights->capacity)
        return sights->places;
    sights_finish(sights);
    size_t capacity = count > LEAST_PLACES ? count : LEAST_PLACES, bytes = capacity * sizeof(*sights->places);
    sights->buffer = mesh_buffer(gl->log, "places in a picture", bytes, NULL, both | GL_CLIENT_STORAGE_BIT);
    sights->places = sights->buffer ? glMapNamedBufferRange(sights->buffer, 0, (GLsizeiptr)bytes, both) : NULL;
    sights->capacity = sights->places ? capacity : 0;
    return sights->places;
}

bool sights_start(const struct sights *sights, const struct picture *picture, size_t count)
{
    gl_pass_enter("sights");
    glUseProgram(sights->program);
    glUniform1i(0, (GLint)count);
    glBindTextureUnit(0, picture->target->resolved_depth);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, sights->buffer);
    glDispatchCompute(((GLuint)count + 63) / 64, 1, 1);
    glMemoryBarrier(GL_CLIENT_MAPPED_BUFFER_BARRIER_BIT);
    return gl_pass_leave(picture->stage->gl, "sights");
}

void sights_finish(struct sights *sights)
{
    glDeleteBuffers(1, &sights->buffer);
    *sights = (struct sights){ .program = sights->program };
}
