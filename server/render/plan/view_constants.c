/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes matrices and frustum planes of a camera. */
#include "render/plan/view_constants.h"

#include <math.h>
#include <string.h>

#include "render/matrix.h"
#include "scene/coincident.h"

static void set(struct view_constants *constants, const double eye_m[3], const double clip_from_eye[16], double pixel_per_radian)
{
    double eye_from_plant[16];
    *constants = (struct view_constants){ .pixel_per_radian = pixel_per_radian };
    memcpy(constants->eye_m, eye_m, sizeof(constants->eye_m));
    memcpy(constants->clip_from_eye, clip_from_eye, sizeof(constants->clip_from_eye));
    matrix_translation((double[3]){ -eye_m[0], -eye_m[1], -eye_m[2] }, eye_from_plant);
    matrix_multiply(clip_from_eye, eye_from_plant, constants->clip_from_plant);
    const double *m = constants->clip_from_plant;
    for (int p = 0; p < 6; p++) /* clip-space planes w + x, w - x, w + y, w - y, z, w - z: all are >= 0 inside the frustum */
        for (int c = 0; c < 4; c++) {
            double row = m[4 * c + p / 2], w = m[4 * c + 3];
            constants->planes[p][c] = p == 4 ? row : p % 2 ? w - row : w + row;
        }
}

/* Computes the camera's matrices, with reversed depth (1 near, 0 far). 32-bit floats are most precise near 0, and most of the
   scene is far away. */
void view_constants_init(struct view_constants *constants, const struct view *view, const struct scene *scene)
{
    static const double reverse[16] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -0.5, 0, 0, 0, 0.5, 1 };
    double rotation[16], projection[16];
    double aspect = (double)view->width_px / view->height_px;
    double min_m[3], max_m[3];
    scene_depth_box(scene, view->camera.eye_m, min_m, max_m);
    camera_matrices(&view->camera, aspect, min_m, max_m, rotation, projection);
    double back[3] = { rotation[2], rotation[6], rotation[10] }, depth_m = -2 / projection[10];
    rotation[12] = rotation[13] = rotation[14] = 0;
    matrix_multiply(projection, rotation, projection);
    matrix_multiply(reverse, projection, projection);
    set(constants, view->camera.eye_m, projection, view->height_px / (2 * tan(view->camera.fov_deg * M_PI / 360)));
    if (view->camera.height_m > 0) {
        constants->pixel_per_metre = view->height_px / view->camera.height_m;
        constants->depth_scale = depth_m / camera_parallel_m(&view->camera);
        memcpy(constants->back, back, sizeof(back));
    }
}

void view_constants_narrow(struct view_constants *constants, const double low[2], const double high[2])
{
    const double *m = constants->clip_from_plant;
    for (int p = 0; p < 4; p++)
        for (int c = 0; c < 4; c++) {
            double row = m[4 * c + p / 2], w = m[4 * c + 3];
            constants->planes[p][c] = p % 2 ? high[p / 2] * w - row : row - low[p / 2] * w;
        }
}

bool view_constants_sees(const struct view_constants *constants, const struct scene_asset *asset)
{
    for (int p = 0; p < 6; p++) {
        /* signed distance from the frustum plane to the innermost corner of the asset's box; below 0: the whole box is outside */
        double far = constants->planes[p][3];
        for (int c = 0; c < 3; c++)
            far += constants->planes[p][c] * (constants->planes[p][c] > 0 ? asset->bounds_max_m[c] : asset->bounds_min_m[c]);
        if (far < 0)
            return false;
    }
    return true;
}

void view_constants_bring_forward(const struct view_constants *constants, const struct scene_asset *asset, double clip_from_file[16])
{
    double forward = coincident_forward(asset);
    if (constants->pixel_per_metre > 0)
        clip_from_file[14] += forward / constants->depth_scale;
    else
        for (int c = 0; c < 4; c++)
            clip_from_file[4 * c + 2] *= 1 + forward;
}
