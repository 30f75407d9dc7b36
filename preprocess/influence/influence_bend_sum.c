/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sums the interpolation errors of all sensors' weights at each place (corner of an overlap, influence_bend.h), and finds the
 * largest error that any readings can cause. */
#include <math.h>
#include <string.h>

#include "base/math/simd.h"
#include "base/math/vec.h"
#include "base/mem.h"
#include "preprocess/influence/influence_bend.h"

#define STEPS 255.0
#define FIXED 0x1p40 /* fixed-point scale of weights; unlike floating point, integer sums do not depend on the order of addition */

typedef float shares_of[BEND_WIDTH];

/* Interpolates the weights of `width` sensors at an anchor (three mesh points and their weights). Sets the rest of the
 * BEND_WIDTH results to 0. */
SIMD_BODY void gather(const struct influence_anchor *anchor, const float *at_points, size_t stride, size_t width, shares_of out)
{
    const float *a = at_points + anchor->points[0] * stride, *b = at_points + anchor->points[1] * stride;
    const float *c = at_points + anchor->points[2] * stride;
    if (anchor->weights[0] == 1) {
        memcpy(out, a, width * sizeof(*a));
        return;
    }
    for (size_t s = 0; s < width; s++)
        out[s] = anchor->weights[0] * a[s] + anchor->weights[1] * b[s] + anchor->weights[2] * c[s];
}

SIMD_BODY float sum_of(shares_of values)
{
    for (size_t half = BEND_WIDTH / 2; half > 0; half /= 2)
        for (size_t s = 0; s < half; s++)
            values[s] += values[s + half];
    return values[0];
}

SIMD_CLONES("avx512f", "avx2")
void influence_bend_add(struct influence_bend *bend, const float *at_points, size_t stride, size_t width)
{
    mesh_error_add(bend->mesh_error, at_points, stride, width);
    shares_of corners[3] = { { 0 } }, there = { 0 }, plus, minus;
    uint32_t tri = TRIMESH_NONE;
    for (size_t i = 0; i < bend->count; i++) {
        const struct bend_place *place = &bend->places[i];
        for (size_t k = 0; k < 3 && place->tri != tri; k++)
            gather(&bend->drawn.anchors[bend->drawn.triangles[3 * (size_t)place->tri + k]], at_points, stride, width, corners[k]);
        tri = place->tri;
        gather(&place->anchor, at_points, stride, width, there);
        for (size_t s = 0; s < BEND_WIDTH; s++) {
            float drawn = place->weights[0] * corners[0][s] + place->weights[1] * corners[1][s] + place->weights[2] * corners[2][s];
            float differs = there[s] - drawn;
            plus[s] = differs > 0 ? differs : 0;
            minus[s] = differs < 0 ? differs : 0;
        }
        atomic_fetch_add_explicit(&bend->plus[i], (int64_t)(FIXED * (double)sum_of(plus)), memory_order_relaxed);
        atomic_fetch_add_explicit(&bend->minus[i], (int64_t)(FIXED * (double)sum_of(minus)), memory_order_relaxed);
    }
}

/* Returns the largest error of the interpolated values that any readings can cause, in colour steps (1/255 of the range). The
   worst readings are MAX for all sensors with a positive weight error and MIN for the others, or vice versa. plus, minus: sums
   of the positive and negative weight errors. around: see influence_bend_measure(). */
static double worst_of(double plus, double minus, double around)
{
    double level = around * (plus + minus);
    return STEPS * fmax(fabs(plus - level), fabs(minus - level));
}

/* --- vertex errors ----------------------------------------------------------------------------------------------------------- */

/* a drawn triangle's error is bounded, hidden (does not count) or unknown */
enum triangle_state { TRIANGLE_BOUNDED, TRIANGLE_HIDDEN, TRIANGLE_UNKNOWN };
/* a triangle counts as wholly hidden if more than this share of its area is hidden; below 1 because of rounding */
#define ALL_OF_IT 0.999
/* A triangle of a coarse level counts as unknown if the error is unknown at more than this share of its sample points. The
   share is large because such triangles do not lie on the surface. */
#define COARSE_UNKNOWN 0.5

static enum triangle_state state_of(const struct influence_bend *bend, size_t tri)
{
    double area_m2 = bend->area_m2[tri], unknown_m2 = bend->unknown_m2[tri];
    bool finest = bend->drawn.level_count == 0 || tri < bend->drawn.levels[0].triangle_count;
    if (unknown_m2 > (finest ? 0 : COARSE_UNKNOWN * area_m2))
        return TRIANGLE_UNKNOWN;
    return bend->hidden_m2[tri] > ALL_OF_IT * area_m2 ? TRIANGLE_HIDDEN : TRIANGLE_BOUNDED;
}

