/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Asynchronous readback of a frame from the GPU: other work can be done between start and end. Call only in the thread that owns
   the GL context. */
#ifndef GPU_READBACK_H
#define GPU_READBACK_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/workers.h"
#include "gpu/target.h"

struct readback { /* zero-initialise */
    GLuint buffer;
    const uint8_t *pixels; /* mapped memory of the buffer */
    size_t capacity_bytes;
    int width_px, height_px;
    GLsync done;
};

/* Starts copying the target's resolved picture to the CPU, without waiting; call target_resolve() first. The target may be
   drawn to again immediately. Logs and returns false when out of GPU memory. */
bool readback_start(struct readback *readback, struct log *log, const struct target *target);
bool readback_is_done(const struct readback *readback);         /* never waits */
/* Waits for the end of the copy. Logs and returns false if the GL context is lost. */
bool readback_wait(struct readback *readback, struct log *log);
/* Copies the pixels of the frame to `bgrx`; call it after readback_wait(). Four bytes per pixel (B, G, R, X), rows from the
   top, stride_bytes apart. */
void readback_get(const struct readback *readback, struct workers *workers, uint8_t *bgrx, size_t stride_bytes);
void readback_drop(struct readback *readback); /* ends the readback, whether or not readback_wait() was called */
void readback_finish(struct readback *readback);

#endif
