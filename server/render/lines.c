/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Edges and outlines, found in depth and in a mask. */
#include "render/lines.h"

#include <math.h>

#include "gpu/program.h"

bool lines_init(struct lines *lines, struct log *log)
{
    lines->edge_program = program_create(log, program_params(.vertex = "screen.vert", .fragment = "edges.frag"));
    lines->outline_program = program_create(log, program_params(.vertex = "screen.vert", .fragment = "outline.frag"));
    glCreateVertexArrays(1, &lines->vao);
    return lines->edge_program && lines->outline_program;
}

static void mask_finish(struct lines *lines)
{
    glDeleteFramebuffers(1, &lines->mask_framebuffer);
    glDeleteTextures(1, &lines->mask);
    lines->mask_framebuffer = lines->mask = 0;
}

void lines_finish(struct lines *lines)
{
    mask_finish(lines);
    program_destroy(&lines->edge_program);
    program_destroy(&lines->outline_program);
    glDeleteVertexArrays(1, &lines->vao);
}

/* Draws over the resolved picture, blended. */
static void draw_over(const struct lines *lines, const struct picture *picture, GLuint program)
{
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, picture->target->over_framebuffer);
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

void lines_draw_edges(const struct lines *lines, const struct picture *picture)
{
    gl_pass_enter("edges");
    glBindTextureUnit(0, picture->target->resolved_depth);
    draw_over(lines, picture, lines->edge_program);
    gl_pass_leave(picture->stage->gl, "edges");
}

static void mask_fit(struct lines *lines, int width_px, int height_px)
{
    if (lines->mask && lines->mask_width_px == width_px && lines->mask_height_px == height_px)
        return;
    mask_finish(lines);
    lines->mask_width_px = width_px;
    lines->mask_height_px = height_px;
    glCreateTextures(GL_TEXTURE_2D, 1, &lines->mask);
    glTextureStorage2D(lines->mask, 1, GL_R8, width_px, height_px);
    glTextureParameteri(lines->mask, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glCreateFramebuffers(1, &lines->mask_framebuffer);
    glNamedFramebufferTexture(lines->mask_framebuffer, GL_COLOR_ATTACHMENT0, lines->mask, 0);
}

double lines_outline_px(const struct view *view)
{
    return fmax(1.5, view->height_px / 600.0);
}

void lines_draw_outline(struct lines *lines, const struct picture *picture)
{
    int asset = picture->view->selected_asset;
    if (asset < 0 || visibility_of(&picture->view->visibility, asset) == ASSET_HIDDEN ||
        !shot_sees(&picture->shot, &picture->stage->scene->assets[asset]))
        return;
    gl_pass_enter("outline");
    mask_fit(lines, picture->target->width_px, picture->target->height_px);
    glClearNamedFramebufferfv(lines->mask_framebuffer, GL_COLOR, 0, (float[4]){ 0 });
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, lines->mask_framebuffer);
    glDisable(GL_DEPTH_TEST);
    stage_draw_depth(picture->stage, picture->shot.clip_from_plant, &picture->view->visibility.clip, asset, 0);
    glBindTextureUnit(0, lines->mask);
    glProgramUniform1f(lines->outline_program, 0, (float)lines_outline_px(picture->view));
    draw_over(lines, picture, lines->outline_program);
    gl_pass_leave(picture->stage->gl, "outline");
}
