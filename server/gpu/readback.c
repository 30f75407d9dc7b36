/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads frames back through a persistently mapped pixel buffer. */
#include "gpu/readback.h"

#include <string.h>

#include "gpu/mesh.h"

/* timeout in nanoseconds for a frame to arrive from the GPU, much longer than any frame takes; afterwards the GL context counts
   as hung */
static const GLuint64 TIMEOUT_NS = 20ull * 1000000000;
enum { GRAIN_ROWS = 128 };

static bool fit(struct readback *readback, struct log *log, size_t bytes)
{
    GLbitfield read = GL_MAP_READ_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
    if (bytes <= readback->capacity_bytes)
        return true;
    readback_finish(readback);
    readback->buffer = mesh_buffer(log, "readback", bytes, NULL, read | GL_CLIENT_STORAGE_BIT);
    readback->pixels = readback->buffer ? glMapNamedBufferRange(readback->buffer, 0, (GLsizeiptr)bytes, read) : NULL;
    readback->capacity_bytes = readback->pixels ? bytes : 0;
    return readback->pixels != NULL;
}

bool readback_start(struct readback *readback, struct log *log, const struct target *target)
{
    if (!fit(readback, log, (size_t)target->width_px * (size_t)target->height_px * 4))
        return false;
    readback->width_px = target->width_px;
    readback->height_px = target->height_px;
    glBindFramebuffer(GL_READ_FRAMEBUFFER, target->resolved_framebuffer);
    glBindBuffer(GL_PIXEL_PACK_BUFFER, readback->buffer);
    glReadPixels(0, 0, target->width_px, target->height_px, GL_BGRA, GL_UNSIGNED_BYTE, NULL);
    glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
    readback->done = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    glFlush();
    return true;
}

static bool is_signaled(GLenum status)
{
    return status == GL_ALREADY_SIGNALED || status == GL_CONDITION_SATISFIED;
}

bool readback_is_done(const struct readback *readback)
{
    return is_signaled(glClientWaitSync(readback->done, 0, 0));
}

bool readback_wait(struct readback *readback, struct log *log)
{
    bool there = is_signaled(glClientWaitSync(readback->done, GL_SYNC_FLUSH_COMMANDS_BIT, TIMEOUT_NS));
    if (!there)
        log_err(log, "cannot read a picture of %dx%d back from the GPU: the OpenGL context does not respond", readback->width_px,
                readback->height_px);
    return there;
}

struct readback_copy {
    const struct readback *readback;
    uint8_t *bgrx;
    size_t stride_bytes;
};

static void copy_rows(void *arg, size_t begin, size_t end)
{
    const struct readback_copy *copy = arg;
    size_t row_bytes = (size_t)copy->readback->width_px * 4;
    for (size_t y = begin; y < end; y++)
        memcpy(copy->bgrx + y * copy->stride_bytes, copy->readback->pixels + y * row_bytes, row_bytes);
}

void readback_get(const struct readback *readback, struct workers *workers, uint8_t *bgrx, size_t stride_bytes)
{
    struct readback_copy copy = { .readback = readback, .bgrx = bgrx, .stride_bytes = stride_bytes };
    workers_for(workers, (size_t)readback->height_px, GRAIN_ROWS, copy_rows, &copy);
}

void readback_drop(struct readback *readback)
{
    glDeleteSync(readback->done);
    readback->done = NULL;
}

void readback_finish(struct readback *readback)
{
    readback_drop(readback);
    glDeleteBuffers(1, &readback->buffer);
    *readback = (struct readback){ 0 };
}
