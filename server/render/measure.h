/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A target for numbers instead of colours. Thread: the one of the GL context. */
#ifndef RENDER_MEASURE_H
#define RENDER_MEASURE_H
#include <stdbool.h>

#include "base/log.h"
#include <glad/gl.h>

struct measure {
    int width_px, height_px;
    GLuint framebuffer, numbers, depth;
};

/* Made, cleared to MEASURE_NOTHING and bound. False: out of GPU memory, logged; finish copes. */
bool measure_begin(struct measure *measure, struct log *log, int width_px, int height_px);
void measure_read(const struct measure *measure, float (*out)[4]); /* rows from the top */
void measure_finish(struct measure *measure);

#endif
