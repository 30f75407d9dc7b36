/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cameras: which parameters they refuse, how they fit a box, and their matrices compared with a projection by hand. */
#include "scene/camera.h"

#include "tests/support/test.h"

static const struct camera good = { .eye_m = { 10, -20, 5 }, .target_m = { 1, 2, 3 }, .up = { 0, 0, 1 }, .fov_deg = 45 };

TEST(nonsense_is_refused)
{
    assert_true(camera_valid(&good));
    struct camera c = { .eye_m = { 412345, 5512345, 120 }, .target_m = { 412355, 5512345, 118 }, .up = { 0, 0, 1 }, .fov_deg = 45 };
    assert_true(camera_valid(&c)); /* coordinates of millions of metres, as in a national survey grid, are valid */
    double *const numbers[] = { &c.eye_m[0], &c.target_m[1], &c.up[2], &c.fov_deg };
    const double wrong[] = { NAN, INFINITY, -INFINITY, 2e7 };
    for (size_t i = 0; i < 4; i++)
        for (size_t k = 0; k < 4; k++) {
            c = good;
            *numbers[i] = wrong[k];
            assert_false(camera_valid(&c));
        }
    c = good;
    memcpy(c.target_m, c.eye_m, sizeof(c.eye_m));
    assert_false(camera_valid(&c));
    c = good;
    for (int i = 0; i < 3; i++)
        c.up[i] = (c.target_m[i] - c.eye_m[i]) * -3;
    assert_false(camera_valid(&c));
    c = good;
    memset(c.up, 0, sizeof(c.up));
    assert_false(camera_valid(&c));
    c = good;
    c.fov_deg = 0.5;
    assert_false(camera_valid(&c));
    c.fov_deg = 121;
    assert_false(camera_valid(&c));
    c.fov_deg = 120;
    assert_true(camera_valid(&c));
    c.fov_deg = 0;
    c.height_m = 12;
    assert_true(camera_valid(&c));
    for (size_t k = 0; k < 4; k++) {
        c.height_m = wrong[k];
        assert_false(camera_valid(&c));
    }
    c.height_m = -1;
    assert_false(camera_valid(&c));
}

static void project(const double view[16], const double projection[16], const double p[3], double ndc[3], double *w)
{
    double eye[4], clip[4];
    for (int row = 0; row < 4; row++)
        eye[row] = view[row] * p[0] + view[4 + row] * p[1] + view[8 + row] * p[2] + view[12 + row];
    for (int row = 0; row < 4; row++)
        clip[row] = projection[row] * eye[0] + projection[4 + row] * eye[1] + projection[8 + row] * eye[2] + projection[12 + row] * eye[3];
    for (int i = 0; i < 3; i++)
        ndc[i] = clip[i] / clip[3];
    *w = clip[3];
}

TEST(a_point_lands_where_geometry_says)
{
    /* The camera looks north from (0, -10, 0), so right is east and up is z. With an angle of 90 degrees, half the image's
       height equals the distance from the eye. */
    const struct camera c = { .eye_m = { 0, -10, 0 }, .target_m = { 0, 0, 0 }, .up = { 0, 0, 1 }, .fov_deg = 90 };
    const double min[3] = { -5, -5, -5 }, max[3] = { 5, 5, 5 }, p[3] = { 4, -2, 2 };
    double view[16], projection[16], ndc[3], w;
    camera_matrices(&c, 2, min, max, view, projection);
    project(view, projection, p, ndc, &w);
    assert_float_equal(w, 8, 1e-12);
    assert_float_equal(ndc[0], 4 / 8.0 / 2, 1e-12);
    assert_float_equal(ndc[1], 2 / 8.0, 1e-12);
    assert_true(ndc[2] > -1 && ndc[2] < 1);
}

/* In an orthographic projection, sizes do not depend on the distance, and points behind the eye are projected, too. */
TEST(an_orthographic_picture_keeps_sizes)
{
    const struct camera c = { .eye_m = { 0, -10, 0 }, .target_m = { 0, 0, 0 }, .up = { 0, 0, 1 }, .height_m = 8 };
    const double min[3] = { -5, -50, -5 }, max[3] = { 5, 500, 5 };
    double view[16], projection[16], last = 1;
    camera_matrices(&c, 2, min, max, view, projection);
    for (double y = -50; y <= 500; y += 25) {
        double ndc[3], w;
        project(view, projection, (double[3]){ 4, y, 2 }, ndc, &w);
        assert_float_equal(w, 1, 1e-12);
        assert_float_equal(ndc[0], 4 / 8.0, 1e-12);
        assert_float_equal(ndc[1], 2 / 4.0, 1e-12);
        assert_true(ndc[2] > -1 && ndc[2] < 1 && (y == -50 || ndc[2] > last));
        last = ndc[2];
    }
}

static void corner_of(const double min[3], const double max[3], int corner, double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = corner >> i & 1 ? max[i] : min[i];
}

static double random_in(double low, double high)
{
    return low + (high - low) * rand() / RAND_MAX;
}

