/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Vertex normals where many faces meet at a point: they must equal the sum over all faces within the crease angle, and
   computing them for twice as many faces may take hardly more than twice as long. */
#include "tests/support/test.h"
#include <time.h>

#include "preprocess/geometry/normals.h"

#define CREASE_COSINE 0.766

struct fan { /* triangles around vertex 0 */
    float (*positions)[3];
    uint32_t *indices;
    float (*normals)[3];
    size_t count;
};

static double chance(unsigned *seed)
{
    return rand_r(seed) / (double)RAND_MAX;
}

/* Makes a fan of `count` triangles around a centre. height: of the centre above the rim; rough: largest random shift of the
   rim's points, up or down. */
static void fan_init(struct fan *fan, size_t count, double height, double rough, unsigned seed)
{
    *fan = (struct fan){ .positions = mem_array(count + 1, sizeof(*fan->positions)),
                         .indices = mem_array(3 * count, sizeof(*fan->indices)),
                         .normals = mem_array(3 * count, sizeof(*fan->normals)),
                         .count = count };
    fan->positions[0][2] = (float)height;
    for (size_t i = 0; i < count; i++) {
        double angle = 2 * M_PI * (double)i / (double)count;
        const double at[3] = { cos(angle), sin(angle), rough * chance(&seed) };
        for (int axis = 0; axis < 3; axis++)
            fan->positions[i + 1][axis] = (float)at[axis];
        fan->indices[3 * i + 1] = (uint32_t)i + 1;
        fan->indices[3 * i + 2] = (uint32_t)((i + 1) % count) + 1;
    }
}

static void fan_finish(struct fan *fan)
{
    mem_free(fan->positions);
    mem_free(fan->indices);
    mem_free(fan->normals);
}

static bool compute(struct fan *fan)
{
    return normals_compute((const float(*)[3])fan->positions, fan->count + 1, fan->indices, 3 * fan->count, fan->normals);
}

static void unit(double v[3])
{
    double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int i = 0; i < 3; i++)
        v[i] /= length;
}

static void face_of(const struct fan *fan, size_t tri, double normal[3], double *angle)
{
    double side[2][3];
    for (int s = 0; s < 2; s++)
        for (int i = 0; i < 3; i++)
            side[s][i] = (double)fan->positions[fan->indices[3 * tri + 1 + (size_t)s]][i] - (double)fan->positions[0][i];
    for (int i = 0; i < 3; i++)
        normal[i] = side[0][(i + 1) % 3] * side[1][(i + 2) % 3] - side[0][(i + 2) % 3] * side[1][(i + 1) % 3];
    unit(normal);
    unit(side[0]);
    unit(side[1]);
    *angle = acos(fmin(side[0][0] * side[1][0] + side[0][1] * side[1][1] + side[0][2] * side[1][2], 1));
}

static void assert_plain_sum(const struct fan *fan)
{
    double(*faces)[3] = mem_array(fan->count, sizeof(*faces)), *angles = mem_array(fan->count, sizeof(*angles));
    for (size_t t = 0; t < fan->count; t++)
        face_of(fan, t, faces[t], &angles[t]);
    for (size_t t = 0; t < fan->count; t++) {
        double sum[3] = { 0 };
        /* true: the angle between two faces is so close to the crease angle that rounding decides whether they share a normal;
           this face is then not compared */
        bool close = false;
        for (size_t o = 0; o < fan->count; o++) {
            double cosine = faces[t][0] * faces[o][0] + faces[t][1] * faces[o][1] + faces[t][2] * faces[o][2];
            close |= fabs(cosine - CREASE_COSINE) < 1e-9;
            for (int i = 0; cosine >= CREASE_COSINE && i < 3; i++)
                sum[i] += angles[o] * faces[o][i];
        }
        unit(sum);
        for (int i = 0; !close && i < 3; i++)
            assert_true(fabs(sum[i] - (double)fan->normals[3 * t][i]) < 1e-5);
    }
    mem_free(faces);
    mem_free(angles);
}

TEST(sums_are_those_of_all_pairs)
{
    static const struct {
        size_t count;
        double height, rough;
    } fans[] = {
        { 12, 1, 0 }, { 256, 0.5, 0.02 }, { 257, 0.5, 0.02 }, { 1000, 0, 0 }, { 1777, 1, 0 }, { 2000, 0.3, 0.05 }, { 2000, 3, 1 }
    };
    for (size_t i = 0; i < sizeof(fans) / sizeof(fans[0]); i++) {
        struct fan fan;
        fan_init(&fan, fans[i].count, fans[i].height, fans[i].rough, (unsigned)i + 1);
        assert_true(compute(&fan));
        assert_plain_sum(&fan);
        fan_finish(&fan);
    }
}

TEST(a_large_fan_takes_no_quadratic_time)
{
    static const double heights[] = { 0, 0.1, 1, 10 };
    for (size_t i = 0; i < sizeof(heights) / sizeof(heights[0]); i++) {
        struct fan fan;
        fan_init(&fan, 300000, heights[i], 0, 1);
        clock_t begin = clock();
        assert_true(compute(&fan));
        assert_true((double)(clock() - begin) / CLOCKS_PER_SEC < 20); /* all pairs are 9e10 */
        fan_finish(&fan);
    }
}
