/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fills the uniform block of shaders/frame.glsl, which all draw calls of a frame share. */
#include "render/gl/frame_uniforms.h"

#include <math.h>
#include <string.h>

#include "render/light/sky.h"
#include "render/matrix.h"

/* Returns the period in pixels of the patterns for no data (hatch) and for uncertain values (stipple). */
static double pattern_px(const struct view *view)
{
    return fmax(PATTERN_LEAST_PX, view->height_px / (double)PATTERN_PERIODS);
}

/* Returns the width in pixels with which isolines are drawn. */
static double line_px(const struct view *view)
{
    return fmax(1.2, view->height_px / 640.0);
}

static void from_eye(const double from_plant[16], const double eye_m[3], float out[16])
{
    double plant_from_eye[16];
    matrix_translation(eye_m, plant_from_eye);
    matrix_multiply(from_plant, plant_from_eye, plant_from_eye);
    matrix_to_float(plant_from_eye, out);
}

static void fill_scale(struct frame_uniforms *block, const struct frame_context *context)
{
    const struct view *view = context->view;
    struct scale scale;
    view_scale(context->gpu_scene->scene->plant, view, &scale);
    double low = scale.log ? log2(scale.min) : scale.min, high = scale.log ? log2(scale.max) : scale.max;
    block->scale[0] = (float)low;
    block->scale[1] = (float)(1 / (high - low));
    block->scale[2] = scale.log;
    block->scale[3] = (float)pattern_px(view);
    block->lines[0] = context->colormap.lines ? (float)line_px(view) : 0;
    block->lines[1] = view->dark ? SKY_ROUNDINGS : 0;
    block->lines[2] = block->lines[3] = 0;
}

/* Sets block->shade, which maps a surface's brightness to a row of the shaded colour map. Only the view's default look (shading
   style) lets light change colours; with any other look, the result is always the middle row. */
static void fill_shade(struct frame_uniforms *block, const struct view *view)
{
    /* limits of a surface's brightness that the first and the last row of the shaded colour map represent; darker or brighter
       surfaces use these rows */
    static const double dark = 0.14, bright = 0.86;
    double rows = COLORMAP_ROWS - 1;
    bool shaded = view->look == LOOK_DEFAULT;
    block->shade[0] = shaded ? (float)(rows / (bright - dark)) : 0;
    block->shade[1] = shaded ? (float)(0.5 - dark * rows / (bright - dark)) : (float)(0.5 + rows / 2);
    block->shade[2] = (float)rows + 0.5f;
    block->shade[3] = 0;
}

static void fill_clip(struct frame_uniforms *block, const struct frame_context *context)
{
    const struct clip *clip = &context->view->visibility.clip;
    double plant_from_clip[16];
    memset(block->clip, 0, sizeof(block->clip));
    if (clip->plane_count == 0)
        return;
    matrix_invert(context->constants.clip_from_plant, plant_from_clip);
    for (int i = 0; i < clip->plane_count; i++) {
        double plane[4];
        clip_plane(clip, i, plane);
        matrix_plane(plant_from_clip, plane, block->clip[i]);
    }
}

/* factor for the brightness of assets that show no field, if the backdrop is dark: large pale floors would glare at full
   brightness */
static const float DIM_CONTEXT = 0.55f;

void frame_uniforms_fill(struct frame_uniforms *block, const struct frame_context *context)
{
    const struct view *view = context->view;
    const struct view_constants *constants = &context->constants;
    double inverse[16];
    matrix_to_float(constants->clip_from_eye, block->clip_from_eye);
    matrix_invert(constants->clip_from_eye, inverse);
    matrix_to_float(inverse, block->eye_from_clip);
    from_eye(context->light->texture_from_plant, constants->eye_m, block->sun_from_eye);
    for (int i = 0; i < 3; i++) {
        block->sun[i] = (float)context->lit_by.towards[i];
        block->up[i] = (float)context->gpu_scene->up[i];
        block->back[i] = (float)constants->back[i];
    }
    block->sun[3] = (float)context->light->texel_m;
    block->up[3] = view->look == LOOK_MATERIALS ? 0 : view->dark ? DIM_CONTEXT : 1;
    fill_clip(block, context);
    block->back[3] = (float)constants->depth_scale;
    fill_scale(block, context);
    fill_shade(block, view);
}
