/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Colours of surfaces cut by section planes, for eight pixels at a time; a C version of shaders/section.glsl. Private to soft/. */
#ifndef RENDER_SOFT_SECTION_COLORS_H
#define RENDER_SOFT_SECTION_COLORS_H
#include <math.h>

#include "render/soft/soft_impl.h"
#include "render/soft/vectors.h"
#include "shaders/constants.glsl"

enum { NORMAL_BITS = 14, NORMAL_MOST = (1 << NORMAL_BITS) - 1 };

/* Returns the colour of a section cap: a closed body cut open. */
SOFT_INLINE lanes_int cap_color(lanes x, float y, float pattern_px)
{
    lanes phase = (x - y) * (1 / ((float)CAP_PERIOD * pattern_px)), whole = __builtin_convertvector(lanes_whole(phase), lanes);
    lanes one = (lanes){ 0 } + 1.0f;
    phase -= whole - lanes_choose(whole > phase, one, (lanes){ 0 });
    const float from = (float)CAP_STRIPE_FROM, to = (float)CAP_STRIPE_TO;
    lanes t = lanes_clamp((lanes_most(phase - 0.5f, 0.5f - phase) - from) * (1 / (to - from)), 0, 1), part = t * t * (3.0f - 2.0f * t);
    static const float cap[3] = { CAP_RGB }, stripe = (float)CAP_STRIPE;
    return pack_color(cap[0] - stripe * part, cap[1] - stripe * part, cap[2] - stripe * part);
}

/* Returns the colour of a surface's inner side. v: unit vectors towards the viewer; n: normals of any length, pointing to either side. */
SOFT_INLINE lanes_int inside_color(const lanes v[3], const lanes n[3], const float up[3])
{
    lanes none = { 0 }, square = n[0] * n[0] + n[1] * n[1] + n[2] * n[2], towards = n[0] * v[0] + n[1] * v[1] + n[2] * v[2];
    lanes over = 1.0f / lanes_root(lanes_most(square, none + 1e-30f));
    over = lanes_choose(towards < 0.0f, -over, over);
    lanes bright =
        (float)INSIDE_LEAST + over * ((float)INSIDE_TOWARDS * towards + (float)INSIDE_UP * (n[0] * up[0] + n[1] * up[1] + n[2] * up[2]));
    static const float inside[3] = { INSIDE_RGB };
    return pack_color(inside[0] * bright, inside[1] * bright, inside[2] * bright);
}

/* Encodes a normal of any length as the mark (colour code of a pixel) of a surface's inner side, by octahedral mapping. */
static inline uint32_t inside_mark(const float n[3])
{
    float sum = fabsf(n[0]) + fabsf(n[1]) + fabsf(n[2]), over = sum > 0 ? 1 / sum : 0, x = n[0] * over, y = n[1] * over;
    if (n[2] < 0) {
        float folded = copysignf(1 - fabsf(y), x);
        y = copysignf(1 - fabsf(x), y);
        x = folded;
    }
    uint32_t across = (uint32_t)((0.5f + 0.5f * x) * NORMAL_MOST + 0.5f), down = (uint32_t)((0.5f + 0.5f * y) * NORMAL_MOST + 0.5f);
    return MARK_SECTION | across | down << NORMAL_BITS;
}

SOFT_INLINE void inside_normal(lanes_int marks, lanes n[3])
{
    lanes none = { 0 }, x = __builtin_convertvector(marks & NORMAL_MOST, lanes) * (2.0f / NORMAL_MOST) - 1.0f;
    lanes y = __builtin_convertvector(marks >> NORMAL_BITS & NORMAL_MOST, lanes) * (2.0f / NORMAL_MOST) - 1.0f;
    lanes ax = lanes_most(x, -x), ay = lanes_most(y, -y);
    n[2] = 1.0f - ax - ay;
    lanes back = lanes_most(-n[2], none);
    n[0] = lanes_choose(x < 0.0f, x + back, x - back);
    n[1] = lanes_choose(y < 0.0f, y + back, y - back);
}

#endif
