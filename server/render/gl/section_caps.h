/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The pass that fills the cut faces (caps) of closed bodies where a section plane cuts them. Caps have a neutral colour, since
   no sensor measures the field inside a body. The pass draws over the resolved frame and writes its depth. Call only in the
   thread that owns the GL context. */
#ifndef RENDER_GL_SECTION_CAPS_H
#define RENDER_GL_SECTION_CAPS_H
#include "gpu/target.h"
#include "render/frame_context.h"

struct section_caps {
    GLuint count_program, color_program, depth_program, vao;
    struct render_texture bodies;
    struct model_draws draws;
};

/* Compiles the shader programs that draw section caps (cut faces of closed bodies). On failure, logs the reason and returns
   false. */
bool section_caps_init(struct section_caps *caps, struct log *log);
void section_caps_finish(struct section_caps *caps);
/* Draws the caps (cut faces of closed bodies) on all section planes; does nothing if the view has no section plane. */
void section_caps_draw(struct section_caps *caps, const struct frame_context *context);

#endif
