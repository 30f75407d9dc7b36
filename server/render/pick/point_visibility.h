/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where places of the plant stand in a picture, and whether something stands before them: by the GPU, from the picture's depth.
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

/* Room for so many places, to be filled in: eye space, metres, and how far it may lie behind the surface. The picture that they were
   used for last is done. NULL: out of GPU memory, logged, or the context is lost, and what it had mapped with it. */
float (*point_visibility_reserve(struct point_visibility *queries, const struct gl *gl, size_t count))[4];
/* Once the picture is resolved. When the GPU is done places hold x, y in pixels, hidden 0 or 1. False: logged. */
bool point_visibility_start(const struct point_visibility *queries, const struct frame_context *context, size_t count);
void point_visibility_finish(struct point_visibility *queries);

#endif
