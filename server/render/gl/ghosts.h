/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The pass that hints at ghosted assets: outline and a thin tint over the resolved picture, where nothing stands before them. Of ghosts
   behind one another the nearest is drawn. Thread: the one of the GL context. */
#ifndef RENDER_GL_GHOSTS_H
#define RENDER_GL_GHOSTS_H
#include "gpu/target.h"
#include "render/frame_context.h"

struct ghosts {
    GLuint program, vao;
    struct render_texture depth;
};

/* Returns whether an asset is a ghost that the camera may see, and whether any is. */
bool ghosts_shows(const struct frame_context *context, size_t asset);
bool ghosts_any(const struct frame_context *context);
bool ghosts_init(struct ghosts *ghosts, struct log *log); /* false: logged */
void ghosts_finish(struct ghosts *ghosts);
void ghosts_draw(struct ghosts *ghosts, const struct frame_context *context); /* nothing to do where there is none */

#endif
