/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws feature edges, found in the depth buffer, and outlines, found in a mask of the selected asset. */
#include "render/gl/lines.h"

#include <math.h>

#include "gpu/program.h"

bool lines_init(struct gl_lines *lines, struct log *log)
{
    lines->edge_program = program_create(log, program_params(.vertex = "screen.vert", .fragment = "edges.frag"));
    lines->outline_program = program_create(log, program_params(.vertex = "screen.vert", .fragment = "outline.frag"));
    glCreateVertexArrays(1, &lines->vao);
    return lines->edge_program && lines->outline_program;
}

void lines_finish(struct gl_lines *lines)
{
    render_texture_finish(&lines->mask);
    program_destroy(&lines->edge_program);
    program_destroy(&lines->outline_program);
    glDeleteVertexArrays(1, &lines->vao);
}

/* Draws lines over the resolved frame: runs a shader program that finds edges or an outline at every pixel, and blends the
   result over the picture. */
static void draw_over(const struct gl_lines *lines, const struct frame_context *context, GLuint program)
{
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, context->target->over_framebuffer);
    glDisable(GL_DEPTH_TEST);
    glDepthMask(GL_FALSE);
    glEnable(GL_BLEND);
    glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE);
    glUseProgram(program);
    glBindVertexArray(lines->vao);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glDisable(GL_BLEND);
    glDepthMask(GL_TRUE);
}

void lines_draw_edges(const struct gl_lines *lines, const struct frame_context *context)
{
    gl_pass_enter("edges");
    glBindTextureUnit(0, context->target->resolved_depth);
    draw_over(lines, context, lines->edge_program);
    gl_pass_leave(context->gpu_scene->gl, "edges");
}

double lines_outline_px(const struct view *view)
{
    return fmax(1.5, view->height_px / 600.0);
}

void lines_draw_outline(struct gl_lines *lines, const struct frame_context *context)
{
    if (!frame_shows_selected(context))
        return;
    gl_pass_enter("outline");
    if (!render_texture_fit(&lines->mask, GL_R8, GL_COLOR_ATTACHMENT0, context->target->width_px, context->target->height_px)) {
        gl_pass_leave(context->gpu_scene->gl, "outline");
        return;
    }
    glClearNamedFramebufferfv(lines->mask.framebuffer, GL_COLOR, 0, (float[4]){ 0 });
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, lines->mask.framebuffer);
    glDisable(GL_DEPTH_TEST);
    gpu_scene_draw_depth(context->gpu_scene, context->constants.clip_from_plant, &context->view->visibility.clip,
                         context->view->selected_asset, 0, true);
    glBindTextureUnit(0, lines->mask.texture);
    glProgramUniform1f(lines->outline_program, 0, (float)lines_outline_px(context->view));
    draw_over(lines, context, lines->outline_program);
    gl_pass_leave(context->gpu_scene->gl, "outline");
}
