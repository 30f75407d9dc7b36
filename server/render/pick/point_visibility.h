/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Projects points of the plant into a frame and tests on the GPU, against the frame's depth, whether they are hidden. Call only
   in the thread that owns the GL context. */
#ifndef RENDER_PICK_POINT_VISIBILITY_H
#define RENDER_PICK_POINT_VISIBILITY_H
#include "render/frame_context.h"

struct point_visibility {
    GLuint program; /* program of shaders/point_visibility.comp, owned by the caller; zero-initialise all other members */
    GLuint buffer;
    float (*places)[4]; /* GPU memory mapped into this process: holds the input of the test, and later its result */
    size_t capacity;
};

/* Returns a mapped buffer for `count` points, which the caller fills: eye-space position and depth tolerance in metres. The
   previous frame that used the buffer must be complete. Returns NULL if the context is lost, or the GPU is out of memory
   (logged). */
float (*point_visibility_reserve(struct point_visibility *queries, const struct gl *gl, size_t count))[4];
/* Starts the visibility test on the GPU; call it after the multisampled frame is resolved. Once the GPU is done, each element
   of the buffer holds a point's x and y in pixels, and whether the point is hidden (1 or 0). Returns false on a GL error
   (logged). */
bool point_visibility_start(const struct point_visibility *queries, const struct frame_context *context, size_t count);
void point_visibility_finish(struct point_visibility *queries);

#endif
