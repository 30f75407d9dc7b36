/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The pass that draws ghosted assets: an outline and a faint tint over the resolved picture, where no other surface is nearer.
   Where ghosts overlap, the nearest is drawn. Call only in the thread that owns the GL context. */
#ifndef RENDER_GL_GHOSTS_H
#define RENDER_GL_GHOSTS_H
#include "gpu/target.h"
#include "render/frame_context.h"

struct ghosts {
    GLuint program, vao;
    struct render_texture depth;
};

/* Returns whether an asset is ghosted (drawn only as an outline with a faint tint) and inside the view frustum; ghosts_any: whether any
   asset is. */
bool ghosts_shows(const struct frame_context *context, size_t asset);
bool ghosts_any(const struct frame_context *context);
/* Compiles the shader programs that draw ghosts (outlined assets). On failure, logs the reason and returns false. */
bool ghosts_init(struct ghosts *ghosts, struct log *log);
void ghosts_finish(struct ghosts *ghosts);
/* Draws all ghosts (assets shown as an outline with a faint tint) over the resolved picture; does nothing if there are none. */
void ghosts_draw(struct ghosts *ghosts, const struct frame_context *context);

#endif
