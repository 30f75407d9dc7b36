/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A target for numbers instead of colours. Thread: the one of the GL context. */
#ifndef RENDER_PICK_MEASURE_TARGET_H
#define RENDER_PICK_MEASURE_TARGET_H
#include <stdbool.h>

#include "base/log.h"
#include <glad/gl.h>

enum { MEASURE_CONTEXT = -1, MEASURE_NOTHING = -2 }; /* instead of "no data": an asset without a field; no asset */

struct measure_target {
    int width_px, height_px;
    GLuint framebuffer, numbers, depth;
};

/* Made, cleared to MEASURE_NOTHING and bound. False: out of GPU memory, logged; finish copes. */
bool measure_target_begin(struct measure_target *measure, struct log *log, int width_px, int height_px);
void measure_target_read(const struct measure_target *measure, float (*out)[4]); /* rows from the top */
void measure_target_finish(struct measure_target *measure);

#endif
