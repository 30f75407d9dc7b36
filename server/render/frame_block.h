/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The uniform block of shaders/frame.glsl. */
#ifndef RENDER_FRAME_BLOCK_H
#define RENDER_FRAME_BLOCK_H
#include "render/picture.h"

struct frame_block { /* std140 */
    float clip_from_eye[16], eye_from_clip[16], sun_from_eye[16];
    float sun[4], up[4], scale[4], shade[4], lines[4], back[4];
    float clip[CLIP_MAX_PLANES][4];
};

void frame_block_fill(struct frame_block *block, const struct picture *picture);

#endif
