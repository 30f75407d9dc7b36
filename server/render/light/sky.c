/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One triangle at the far plane, and one square of ground. */
#include "render/light/sky.h"

#include "gpu/program.h"
#include "render/matrix.h"

static bool make_backdrops(struct sky *sky, struct log *log)
{
    GLuint program = program_create(log, program_params(.compute = "backdrop.comp"));
    if (!program)
        return false;
    glCreateTextures(GL_TEXTURE_2D, 1, &sky->backdrops);
    glTextureStorage2D(sky->backdrops, 1, GL_RGBA8, SKY_BACKDROPS, SKY_ROWS);
    glTextureParameteri(sky->backdrops, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glUseProgram(program);
    glBindImageTexture(0, sky->backdrops, 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA8);
    glDispatchCompute(SKY_BACKDROPS / 64, SKY_ROWS, 1);
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
    program_destroy(&program);
    return true;
}

bool sky_init(struct sky *sky, struct log *log)
{
    glCreateVertexArrays(1, &sky->vao);
    sky->sky_program = program_create(log, program_params(.vertex = "sky.vert", .fragment = "sky.frag"));
    for (int tier = 0; tier < 2; tier++)
        sky->ground_programs[tier] = program_create(log, program_params(.vertex = "ground.vert", .fragment = "ground.frag",
                                                                        .defines = tier == TIER_REFINED ? "#define REFINED\n" : NULL));
    return sky->sky_program && sky->ground_programs[0] && sky->ground_programs[1] && make_backdrops(sky, log);
}

void sky_finish(struct sky *sky)
{
    program_destroy(&sky->sky_program);
    program_destroy(&sky->ground_programs[0]);
    program_destroy(&sky->ground_programs[1]);
    glDeleteTextures(1, &sky->backdrops);
    glDeleteVertexArrays(1, &sky->vao);
}

static void draw_ground(const struct sky *sky, const struct frame_context *context, const struct light *light)
{
    const struct view_constants *constants = &context->constants;
    double clip_from_ground[16], eye_from_ground[16];
    float matrix[16];
    glUseProgram(sky->ground_programs[context->view->tier]);
    matrix_multiply(constants->clip_from_plant, light->plant_from_ground, clip_from_ground);
    matrix_to_float(clip_from_ground, matrix);
    glUniformMatrix4fv(0, 1, GL_FALSE, matrix);
    matrix_translation((double[3]){ -constants->eye_m[0], -constants->eye_m[1], -constants->eye_m[2] }, eye_from_ground);
    matrix_multiply(eye_from_ground, light->plant_from_ground, eye_from_ground);
    matrix_to_float(eye_from_ground, matrix);
    glUniformMatrix4fv(1, 1, GL_FALSE, matrix);
    glBindTextureUnit(1, context->light->ground);
    glBindTextureUnit(2, context->light->sun_map);
    glEnable(GL_DEPTH_CLAMP); /* the far plane only holds the plant */
    glEnable(GL_BLEND);
    glBlendFunc(GL_ZERO, GL_SRC_COLOR);
    glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
    glDisable(GL_BLEND);
    glDisable(GL_DEPTH_CLAMP);
}

bool sky_sees_ground(const struct frame_context *context, const struct light *light)
{
    const struct view_constants *constants = &context->constants;
    const struct visibility *visibility = &context->view->visibility;
    double eye_height_m = 0, back_height = 0;
    for (int i = 0; i < 3; i++) {
        eye_height_m += context->gpu_scene->up[i] * constants->eye_m[i];
        back_height += context->gpu_scene->up[i] * constants->back[i];
    }
    if (visibility->clip.plane_count + visibility->hidden.count + visibility->isolated.count + visibility->ghosts.count > 0)
        return false;
    return constants->pixel_per_metre > 0 ? back_height > 0 : eye_height_m > light->ground_height_m;
}

void sky_draw(const struct sky *sky, const struct frame_context *context, const struct light *light)
{
    gl_pass_enter("sky");
    glEnable(GL_DEPTH_TEST);
    glDepthMask(GL_FALSE);
    glUseProgram(sky->sky_program);
    glBindTextureUnit(1, sky->backdrops);
    glBindVertexArray(sky->vao);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    if (sky_sees_ground(context, light))
        draw_ground(sky, context, light);
    glDepthMask(GL_TRUE);
    gl_pass_leave(context->gpu_scene->gl, "sky");
}
