/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws the sky as one triangle at the far plane, and the ground as one square. */
#include "render/light/sky.h"

#include <math.h>

#include "base/mem.h"
#include "gpu/program.h"
#include "render/matrix.h"

/* Returns one channel of the backdrop's colour (sRGB) at an elevation, from -1 (straight down) to 1 (straight up). The colours
   vary little and are bright, to suit an operator's screen. */
static double backdrop(double height, bool dark, int channel)
{
    static const double zenith[2][3] = { { 0.757, 0.816, 0.870 }, { 0.090, 0.110, 0.135 } };
    static const double horizon[2][3] = { { 0.957, 0.963, 0.967 }, { 0.235, 0.255, 0.275 } };
    static const double nadir[2][3] = { { 0.866, 0.874, 0.880 }, { 0.165, 0.178, 0.190 } };
    double end = height > 0 ? zenith[dark][channel] : nadir[dark][channel], from = horizon[dark][channel];
    return from + (end - from) * pow(fmin(height > 0 ? height : -1.6 * height, 1), 0.65);
}

/* Fills the table of backdrop colours. Each row has a different dither offset, one for each pixel of a 4x4 square, so that slow
   gradients show no banding. */
static void make_backdrops(struct sky *sky)
{
    static const int bayer[SKY_ROUNDINGS] = { 0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5 };
    sky->texels = mem_array(SKY_ROWS, sizeof(*sky->texels));
    for (int i = 0; i < 2 * SKY_BACKDROPS; i++) {
        int dark = i / SKY_BACKDROPS, column = i % SKY_BACKDROPS;
        double bgr[3];
        for (int c = 0; c < 3; c++)
            bgr[c] = 255 * backdrop((column - 1024) / 1023.5, dark, 2 - c);
        for (int rounding = 0; rounding < SKY_ROUNDINGS; rounding++) {
            uint32_t color = 0xff000000;
            for (int c = 0; c < 3; c++)
                color |= (uint32_t)(bgr[c] + (bayer[rounding] + 0.5) / SKY_ROUNDINGS) << (8 * c);
            sky->texels[dark * SKY_ROUNDINGS + rounding][column] = color;
        }
    }
    glCreateTextures(GL_TEXTURE_2D, 1, &sky->backdrops);
    glTextureStorage2D(sky->backdrops, 1, GL_RGBA8, SKY_BACKDROPS, SKY_ROWS);
    glTextureParameteri(sky->backdrops, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTextureSubImage2D(sky->backdrops, 0, 0, 0, SKY_BACKDROPS, SKY_ROWS, GL_BGRA, GL_UNSIGNED_BYTE, sky->texels);
}

bool sky_init(struct sky *sky, struct log *log)
{
    glCreateVertexArrays(1, &sky->vao);
    sky->sky_program = program_create(log, program_params(.vertex = "sky.vert", .fragment = "sky.frag"));
    for (int tier = 0; tier < 2; tier++)
        sky->ground_programs[tier] = program_create(log, program_params(.vertex = "ground.vert", .fragment = "ground.frag",
                                                                        .defines = tier == TIER_REFINED ? "#define REFINED\n" : NULL));
    make_backdrops(sky);
    return sky->sky_program && sky->ground_programs[0] && sky->ground_programs[1];
}

void sky_finish(struct sky *sky)
{
    program_destroy(&sky->sky_program);
    program_destroy(&sky->ground_programs[0]);
    program_destroy(&sky->ground_programs[1]);
    glDeleteTextures(1, &sky->backdrops);
    mem_free(sky->texels);
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
    /* clamps depth instead of clipping: the ground may lie beyond the far plane, which encloses the plant only */
    glEnable(GL_DEPTH_CLAMP);
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
