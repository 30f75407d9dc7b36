/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Counts the bodies that each pixel's ray is in where it passes the cut, and draws planes there. */
#include "render/caps.h"

#include "base/mem.h"
#include "gpu/program.h"
#include "render/matrix.h"
#include "render/solid.h"

enum { MOST_PIXELS = 4 * 1024 * 1024 }; /* with several texels each */

bool caps_init(struct caps *caps, struct log *log)
{
    caps->count_program =
        program_create(log, program_params(.vertex = "cap.vert", .fragment = "cap_count.frag", .defines = "#define CLIP\n"));
    caps->color_program = program_create(log, program_params(.vertex = "screen.vert", .fragment = "cap.frag"));
    caps->depth_program =
        program_create(log, program_params(.vertex = "screen.vert", .fragment = "cap.frag", .defines = "#define DEPTH\n"));
    glCreateVertexArrays(1, &caps->vao);
    return caps->count_program && caps->color_program && caps->depth_program;
}

void caps_finish(struct caps *caps)
{
    layer_finish(&caps->bodies);
    model_draws_finish(&caps->draws);
    program_destroy(&caps->count_program);
    program_destroy(&caps->color_program);
    program_destroy(&caps->depth_program);
    glDeleteVertexArrays(1, &caps->vao);
}

static bool is_cut(const struct picture *picture, int asset)
{
    const struct scene_asset *at = &picture->stage->scene->assets[asset];
    return clip_touches(&picture->view->visibility.clip, at->bounds_min_m, at->bounds_max_m);
}

static void count_asset(struct caps *caps, const struct picture *picture, int asset)
{
    const struct model *model = picture->stage->of_asset[asset];
    const struct scene_asset *at = &picture->stage->scene->assets[asset];
    double clip_from_file[16];
    float matrix[16];
    matrix_multiply(picture->shot.clip_from_plant, at->placement, clip_from_file);
    matrix_to_float(clip_from_file, matrix);
    glUniformMatrix4fv(0, 1, GL_FALSE, matrix);
    stage_set_front_face(at);
    mesh_bind(&model->mesh);
    model_draw_closed(&caps->draws, model, solid_level(picture, asset));
}

/* Cuts by the planes that rays come in by. What lies beyond the way out of what is left is met, too: a ray that leaves a body there was in
   it. In clip space a plane is come in by everywhere or nowhere, by how it rises with depth; neither, where it holds the eye. */
static void clip_entries(const struct picture *picture)
{
    const struct clip *clip = &picture->view->visibility.clip;
    double plant_from_clip[16], plane[4];
    float in_clip[4];
    matrix_invert(picture->shot.clip_from_plant, plant_from_clip);
    for (int i = 0; i < clip->plane_count; i++) {
        clip_plane(clip, i, plane);
        matrix_plane(plant_from_clip, plane, in_clip);
        if (in_clip[2] < 0)
            glEnable(GL_CLIP_DISTANCE0 + (GLenum)i);
    }
}

/* Returns how many texels there are to a pixel's side; 0: no room for them. */
static int count_bodies(struct caps *caps, const struct picture *picture)
{
    const struct target *target = picture->target;
    const struct clip *clip = &picture->view->visibility.clip;
    int texels = target->samples > 1 && target->width_px * target->height_px <= MOST_PIXELS ? 2 : 1;
    if (!layer_fit(&caps->bodies, GL_R16F, GL_COLOR_ATTACHMENT0, target->width_px * texels, target->height_px * texels))
        return 0;
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, caps->bodies.framebuffer);
    glViewport(0, 0, target->width_px * texels, target->height_px * texels);
    glClearBufferfv(GL_COLOR, 0, (float[4]){ 0 });
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE);
    glUseProgram(caps->count_program);
    clip_entries(picture);
    for (size_t i = 0; i < picture->visible_count; i++)
        if (is_cut(picture, picture->visible[i]))
            count_asset(caps, picture, picture->visible[i]);
    stage_clip_end(clip);
    glViewport(0, 0, target->width_px, target->height_px);
    return texels;
}

static void draw_planes(const struct caps *caps, const struct picture *picture, int texels)
{
    glBindTextureUnit(0, caps->bodies.texture);
    glBindVertexArray(caps->vao);
    glProgramUniform1i(caps->color_program, 0, texels);
    glProgramUniform1i(caps->depth_program, 0, texels);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, picture->target->over_framebuffer);
    glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE);
    glUseProgram(caps->color_program);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glDisable(GL_BLEND);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, picture->target->resolved_framebuffer);
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    glEnable(GL_DEPTH_TEST);
    glDepthMask(GL_TRUE);
    glDepthFunc(GL_ALWAYS);
    glUseProgram(caps->depth_program);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glDepthFunc(GL_GEQUAL);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
}

void caps_draw(struct caps *caps, const struct picture *picture)
{
    bool any = false;
    for (size_t i = 0; i < picture->visible_count && !any; i++)
        any = is_cut(picture, picture->visible[i]);
    if (!any)
        return;
    gl_pass_enter("caps");
    int texels = count_bodies(caps, picture);
    if (texels > 0)
        draw_planes(caps, picture, texels);
    gl_pass_leave(picture->stage->gl, "caps");
}
