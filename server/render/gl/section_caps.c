/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws section caps. Counts, for each pixel, how many closed bodies contain the point where the view ray meets the section
   plane, and draws the plane where there is a body. */
#include "render/gl/section_caps.h"

#include "gpu/program.h"
#include "render/matrix.h"
#include "render/gl/surface_pass.h"

/* maximum number of pixels of a frame whose caps are supersampled (several texels per pixel); larger frames use one texel per pixel */
enum { MAX_SUPERSAMPLED_PIXELS = 4 * 1024 * 1024 };

bool section_caps_init(struct section_caps *caps, struct log *log)
{
    caps->count_program = program_create(log, program_params(.vertex = "section_cap.vert", .fragment = "section_cap_count.frag",
                                                             .defines = "#define CLIP\n"));
    caps->color_program = program_create(log, program_params(.vertex = "screen.vert", .fragment = "section_cap.frag"));
    caps->depth_program =
        program_create(log, program_params(.vertex = "screen.vert", .fragment = "section_cap.frag", .defines = "#define DEPTH\n"));
    glCreateVertexArrays(1, &caps->vao);
    return caps->count_program && caps->color_program && caps->depth_program;
}

void section_caps_finish(struct section_caps *caps)
{
    render_texture_finish(&caps->bodies);
    model_draws_finish(&caps->draws);
    program_destroy(&caps->count_program);
    program_destroy(&caps->color_program);
    program_destroy(&caps->depth_program);
    glDeleteVertexArrays(1, &caps->vao);
}

static bool is_cut(const struct frame_context *context, int asset)
{
    const struct scene_asset *at = &context->gpu_scene->scene->assets[asset];
    return clip_touches(&context->view->visibility.clip, at->bounds_min_m, at->bounds_max_m);
}

static void count_asset(struct section_caps *caps, const struct frame_context *context, int asset)
{
    const struct gl_model *model = context->gpu_scene->of_asset[asset];
    const struct scene_asset *at = &context->gpu_scene->scene->assets[asset];
    double clip_from_file[16];
    float matrix[16];
    matrix_multiply(context->constants.clip_from_plant, at->placement, clip_from_file);
    matrix_to_float(clip_from_file, matrix);
    glUniformMatrix4fv(0, 1, GL_FALSE, matrix);
    gpu_scene_set_front_face(at);
    mesh_bind(&model->mesh);
    model_draw_closed(&caps->draws, model, frame_level(context, asset));
}

/* Sets up clipping with section planes, for counting bodies along view rays. Clips at planes through which rays enter the
   visible side. Does not clip at planes through which rays leave the visible side: a ray that leaves a body beyond such a plane
   was inside the body at the plane. The sign of a plane's depth coefficient in clip space tells whether rays enter or leave,
   for all pixels alike. A plane through the eye is ignored. */
static void clip_entries(const struct frame_context *context)
{
    const struct clip *clip = &context->view->visibility.clip;
    double plant_from_clip[16], plane[4];
    float in_clip[4];
    matrix_invert(context->constants.clip_from_plant, plant_from_clip);
    for (int i = 0; i < clip->plane_count; i++) {
        clip_plane(clip, i, plane);
        matrix_plane(plant_from_clip, plane, in_clip);
        if (in_clip[2] < 0)
            glEnable(GL_CLIP_DISTANCE0 + (GLenum)i);
    }
}

/* Counts, into a texture, the closed bodies that contain the point where each pixel's view ray meets the section plane. Returns
   the number of texels along a pixel's side; 0: no memory for the texture. */
static int count_bodies(struct section_caps *caps, const struct frame_context *context)
{
    const struct target *target = context->target;
    const struct clip *clip = &context->view->visibility.clip;
    int texels = target->samples > 1 && target->width_px * target->height_px <= MAX_SUPERSAMPLED_PIXELS ? 2 : 1;
    if (!render_texture_fit(&caps->bodies, GL_R16F, GL_COLOR_ATTACHMENT0, target->width_px * texels, target->height_px * texels))
        return 0;
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, caps->bodies.framebuffer);
    glViewport(0, 0, target->width_px * texels, target->height_px * texels);
    glClearBufferfv(GL_COLOR, 0, (float[4]){ 0 });
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE);
    glUseProgram(caps->count_program);
    clip_entries(context);
    for (size_t i = 0; i < context->visible_count; i++)
        if (is_cut(context, context->visible[i]))
            count_asset(caps, context, context->visible[i]);
    gpu_scene_clip_end(clip);
    glViewport(0, 0, target->width_px, target->height_px);
    return texels;
}

static void draw_planes(const struct section_caps *caps, const struct frame_context *context, int texels)
{
    glBindTextureUnit(0, caps->bodies.texture);
    glBindVertexArray(caps->vao);
    glProgramUniform1i(caps->color_program, 0, texels);
    glProgramUniform1i(caps->depth_program, 0, texels);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, context->target->over_framebuffer);
    glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE);
    glUseProgram(caps->color_program);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glDisable(GL_BLEND);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, context->target->resolved_framebuffer);
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    glEnable(GL_DEPTH_TEST);
    glDepthMask(GL_TRUE);
    glDepthFunc(GL_ALWAYS);
    glUseProgram(caps->depth_program);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glDepthFunc(GL_GEQUAL);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
}

void section_caps_draw(struct section_caps *caps, const struct frame_context *context)
{
    bool any = false;
    for (size_t i = 0; i < context->visible_count && !any; i++)
        any = is_cut(context, context->visible[i]);
    if (!any)
        return;
    gl_pass_enter("caps");
    int texels = count_bodies(caps, context);
    if (texels > 0)
        draw_planes(caps, context, texels);
    gl_pass_leave(context->gpu_scene->gl, "caps");
}
