/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From what vertices carry to columns of the colormap. Private to recolor*.c. */
#ifndef RENDER_RECOLOR_IMPL_H
#define RENDER_RECOLOR_IMPL_H
#include <string.h>

#include "render/draft/draft_impl.h"
#include "render/draft/draft_simd.h"
#include "render/recolor.h"

static const float SLACK = 1e-5f, COLUMNS_OF_RANGE = COLORMAP_PLACES / (1 + 2 * 1e-5f);

static inline float clamped(float x, float low, float high)
{
    return x < low ? low : x > high ? high : x;
}

/* As carry_field in draft_place.c. x: the value, or log2 of it. */
static inline float column_of(float x, const float *scale)
{
    const float farthest = 1e6f;
    float place = (x - scale[0]) * scale[1];
    return clamped(place * COLUMNS_OF_RANGE + (1 + SLACK * COLUMNS_OF_RANGE), -farthest, farthest);
}

static inline bool is_log(const float *scale)
{
    return scale[2] > 0.5f;
}

/* A line or a rim over a pixel. */
static inline uint32_t inked(uint32_t color, uint8_t ink)
{
    typedef uint8_t octets __attribute__((vector_size(4)));
    static const quad rim_dark_bgr = { 41, 23, 13 }, ink_bgr = { 0.14f * 255, 0.10f * 255, 0.08f * 255 };
    static const float most_ink = 0.5f; /* as shaders/edges.frag */
    octets was_bytes;
    memcpy(&was_bytes, &color, sizeof(color));
    quad was = __builtin_convertvector(was_bytes, quad), now = was + (ink_bgr - was) * (most_ink / RECOLOR_INK) * (float)ink;
    if (ink == RECOLOR_RIM_DARK)
        now = rim_dark_bgr;
    if (ink == RECOLOR_RIM_LIGHT)
        now = 0.1f * was + 229.5f;
    was_bytes = __builtin_convertvector(__builtin_convertvector(now + 0.5f, quad_int), octets);
    memcpy(&color, &was_bytes, sizeof(color));
    return color;
}

#endif
