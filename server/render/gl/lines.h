/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The passes that draw lines over the resolved frame: feature edges, and the outline of the selected asset. Call only in the
   thread that owns the GL context. */
#ifndef RENDER_GL_LINES_H
#define RENDER_GL_LINES_H
#include "gpu/target.h"
#include "render/frame_context.h"

struct gl_lines {
    GLuint edge_program, outline_program, vao;
    struct render_texture mask;
};

/* Compiles the shader programs for edges and outlines. On failure, logs the reason and returns false. */
bool lines_init(struct gl_lines *lines, struct log *log);
void lines_finish(struct gl_lines *lines);
/* Draws feature edges: darkens the frame where its depth has a step, so that the shapes of assets are visible. */
void lines_draw_edges(const struct gl_lines *lines, const struct frame_context *context);
/* Returns the width in pixels of the outline's dark line; the light line next to it has the same width. Pure. */
double lines_outline_px(const struct view *view);
/* Draws the outline of view->selected_asset, even where other surfaces hide the asset. */
void lines_draw_outline(struct gl_lines *lines, const struct frame_context *context);

#endif
