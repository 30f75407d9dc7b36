/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The pass that closes what a cut opens: closed bodies are solid, so that the cut shows a plane there, neutral, since no sensor knows what
   the field is inside. Over the resolved picture, with its depth. Thread: the one of the GL context. */
#ifndef RENDER_GL_SECTION_CAPS_H
#define RENDER_GL_SECTION_CAPS_H
#include "gpu/target.h"
#include "render/frame_context.h"

struct section_caps {
    GLuint count_program, color_program, depth_program, vao;
    struct render_texture bodies;
    struct model_draws draws;
};

bool section_caps_init(struct section_caps *caps, struct log *log); /* false: logged */
void section_caps_finish(struct section_caps *caps);
void section_caps_draw(struct section_caps *caps, const struct frame_context *context); /* nothing to do where nothing is cut */

#endif
