/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The uniform block of shaders/frame.glsl: values that are the same for all draws of a frame. */
#ifndef RENDER_GL_FRAME_UNIFORMS_H
#define RENDER_GL_FRAME_UNIFORMS_H
#include "render/frame_context.h"

struct frame_uniforms { /* std140 layout */
    float clip_from_eye[16], eye_from_clip[16], sun_from_eye[16];
    float sun[4], up[4], scale[4], shade[4], lines[4], back[4];
    float clip[CLIP_MAX_PLANES][4];
};

/* Fills the block from the frame's camera, sun, scale and section planes. Pure. */
void frame_uniforms_fill(struct frame_uniforms *block, const struct frame_context *context);

#endif
