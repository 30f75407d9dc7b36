/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the shares of all sensors come to at each place, for the readings that are worst there. */
#include <math.h>
#include <string.h>

#include "base/math/simd.h"
#include "base/mem.h"
#include "preprocess/influence/influence_bend.h"

#define STEPS 255.0
#define FIXED 0x1p40 /* parts of a share: whole numbers add up to the same in any order */

typedef float shares_of[BEND_WIDTH];

/* Σ weight times what its point has. Sensors beyond `width` have 0. */
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

/* Readings that are farthest apart are the worst: all with a share above 0 at MAX and the others at MIN, or the other way round. */
static double worst_of(double plus, double minus, double around)
{
    double level = around * (plus + minus);
    return STEPS * fmax(fabs(plus - level), fabs(minus - level));
}

void influence_bend_measure(struct influence_bend *bend, double around, float *steps_out, struct bend_report *report)
{
    float *steps = mem_array(bend->drawn.triangle_count, sizeof(*steps));
    double all_m2 = 0, over_m2 = 0, hidden_m2 = 0, unknown_m2 = 0;
    for (size_t i = 0; i < bend->count; i++) {
        double worst = worst_of((double)bend->plus[i] / FIXED, (double)bend->minus[i] / FIXED, around);
        float *most = &steps[bend->places[i].tri];
        *most = fmaxf(*most, (float)worst);
        bend->plus[i] = bend->minus[i] = 0;
    }
    for (size_t t = 0; t < bend->drawn.triangle_count; t++) {
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
    mem_free(steps);
}
