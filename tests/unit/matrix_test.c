/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Matrices of the renderer compared with their mathematical definitions. */
#include "tests/support/test.h"

#include "render/matrix.h"

static double any(void)
{
    return 2.0 * rand() / RAND_MAX - 1;
}

static void any_matrix(double m[16])
{
    for (int i = 0; i < 16; i++)
        m[i] = any() + 2 * (i % 5 == 0);
}

static void assert_close(const double *a, const double *b, int count, double tolerance)
{
    for (int i = 0; i < count; i++)
        assert_true(fabs(a[i] - b[i]) <= tolerance);
}

TEST(test_inverse_undoes)
{
    srand(1);
    for (int round = 0; round < 200; round++) {
        double m[16], inverse[16], product[16], identity[16];
        any_matrix(m);
        matrix_invert(m, inverse);
        matrix_multiply(m, inverse, product);
        matrix_identity(identity);
        assert_close(product, identity, 16, 1e-9);
    }
}

TEST(test_product_is_one_after_the_other)
{
    double a[16], b[16], both[16], p[3] = { 0.3, -2, 5 }, first[4], second[4], at_once[4];
    any_matrix(a);
    any_matrix(b);
    b[3] = b[7] = b[11] = 0;
    b[15] = 1;
    matrix_multiply(a, b, both);
    matrix_point(b, p, first);
    matrix_point(a, first, second);
    matrix_point(both, p, at_once);
    assert_close(second, at_once, 4, 1e-12);
    matrix_multiply(a, b, a);
    assert_close(a, both, 16, 0);
}

/* A transformed normal must be perpendicular to the transformed tangents and face outwards, also with a mirroring transform. */
TEST(test_normals_stay_normal)
{
    for (int round = 0; round < 100; round++) {
        double m[16], u[3] = { any(), any(), any() }, v[3] = { any(), any(), any() }, turned_u[3], turned_v[3];
        any_matrix(m);
        float normals[9],
            n[3] = { (float)(u[1] * v[2] - u[2] * v[1]), (float)(u[2] * v[0] - u[0] * v[2]), (float)(u[0] * v[1] - u[1] * v[0]) };
        double dot_u = 0, dot_v = 0, outward = 0;
        matrix_normals(m, normals);
        for (int r = 0; r < 3; r++) {
            turned_u[r] = m[r] * u[0] + m[4 + r] * u[1] + m[8 + r] * u[2];
            turned_v[r] = m[r] * v[0] + m[4 + r] * v[1] + m[8 + r] * v[2];
            double turned_n = normals[r] * n[0] + normals[3 + r] * n[1] + normals[6 + r] * n[2];
            double carried_n = m[r] * n[0] + m[4 + r] * n[1] + m[8 + r] * n[2];
            dot_u += turned_n * turned_u[r];
            dot_v += turned_n * turned_v[r];
            outward += turned_n * carried_n;
        }
        assert_true(fabs(dot_u) < 1e-4 && fabs(dot_v) < 1e-4 && outward > 0);
    }
}

TEST(test_parallel_view)
{
    double center[3] = { 5, -3, 2 }, towards[3] = { 0.6, 0, 0.8 }, clip[16], texture[16], out[4];
    matrix_parallel(center, 10, towards, clip);
    matrix_point(clip, center, out);
    assert_close(out, (double[]){ 0, 0, 0.5, 1 }, 4, 1e-12);
    matrix_point(clip, (double[]){ 11, -3, 10 }, out); /* 10 m towards the light */
    assert_close(out, (double[]){ 0, 0, 1, 1 }, 4, 1e-12);
    matrix_texture_from_clip(clip, texture);
    matrix_point(texture, center, out);
    assert_close(out, (double[]){ 0.5, 0.5, 0.5, 1 }, 4, 1e-12);
    /* light from straight above: the view direction is parallel to the usual up vector */
    matrix_parallel(center, 10, (double[]){ 0, 0, 1 }, clip);
    matrix_point(clip, (double[]){ 5, -3, 12 }, out);
    assert_close(out, (double[]){ 0, 0, 1, 1 }, 4, 1e-12);
}
