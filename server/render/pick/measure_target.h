/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A render target of floating-point numbers instead of colours, for measuring the field at every pixel.
   Thread: the one of the GL context. */
#ifndef RENDER_PICK_MEASURE_TARGET_H
#define RENDER_PICK_MEASURE_TARGET_H
#include <stdbool.h>

#include "base/log/log.h"
#include <glad/gl.h>

/* values in the no-data channel: MEASURE_CONTEXT: an asset without a field; MEASURE_NOTHING: no asset */
enum { MEASURE_CONTEXT = -1, MEASURE_NOTHING = -2 };

struct measure_target {
    int width_px, height_px;
    GLuint framebuffer, numbers, depth;
};

/* Creates the target, clears it to MEASURE_NOTHING and binds it. Returns false when the GPU is out of memory, logged;
   measure_target_finish() must still be called. */
bool measure_target_begin(struct measure_target *measure, struct log *log, int width_px, int height_px);
/* Reads all pixels, rows from the top; waits for the GPU. */
void measure_target_read(const struct measure_target *measure, float (*out)[4]);
void measure_target_finish(struct measure_target *measure);

#endif
