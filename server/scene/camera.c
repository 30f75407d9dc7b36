/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Camera positions and matrices in double precision, since plants may be far from their origin. */
#include "scene/camera.h"

#include <math.h>
#include <string.h>

#include "base/math/vec.h"

/* ratio of the picture's size to that of the box fitted into it; above 1, so that a margin stays around the box */
#define FIT_MARGIN 1.06
#define LEAST_BOX_M 1e-4 /* side in metres of the smallest box to frame; smaller or empty boxes are framed as if they had this size */
#define LEAST_NEAR_M 1e-6
#define LEAST_HEIGHT_M 1e-5 /* smallest permitted height of an orthographic picture, in metres */

/* --- axes of the camera ----------------------------------------------------------------------------------------------------- */

struct basis {
    double right[3], up[3], forward[3];
};

/* Computes the camera's axes. Returns false if up is along the view direction. */
static bool basis_of(const double forward[3], const double up[3], struct basis *basis)
{
    double sure_up[3] = { up[0], up[1], up[2] };
    memcpy(basis->forward, forward, sizeof(basis->forward));
    if (!(vec_normalize(basis->forward) > 0) || !(vec_normalize(sure_up) > 0))
        return false;
    vec_cross(basis->forward, sure_up, basis->right);
    if (!(vec_normalize(basis->right) > 1e-6))
        return false;
    vec_cross(basis->right, basis->forward, basis->up);
    return true;
}

static bool lens_valid(const struct camera *camera)
{
    if (camera->height_m == 0)
        return camera->fov_deg >= 1 && camera->fov_deg <= 120;
    return camera->height_m >= LEAST_HEIGHT_M && camera->height_m <= PLANT_MAX_M;
}

static bool is_placed(const double v[3])
{
    return fabs(v[0]) <= PLANT_MAX_M && fabs(v[1]) <= PLANT_MAX_M && fabs(v[2]) <= PLANT_MAX_M;
}

bool camera_valid(const struct camera *camera)
{
    struct basis basis;
    double forward[3], apart_m = 0;
    if (!is_placed(camera->eye_m) || !is_placed(camera->target_m) || !is_placed(camera->up))
        return false;
    for (int i = 0; i < 3; i++) {
        forward[i] = camera->target_m[i] - camera->eye_m[i];
        apart_m += fabs(forward[i]);
    }
    return apart_m > 1e-6 && lens_valid(camera) && basis_of(forward, camera->up, &basis);
}

/* --- fitting a box ---------------------------------------------------------------------------------------------------------- */

static void corner_of(const double min_m[3], const double max_m[3], int corner, double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = corner >> i & 1 ? max_m[i] : min_m[i];
}

static void safe_box(const double min_m[3], const double max_m[3], double safe_min_m[3], double safe_max_m[3])
{
    double largest_m = 0;
    for (int i = 0; i < 3; i++)
        largest_m = fmax(largest_m, max_m[i] - min_m[i]);
    double grow_m = largest_m < LEAST_BOX_M ? LEAST_BOX_M / 2 : 0;
    for (int i = 0; i < 3; i++) {
        bool good = isfinite(min_m[i]) && isfinite(max_m[i]) && min_m[i] <= max_m[i];
        safe_min_m[i] = (good ? min_m[i] : 0) - grow_m;
        safe_max_m[i] = (good ? max_m[i] : 0) + grow_m;
    }
}

/* Data for fitting a box into a range of the picture along one of the picture's axes. from, to: ends of that range, as slopes
   (tangents) of the two planes through the eye that bound it; in an orthographic view, as positions in units of half a picture.
   low: maximum over the box's corners of `z * from - x`; high: maximum of `x - z * to`. There, x is a corner's coordinate along
   the axis, and z its coordinate along the view, both relative to the box's centre. From low and high follows the eye position
   at which both planes touch the box. */
struct clip_side {
    double from, to, low, high;
};

static void side_init(struct clip_side *side, double low, double high, double scale)
{
    double middle = (low + high) / 2, half = (high - low) / 2 / FIT_MARGIN;
    *side = (struct clip_side){ (middle - half) * scale, (middle + half) * scale, -INFINITY, -INFINITY };
}

static void side_add(struct clip_side *side, double x, double z)
{
    side->high = fmax(side->high, x - z * side->to);
    side->low = fmax(side->low, -x + z * side->from);
}

/* Returns how far the camera's eye must at least be from the centre of a box for the box to fit into the picture along one of
   the picture's axes. */
static double side_back(const struct clip_side *side)
{
    return (side->low + side->high) / (side->to - side->from);
}

