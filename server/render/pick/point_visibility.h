/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Projects points of the plant into a picture and tests on the GPU, against the picture's depth, whether they are hidden.
   Thread: the one of the GL context. */
#ifndef RENDER_PICK_POINT_VISIBILITY_H
#define RENDER_PICK_POINT_VISIBILITY_H
#include "render/frame_context.h"

struct point_visibility {
    GLuint program; /* shaders/point_visibility.comp, the caller's; the rest zero-initialised */
    GLuint buffer;
    float (*places)[4]; /* as the GPU sees them */
    size_t capacity;
};

/* Returns a mapped buffer for `count` points, which the caller fills: eye-space position and depth tolerance in metres. The picture that
   used the buffer last must be done. Returns NULL if the GPU is out of memory, which is logged, or if the context is lost. */
float (*point_visibility_reserve(struct point_visibility *queries, const struct gl *gl, size_t count))[4];
/* Starts the test once the picture is resolved. When the GPU is done, each place holds x and y in pixels, then 1 if hidden, else 0.
   Returns false on a GL error; that is logged. */
bool point_visibility_start(const struct point_visibility *queries, const struct frame_context *context, size_t count);
void point_visibility_finish(struct point_visibility *queries);

#endif
