/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fills the uniforms that a whole picture shares. */
#include "render/frame_block.h"

#include <math.h>

#include "render/matrix.h"

double frame_block_pattern_px(const struct view *view)
{
    return fmax(6, view->height_px / 90.0);
}

static void from_eye(const double from_plant[16], const double eye_m[3], float out[16])
{
    double plant_from_eye[16];
    matrix_translation(eye_m, plant_from_eye);
    matrix_multiply(from_plant, plant_from_eye, plant_from_eye);
    matrix_to_float(plant_from_eye, out);
}

void frame_block_fill(struct frame_block *block, const struct picture *picture)
{
    const struct view *view = picture->view;
    const struct shot *shot = &picture->shot;
    double inverse[16], range = view->range_max - view->range_min;
    matrix_to_float(shot->clip_from_eye, block->clip_from_eye);
    matrix_invert(shot->clip_from_eye, inverse);
    matrix_to_float(inverse, block->eye_from_clip);
    from_eye(picture->light->texture_from_plant, shot->eye_m, block->sun_from_eye);
    for (int i = 0; i < 3; i++) {
        block->sun[i] = (float)view->light_dir[i];
        block->up[i] = (float)picture->stage->up[i];
    }
    block->sun[3] = (float)picture->light->texel_m;
    block->up[3] = 0;
    block->range[0] = (float)view->range_min;
    block->range[1] = (float)(1 / range);
    block->range[2] = (float)(view->ramp_interval > 0 ? view->ramp_interval / range : 0);
    block->range[3] = (float)frame_block_pattern_px(view);
    block->look[0] = (int32_t)view->look;
    block->look[1] = block->look[2] = block->look[3] = 0;
}
