/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws ghosted assets (assets drawn as an outline with a faint tint). Writes their depth into a separate depth buffer; a
   full-screen pass then finds the edges to draw in it. */
#include "render/gl/ghosts.h"

#include <math.h>

#include "gpu/program.h"
#include "render/matrix.h"

bool ghosts_init(struct ghosts *ghosts, struct log *log)
{
    ghosts->program = program_create(log, program_params(.vertex = "screen.vert", .fragment = "ghost.frag"));
    glCreateVertexArrays(1, &ghosts->vao);
    return ghosts->program != 0;
}

void ghosts_finish(struct ghosts *ghosts)
{
    render_texture_finish(&ghosts->depth);
    program_destroy(&ghosts->program);
    glDeleteVertexArrays(1, &ghosts->vao);
}

bool ghosts_shows(const struct frame_context *context, size_t asset)
{
    return visibility_of(&context->view->visibility, (int)asset) == ASSET_GHOST &&
           view_constants_sees(&context->constants, &context->gpu_scene->scene->assets[asset]);
}

bool ghosts_any(const struct frame_context *context)
{
    for (size_t i = 0; i < context->gpu_scene->scene->asset_count && context->view->visibility.ghosts.count > 0; i++)
        if (ghosts_shows(context, i))
            return true;
    return false;
}

static void draw_depth(const struct ghosts *ghosts, const struct frame_context *context)
{
    const struct scene *scene = context->gpu_scene->scene;
    const struct visibility *visibility = &context->view->visibility;
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, ghosts->depth.framebuffer);
    glEnable(GL_DEPTH_TEST);
    glDepthMask(GL_TRUE);
    glClear(GL_DEPTH_BUFFER_BIT);
    for (size_t i = 0; i < scene->asset_count; i++)
        if (ghosts_shows(context, i)) {
            float error_m = gpu_scene_level(context->gpu_scene, &context->constants, (int)i, 1)->error_m;
            gpu_scene_draw_depth(context->gpu_scene, context->constants.clip_from_plant, &visibility->clip, (int)i, (double)error_m, true);
        }
}

/* Finds the rectangle of the picture that the bounding boxes of the ghosts cover. A ghost is an asset that is drawn only as an outline with
   a faint tint. low, high: corners of the rectangle in normalised device coordinates (-1 to 1). */
static void find_part(const struct frame_context *context, double low[2], double high[2])
{
    const struct scene *scene = context->gpu_scene->scene;
    for (size_t i = 0; i < scene->asset_count; i++) {
        const struct scene_asset *asset = &scene->assets[i];
        if (!ghosts_shows(context, i))
            continue;
        for (int corner = 0; corner < 8; corner++) {
            double place[3], clip[4];
            for (int c = 0; c < 3; c++)
                place[c] = corner >> c & 1 ? asset->bounds_max_m[c] : asset->bounds_min_m[c];
            matrix_point(context->constants.clip_from_plant, place, clip);
            for (int c = 0; c < 2; c++) {
                /* extends the rectangle to the picture's border if a corner of the box is behind the eye, because the
                   projection of the box is unbounded there */
                low[c] = clip[3] > 0 ? fmin(low[c], clip[c] / clip[3]) : -1;
                high[c] = clip[3] > 0 ? fmax(high[c], clip[c] / clip[3]) : 1;
            }
            if (clip[3] <= 0)
                return;
        }
    }
}

/* Sets the scissor rectangle to the area that ghosts (assets drawn as outlines) may cover; rows are counted from the top. */
static void scissor(const struct frame_context *context)
{
    double low[2] = { 1, 1 }, high[2] = { -1, -1 }, width = context->target->width_px, height = context->target->height_px;
    find_part(context, low, high);
    double left = floor(fmax(0, (0.5 + 0.5 * low[0]) * width - 2)), right = ceil(fmin(width, (0.5 + 0.5 * high[0]) * width + 2));
    double top = floor(fmax(0, (0.5 - 0.5 * high[1]) * height - 2)), bottom = ceil(fmin(height, (0.5 - 0.5 * low[1]) * height + 2));
    glScissor((GLint)left, (GLint)top, (GLsizei)fmax(right - left, 0), (GLsizei)fmax(bottom - top, 0));
    glEnable(GL_SCISSOR_TEST);
}

void ghosts_draw(struct ghosts *ghosts, const struct frame_context *context)
{
    if (!ghosts_any(context))
        return;
    gl_pass_enter("ghosts");
    if (!render_texture_fit(&ghosts->depth, GL_DEPTH_COMPONENT32F, GL_DEPTH_ATTACHMENT, context->target->width_px,
                            context->target->height_px)) {
        gl_pass_leave(context->gpu_scene->gl, "ghosts");
        return;
    }
    scissor(context);
    draw_depth(ghosts, context);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, context->target->over_framebuffer);
    glDisable(GL_DEPTH_TEST);
    glDepthMask(GL_FALSE);
    glEnable(GL_BLEND);
    glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE);
    glBindTextureUnit(0, ghosts->depth.texture);
    glBindTextureUnit(1, context->target->resolved_depth);
    glUseProgram(ghosts->program);
    glBindVertexArray(ghosts->vao);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glDisable(GL_SCISSOR_TEST);
    glDisable(GL_BLEND);
    glDepthMask(GL_TRUE);
    gl_pass_leave(context->gpu_scene->gl, "ghosts");
}
