/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads pictures through a pixel buffer. */
#include "gpu/readback.h"

#include <string.h>

#include "gpu/mesh.h"

static const GLuint64 TIMEOUT_NS = 20ull * 1000000000; /* far beyond any frame: the context hangs */

bool readback_start(struct readback *readback, struct log *log, const struct target *target)
{
    size_t bytes = (size_t)target->width_px * (size_t)target->height_px * 4;
    if (bytes > readback->capacity_bytes) {
        readback_finish(readback);
        readback->buffer = mesh_buffer(log, "readback", bytes, NULL, GL_MAP_READ_BIT | GL_CLIENT_STORAGE_BIT);
        if (!readback->buffer)
            return false;
        readback->capacity_bytes = bytes;
    }
    readback->width_px = target->width_px;
    readback->height_px = target->height_px;
    glBindFramebuffer(GL_READ_FRAMEBUFFER, target->resolved_framebuffer);
    glBindBuffer(GL_PIXEL_PACK_BUFFER, readback->buffer);
    glReadPixels(0, 0, target->width_px, target->height_px, GL_BGRA, GL_UNSIGNED_BYTE, NULL);
    glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
    readback->done = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    return true;
}

static void complain(const struct readback *readback, struct log *log)
{
    log_err(log, "readback of %dx%d: the GL context does not answer", readback->width_px, readback->height_px);
}

bool readback_wait(struct readback *readback, struct log *log)
{
    GLenum status = glClientWaitSync(readback->done, GL_SYNC_FLUSH_COMMANDS_BIT, TIMEOUT_NS);
    glDeleteSync(readback->done);
    readback->done = NULL;
    if (status == GL_ALREADY_SIGNALED || status == GL_CONDITION_SATISFIED)
        return true;
    complain(readback, log);
    return false;
}

bool readback_get(struct readback *readback, struct log *log, uint8_t *bgrx, size_t stride_bytes)
{
    size_t row_bytes = (size_t)readback->width_px * 4, rows = (size_t)readback->height_px;
    const uint8_t *from = glMapNamedBufferRange(readback->buffer, 0, (GLsizeiptr)(row_bytes * rows), GL_MAP_READ_BIT);
    if (!from) {
        complain(readback, log);
        return false;
    }
    if (stride_bytes == row_bytes) {
        memcpy(bgrx, from, row_bytes * rows);
    } else {
        for (size_t y = 0; y < rows; y++)
            memcpy(bgrx + y * stride_bytes, from + y * row_bytes, row_bytes);
    }
    glUnmapNamedBuffer(readback->buffer);
    return true;
}

void readback_finish(struct readback *readback)
{
    if (readback->done)
        glDeleteSync(readback->done);
    glDeleteBuffers(1, &readback->buffer);
    *readback = (struct readback){ 0 };
}
