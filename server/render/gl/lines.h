/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The passes that draw lines over the resolved picture: edges of shapes, and the outline of the selected asset.
   Thread: the one of the GL context. */
#ifndef RENDER_GL_LINES_H
#define RENDER_GL_LINES_H
#include "gpu/target.h"
#include "render/frame_context.h"

struct lines {
    GLuint edge_program, outline_program, vao;
    struct render_texture mask;
};

bool lines_init(struct lines *lines, struct log *log); /* false: logged */
void lines_finish(struct lines *lines);
void lines_draw_edges(const struct lines *lines, const struct frame_context *context);
double lines_outline_px(const struct view *view); /* width of its dark line; the light one is as wide */
/* Of view->selected_asset, also where something stands before it. */
void lines_draw_outline(struct lines *lines, const struct frame_context *context);

#endif