/* Returns how far the camera's eye, at the distance back_m from a box, must be shifted along one axis of the picture to centre
   the box. */
static double side_shift(const struct clip_side *side, double back_m)
{
    return (side->high - side->low - back_m * (side->to + side->from)) / 2;
}

/* Places an orthographic camera so that it shows the box, whose extent around its centre is given along the picture's axes. */
static void place_parallel(struct camera *camera, const struct basis *basis, const double half_m[3], const double center_m[3],
                           double aspect, const struct camera_window *window)
{
    struct clip_side right, up;
    double right_m = 0, up_m = 0, deep_m = 0;
    for (int i = 0; i < 3; i++) {
        right_m += fabs(basis->right[i]) * half_m[i];
        up_m += fabs(basis->up[i]) * half_m[i];
        deep_m += fabs(basis->forward[i]) * half_m[i];
    }
    side_init(&right, window->left, window->right, aspect);
    side_init(&up, window->bottom, window->top, 1);
    right.low = right.high = right_m;
    up.low = up.high = up_m;
    camera->height_m = fmax(2 * fmax(side_back(&up), side_back(&right)), LEAST_HEIGHT_M);
    double sideways_m = side_shift(&right, camera->height_m / 2), upwards_m = side_shift(&up, camera->height_m / 2);
    for (int i = 0; i < 3; i++) {
        camera->target_m[i] = center_m[i] + sideways_m * basis->right[i] + upwards_m * basis->up[i];
        camera->eye_m[i] = camera->target_m[i] - (2 * deep_m + camera->height_m) * basis->forward[i];
    }
}

static void place_eye(struct camera *camera, const struct basis *basis, const double (*points_m)[3], size_t count, const double center_m[3],
                      double aspect, const struct camera_window *window)
{
    double t_up = tan(camera->fov_deg * M_PI / 360), nearest_m = INFINITY;
    struct clip_side right, up;
    side_init(&right, window->left, window->right, t_up * aspect);
    side_init(&up, window->bottom, window->top, t_up);
    for (size_t n = 0; n < count; n++) {
        double p[3];
        for (int i = 0; i < 3; i++)
            p[i] = points_m[n][i] - center_m[i];
        double z = vec_dot(p, basis->forward);
        nearest_m = fmin(nearest_m, z);
        side_add(&right, vec_dot(p, basis->right), z);
        side_add(&up, vec_dot(p, basis->up), z);
    }
    double back_m = fmax(fmax(side_back(&right), side_back(&up)), -nearest_m * 1.001);
    double sideways_m = side_shift(&right, back_m), upwards_m = side_shift(&up, back_m);
    for (int i = 0; i < 3; i++) {
        camera->target_m[i] = center_m[i] + sideways_m * basis->right[i] + upwards_m * basis->up[i];
        camera->eye_m[i] = camera->target_m[i] - back_m * basis->forward[i];
    }
}

static const struct camera_window whole = { -1, 1, -1, 1 };

static const struct camera_window *window_of(const struct camera_window *window)
{
    return window->left < window->right && window->bottom < window->top ? window : &whole;
}

void camera_fit_along(struct camera *camera, const double forward[3], const double min_m[3], const double max_m[3], double aspect,
                      const struct camera_window *window)
{
    double safe_min_m[3], safe_max_m[3], center_m[3], half_m[3], corners_m[8][3];
    struct basis basis;
    basis_of(forward, camera->up, &basis);
    safe_box(min_m, max_m, safe_min_m, safe_max_m);
    for (int i = 0; i < 3; i++) {
        center_m[i] = (safe_min_m[i] + safe_max_m[i]) / 2;
        half_m[i] = (safe_max_m[i] - safe_min_m[i]) / 2;
    }
    for (int corner = 0; corner < 8; corner++)
        corner_of(safe_min_m, safe_max_m, corner, corners_m[corner]);
    if (camera->height_m > 0)
        place_parallel(camera, &basis, half_m, center_m, aspect, window_of(window));
    else
        place_eye(camera, &basis, (const double(*)[3])corners_m, 8, center_m, aspect, window_of(window));
}

void camera_fit_points(struct camera *camera, const double forward[3], const double (*points_m)[3], size_t count, double aspect,
                       const struct camera_window *window)
{
    double min_m[3], max_m[3], center_m[3], largest_m = 0;
    struct basis basis;
    for (int i = 0; i < 3; i++) {
        min_m[i] = max_m[i] = points_m[0][i];
        for (size_t n = 1; n < count; n++) {
            min_m[i] = fmin(min_m[i], points_m[n][i]);
            max_m[i] = fmax(max_m[i], points_m[n][i]);
        }
        center_m[i] = (min_m[i] + max_m[i]) / 2;
        largest_m = fmax(largest_m, max_m[i] - min_m[i]);
    }
    if (camera->height_m > 0 || largest_m < LEAST_BOX_M) {
        camera_fit_along(camera, forward, min_m, max_m, aspect, window);
        return;
    }
    basis_of(forward, camera->up, &basis);
    place_eye(camera, &basis, points_m, count, center_m, aspect, window_of(window));
}

