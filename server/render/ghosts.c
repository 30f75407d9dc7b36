/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Ghosts have a depth buffer of their own; what is drawn is found in it. */
#include "render/ghosts.h"

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
    layer_finish(&ghosts->depth);
    program_destroy(&ghosts->program);
    glDeleteVertexArrays(1, &ghosts->vao);
}

static bool any_ghost(const struct picture *picture)
{
    const struct scene *scene = picture->stage->scene;
    const struct visibility *visibility = &picture->view->visibility;
    for (size_t i = 0; i < scene->asset_count && visibility->ghosts.count > 0; i++)
        if (visibility_of(visibility, (int)i) == ASSET_GHOST && shot_sees(&picture->shot, &scene->assets[i]))
            return true;
    return false;
}

static void draw_depth(const struct ghosts *ghosts, const struct picture *picture)
{
    const struct scene *scene = picture->stage->scene;
    const struct visibility *visibility = &picture->view->visibility;
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, ghosts->depth.framebuffer);
    glEnable(GL_DEPTH_TEST);
    glDepthMask(GL_TRUE);
    glClear(GL_DEPTH_BUFFER_BIT);
    for (size_t i = 0; i < scene->asset_count; i++)
        if (visibility_of(visibility, (int)i) == ASSET_GHOST && shot_sees(&picture->shot, &scene->assets[i])) {
            float error_m = stage_level(picture->stage, &picture->shot, (int)i, 1)->error_m;
            stage_draw_depth(picture->stage, picture->shot.clip_from_plant, &visibility->clip, (int)i, (double)error_m, true);
        }
}

/* Where ghosts may be: low and high corner, -1 to 1 over the picture. */
static void find_part(const struct picture *picture, double low[2], double high[2])
{
    const struct scene *scene = picture->stage->scene;
    for (size_t i = 0; i < scene->asset_count; i++) {
        const struct scene_asset *asset = &scene->assets[i];
        if (visibility_of(&picture->view->visibility, (int)i) != ASSET_GHOST || !shot_sees(&picture->shot, asset))
            continue;
        for (int corner = 0; corner < 8; corner++) {
            double place[3], clip[4];
            for (int c = 0; c < 3; c++)
                place[c] = corner >> c & 1 ? asset->bounds_max_m[c] : asset->bounds_min_m[c];
            matrix_point(picture->shot.clip_from_plant, place, clip);
            for (int c = 0; c < 2; c++) {
                low[c] = clip[3] > 0 ? fmin(low[c], clip[c] / clip[3]) : -1; /* behind the eye: anywhere */
                high[c] = clip[3] > 0 ? fmax(high[c], clip[c] / clip[3]) : 1;
            }
            if (clip[3] <= 0)
                return;
        }
    }
}

/* Rows from the top. */
static void scissor(const struct picture *picture)
{
    double low[2] = { 1, 1 }, high[2] = { -1, -1 }, width = picture->target->width_px, height = picture->target->height_px;
    find_part(picture, low, high);
    double left = floor(fmax(0, (0.5 + 0.5 * low[0]) * width - 2)), right = ceil(fmin(width, (0.5 + 0.5 * high[0]) * width + 2));
    double top = floor(fmax(0, (0.5 - 0.5 * high[1]) * height - 2)), bottom = ceil(fmin(height, (0.5 - 0.5 * low[1]) * height + 2));
    glScissor((GLint)left, (GLint)top, (GLsizei)fmax(right - left, 0), (GLsizei)fmax(bottom - top, 0));
    glEnable(GL_SCISSOR_TEST);
}

void ghosts_draw(struct ghosts *ghosts, const struct picture *picture)
{
    if (!any_ghost(picture))
        return;
    gl_pass_enter("ghosts");
    if (!layer_fit(&ghosts->depth, GL_DEPTH_COMPONENT32F, GL_DEPTH_ATTACHMENT, picture->target->width_px, picture->target->height_px)) {
        gl_pass_leave(picture->stage->gl, "ghosts");
        return;
    }
    scissor(picture);
    draw_depth(ghosts, picture);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, picture->target->over_framebuffer);
    glDisable(GL_DEPTH_TEST);
    glDepthMask(GL_FALSE);
    glEnable(GL_BLEND);
    glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE);
    glBindTextureUnit(0, ghosts->depth.texture);
    glBindTextureUnit(1, picture->target->resolved_depth);
    glUseProgram(ghosts->program);
    glBindVertexArray(ghosts->vao);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glDisable(GL_SCISSOR_TEST);
    glDisable(GL_BLEND);
    glDepthMask(GL_TRUE);
    gl_pass_leave(picture->stage->gl, "ghosts");
}