static float mesh_error_at(const struct influence_anchor *anchor, const float *by_point)
{
    float most = 0;
    for (int k = 0; k < 3; k++)
        most = fmaxf(most, by_point[anchor->points[k]]);
    return most;
}

/* Writes the interpolation error of each vertex. bends: bend of each triangle as a share of the spread of readings. Triangles
 * hidden inside other parts are visible only in sections and do not count. A vertex used only by hidden triangles gets the
 * error 1 (unknown). */
static void write_errors(struct influence_bend *bend, const float *bends, float *errors)
{
    const struct bend_drawn *drawn = &bend->drawn;
    float *by_point = mem_array(bend->point_count, sizeof(*by_point));
    float *of_mesh = mem_array(drawn->triangle_count, sizeof(*of_mesh));
    char *seen = mem_array(drawn->vertex_count, 1);
    mesh_error_take(bend->mesh_error, by_point);
    for (size_t i = 0; i < bend->count; i++)
        of_mesh[bend->places[i].tri] = fmaxf(of_mesh[bend->places[i].tri], mesh_error_at(&bend->places[i].anchor, by_point));
    memset(errors, 0, drawn->vertex_count * sizeof(*errors));
    for (size_t t = 0; t < drawn->triangle_count; t++) {
        const uint32_t *corners = drawn->triangles + 3 * t;
        enum triangle_state state = state_of(bend, t);
        float error = of_mesh[t];
        for (int k = 0; k < 3; k++)
            error = fmaxf(error, mesh_error_at(&drawn->anchors[corners[k]], by_point));
        error = state == TRIANGLE_UNKNOWN ? 1 : bends[t] + error;
        for (int k = 0; k < 3 && state != TRIANGLE_HIDDEN; k++) {
            seen[corners[k]] = 1;
            errors[corners[k]] = fmaxf(errors[corners[k]], error);
        }
    }
    for (size_t v = 0; v < drawn->vertex_count; v++)
        errors[v] = seen[v] ? errors[v] : 1;
    mem_free(seen);
    mem_free(of_mesh);
    mem_free(by_point);
}

void influence_bend_measure(struct influence_bend *bend, double around, float *steps_out, float *errors, struct bend_report *report)
{
    const size_t finest = bend->drawn.level_count > 0 ? bend->drawn.levels[0].triangle_count : bend->drawn.triangle_count;
    float *steps = mem_array(bend->drawn.triangle_count, sizeof(*steps)), *bends = mem_array(bend->drawn.triangle_count, sizeof(*bends));
    double all_m2 = 0, over_m2 = 0, hidden_m2 = 0, unknown_m2 = 0;
    for (size_t i = 0; i < bend->count; i++) {
        const double plus = (double)bend->plus[i] / FIXED, minus = (double)bend->minus[i] / FIXED;
        const uint32_t tri = bend->places[i].tri;
        steps[tri] = fmaxf(steps[tri], (float)worst_of(plus, minus, around));
        bends[tri] = fmaxf(bends[tri], (float)max_of(plus, -minus));
        bend->plus[i] = bend->minus[i] = 0;
    }
    for (size_t t = 0; t < finest; t++) {
        all_m2 += bend->area_m2[t];
        hidden_m2 += bend->hidden_m2[t];
        unknown_m2 += bend->unknown_m2[t];
        over_m2 += steps[t] > 1 ? bend->area_m2[t] - bend->hidden_m2[t] - bend->unknown_m2[t] : 0;
        report->steps = fmax(report->steps, (double)steps[t]);
    }
    report->measured++;
    report->over_share = all_m2 > 0 ? fmax(report->over_share, over_m2 / all_m2) : report->over_share;
    report->hidden_share = all_m2 > 0 ? fmax(report->hidden_share, hidden_m2 / all_m2) : report->hidden_share;
    report->unknown_share = all_m2 > 0 ? fmax(report->unknown_share, unknown_m2 / all_m2) : report->unknown_share;
    if (steps_out)
        memcpy(steps_out, steps, bend->drawn.triangle_count * sizeof(*steps));
    if (errors)
        write_errors(bend, bends, errors);
    mem_free(bends);
    mem_free(steps);
}
