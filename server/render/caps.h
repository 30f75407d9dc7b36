/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The pass that closes what a cut opens: closed bodies are solid, so that the cut shows a plane there, neutral, since no sensor knows what
   the field is inside. Over the resolved picture, with its depth. Thread: the one of the GL context. */
#ifndef RENDER_CAPS_H
#define RENDER_CAPS_H
#include "gpu/target.h"
#include "render/picture.h"

struct caps {
    GLuint count_program, color_program, depth_program, vao;
    struct layer bodies;
    struct model_draws draws;
};

bool caps_init(struct caps *caps, struct log *log); /* false: logged */
void caps_finish(struct caps *caps);
void caps_draw(struct caps *caps, const struct picture *picture); /* nothing to do where nothing is cut */

#endif
