/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Gets a picture out of the GPU, started and finished apart so that other work fits between. Thread: the one of the GL context. */
#ifndef GPU_READBACK_H
#define GPU_READBACK_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/workers.h"
#include "gpu/target.h"

struct readback { /* zero-initialise */
    GLuint buffer;
    const uint8_t *pixels; /* the buffer, as it comes in */
    size_t capacity_bytes;
    int width_px, height_px;
    GLsync done;
};

/* Begins to copy the resolved picture of the target, without waiting; the caller has called target_resolve(). The target may be drawn to
   again at once. Returns false if out of GPU memory, logged. */
bool readback_start(struct readback *readback, struct log *log, const struct target *target);
bool readback_is_done(const struct readback *readback);         /* without waiting */
bool readback_wait(struct readback *readback, struct log *log); /* until it is there. False: the GL context is lost, logged */
/* After that: 4 bytes a pixel (B, G, R, X), rows from the top, stride_bytes apart. */
void readback_get(const struct readback *readback, struct workers *workers, uint8_t *bgrx, size_t stride_bytes);
void readback_drop(struct readback *readback); /* it is not waited for, or was */
void readback_finish(struct readback *readback);

#endif