void camera_fit_up(struct camera *camera, enum axis up, const double min_m[3], const double max_m[3], double aspect)
{
    static const double forward[2][3] = { [AXIS_Z] = { 0.62, 0.68, -0.42 }, [AXIS_Y] = { 0.62, -0.42, -0.68 } };
    *camera = (struct camera){ .up = { 0, up == AXIS_Y, up == AXIS_Z }, .fov_deg = 45 };
    camera_fit_along(camera, forward[up], min_m, max_m, aspect, &(struct camera_window){ 0 });
}

/* --- matrices --------------------------------------------------------------------------------------------------------------- */

static void depth_range(const struct camera *camera, const struct basis *basis, const double min_m[3], const double max_m[3],
                        double *near_m, double *far_m)
{
    double nearest = INFINITY, farthest = -INFINITY;
    for (int corner = 0; corner < 8; corner++) {
        double p[3];
        corner_of(min_m, max_m, corner, p);
        for (int i = 0; i < 3; i++)
            p[i] -= camera->eye_m[i];
        double z = vec_dot(p, basis->forward);
        nearest = fmin(nearest, z);
        farthest = fmax(farthest, z);
    }
    if (camera->height_m > 0) {
        double margin_m = 0.001 * (farthest - nearest) + LEAST_NEAR_M;
        *near_m = nearest - margin_m;
        *far_m = farthest + margin_m;
        return;
    }
    /* a box entirely behind the camera is invisible, so any valid depth range will do */
    *far_m = fmax(farthest * 1.001, 2 * LEAST_NEAR_M);
    *near_m = fmax(fmax(nearest * 0.999, *far_m * CAMERA_NEAR_TO_FAR), LEAST_NEAR_M);
    if (*near_m >= *far_m) /* the box has no depth */
        *near_m = *far_m / 2;
}

static void camera_look(const struct camera *camera, struct basis *basis)
{
    double forward[3];
    for (int i = 0; i < 3; i++)
        forward[i] = camera->target_m[i] - camera->eye_m[i];
    /* camera_valid() rejects a camera whose `up` is along the view direction; here the view to the north replaces it, so that
       the numbers stay finite */
    if (!basis_of(forward, camera->up, basis))
        basis_of((double[]){ 0, 1, 0 }, (double[]){ 0, 0, 1 }, basis);
}

void camera_basis(const struct camera *camera, double right[3], double up[3], double forward[3])
{
    struct basis basis;
    camera_look(camera, &basis);
    memcpy(right, basis.right, sizeof(basis.right));
    memcpy(up, basis.up, sizeof(basis.up));
    memcpy(forward, basis.forward, sizeof(basis.forward));
}

double camera_parallel_m(const struct camera *camera)
{
    return 1.2 * camera->height_m;
}

void camera_matrices(const struct camera *camera, double aspect, const double min_m[3], const double max_m[3], double view[16],
                     double projection[16])
{
    struct basis basis;
    double near_m, far_m;
    camera_look(camera, &basis);
    depth_range(camera, &basis, min_m, max_m, &near_m, &far_m);
    for (int i = 0; i < 3; i++) {
        view[i * 4] = basis.right[i];
        view[i * 4 + 1] = basis.up[i];
        view[i * 4 + 2] = -basis.forward[i];
        view[i * 4 + 3] = 0;
    }
    view[12] = -vec_dot(basis.right, camera->eye_m);
    view[13] = -vec_dot(basis.up, camera->eye_m);
    view[14] = vec_dot(basis.forward, camera->eye_m);
    view[15] = 1;
    memset(projection, 0, 16 * sizeof(*projection));
    if (camera->height_m > 0) {
        projection[0] = 2 / (camera->height_m * aspect);
        projection[5] = 2 / camera->height_m;
        projection[10] = -2 / (far_m - near_m);
        projection[14] = -(far_m + near_m) / (far_m - near_m);
        projection[15] = 1;
        return;
    }
    double f = 1 / tan(camera->fov_deg * M_PI / 360);
    projection[0] = f / aspect;
    projection[5] = f;
    projection[10] = (far_m + near_m) / (near_m - far_m);
    projection[11] = -1;
    projection[14] = 2 * far_m * near_m / (near_m - far_m);
}