TEST(near_and_far_hold_the_box)
{
    srand(1);
    for (int round = 0; round < 2000; round++) {
        double min[3], max[3], view[16], projection[16], ndc[8][3], w[8], far_m = 0;
        struct camera c = good;
        for (int i = 0; i < 3; i++) {
            min[i] = random_in(-50, 0);
            max[i] = min[i] + random_in(0, 100);
            c.eye_m[i] = random_in(-100, 100); /* random eye positions, often inside the box, where some corners lie behind the eye */
        }
        camera_matrices(&c, 1.6, min, max, view, projection);
        double far_over_near = (projection[10] - 1) / (projection[10] + 1);
        assert_true(far_over_near > 1 && far_over_near <= 1e4 * 1.001);
        for (int corner = 0; corner < 8; corner++) {
            double p[3];
            corner_of(min, max, corner, p);
            project(view, projection, p, ndc[corner], &w[corner]);
            far_m = fmax(far_m, w[corner]);
        }
        for (int corner = 0; corner < 8; corner++)
            if (w[corner] > far_m * 1.01e-4 && w[corner] > 1.01e-3)
                assert_true(fabs(ndc[corner][2]) <= 1);
    }
}

TEST(a_box_behind_or_without_depth_gives_numbers)
{
    const struct camera c = { .eye_m = { 0, 0, 0 }, .target_m = { 0, 1, 0 }, .up = { 0, 0, 1 }, .fov_deg = 45 };
    const double behind_min[3] = { -1, -9, -1 }, behind_max[3] = { 1, -8, 1 }, flat_min[3] = { -1, 5, -1 }, flat_max[3] = { 1, 5, 1 };
    double view[16], projection[16], ndc[3], w;
    camera_matrices(&c, 1, behind_min, behind_max, view, projection);
    for (int i = 0; i < 16; i++)
        assert_true(isfinite(view[i]) && isfinite(projection[i]));
    camera_matrices(&c, 1, flat_min, flat_max, view, projection);
    project(view, projection, flat_min, ndc, &w);
    assert_true(ndc[2] > -1 && ndc[2] < 1);
}

/* Fits a camera to the box. Asserts that, in at least one direction, the projected box reaches the margin on both sides, and
   that no corner lies outside of it. */
static void assert_fits(enum axis up, const double min[3], const double max[3], double aspect)
{
    struct camera c;
    double view[16], projection[16], low[2] = { 9, 9 }, high[2] = { -9, -9 };
    camera_fit_up(&c, up, min, max, aspect);
    assert_true(camera_valid(&c));
    camera_matrices(&c, aspect, min, max, view, projection);
    for (int corner = 0; corner < 8; corner++) {
        double p[3], ndc[3], w;
        corner_of(min, max, corner, p);
        project(view, projection, p, ndc, &w);
        assert_true(w > 0);
        for (int i = 0; i < 2; i++) {
            low[i] = fmin(low[i], ndc[i]);
            high[i] = fmax(high[i], ndc[i]);
        }
    }
    for (int i = 0; i < 2; i++)
        assert_true(low[i] > -0.9999 && high[i] < 0.9999);
    bool wide = high[0] > 0.93 && low[0] < -0.93, tall = high[1] > 0.93 && low[1] < -0.93;
    assert_true(wide || tall);
}

TEST(a_fit_fills_the_picture)
{
    srand(2);
    for (int round = 0; round < 2000; round++) {
        double min[3], max[3];
        for (int i = 0; i < 3; i++) {
            min[i] = random_in(-1000, 1000);
            max[i] = min[i] + random_in(0.2, round % 2 ? 5 : 300);
        }
        assert_fits(round % 3 ? AXIS_Z : AXIS_Y, min, max, random_in(0.3, 3));
    }
}

TEST(a_fit_is_from_the_raised_south_west)
{
    const double min[3] = { 0, 0, 0 }, max[3] = { 10, 10, 10 };
    struct camera c;
    camera_fit_up(&c, AXIS_Z, min, max, 1.5);
    assert_true(c.eye_m[0] < 0 && c.eye_m[1] < 0 && c.eye_m[2] > 10);
    assert_float_equal(c.up[2], 1, 0);
    camera_fit_up(&c, AXIS_Y, min, max, 1.5); /* with y up, north is -z, so south is +z */
    assert_true(c.eye_m[0] < 0 && c.eye_m[1] > 10 && c.eye_m[2] > 10);
    assert_float_equal(c.up[1], 1, 0);
}

TEST(empty_boxes_are_fitted_somehow)
{
    const double point[3] = { 3, 4, 5 }, none_min[3] = { INFINITY, INFINITY, INFINITY }, none_max[3] = { -INFINITY, -INFINITY, -INFINITY };
    struct camera c;
    camera_fit_up(&c, AXIS_Z, point, point, 1);
    assert_true(camera_valid(&c));
    camera_fit_up(&c, AXIS_Z, none_min, none_max, 1);
    assert_true(camera_valid(&c));
}
