/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Helpers of visibility buffers: convert values to colour map columns, and draw lines (ink) over colours. Private to soft/. */
#ifndef RENDER_SOFT_VISIBILITY_BUFFER_IMPL_H
#define RENDER_SOFT_VISIBILITY_BUFFER_IMPL_H
#include <string.h>

#include "render/gl/frame_uniforms.h"
#include "render/shaded_colormap.h"
#include "render/soft/flags.h"
#include "render/soft/lanes.h"
#include "render/soft/visibility_buffer.h"
#include "shaders/constants.glsl"

static const float WEIGHT = 1 / 65535.0f; /* factor that converts the weight of a triangle's corner, stored in 16 bits, to 0..1 */
static const float SLACK = 1e-5f, COLUMNS_OF_RANGE = COLORMAP_PLACES / (1 + 2 * 1e-5f);

static inline float clamped(float x, float low, float high)
{
    return x < low ? low : x > high ? high : x;
}

/* Returns the colour map column of a position on the scale. x: the value or, on a logarithmic scale, log2 of the value. */
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

/* Fills the `cells` of a band: the squares of pixels that show fields of many sensors (pixel_lists.h). The band's `places` and `corners`
   must be set. */
void visibility_find_cells(const struct visibility_buffer *buffer, int number);

static inline bool has_ink(const struct visibility_buffer *buffer, size_t pixel)
{
    return buffer->ink[pixel] || (buffer->veil && buffer->veil[pixel]);
}

/* Returns the colour of a pixel after drawing feature edge, ghost line or rim over it. */
static inline uint32_t inked(const struct visibility_buffer *buffer, size_t pixel, uint32_t color)
{
    typedef uint8_t octets __attribute__((vector_size(4)));
    static const float ink_rgb[3] = { EDGE_RGB }, rim_rgb[3] = { RIM_RGB }, most_ink = (float)EDGE_MOST, white = (float)RIM_WHITE;
    const quad ink_bgr = { ink_rgb[2] * 255, ink_rgb[1] * 255, ink_rgb[0] * 255 };
    const quad rim_dark_bgr = { rim_rgb[2] * 255, rim_rgb[1] * 255, rim_rgb[0] * 255 };
    uint8_t ink = buffer->ink[pixel];
    octets bytes;
    memcpy(&bytes, &color, sizeof(color));
    quad now = __builtin_convertvector(bytes, quad);
    if (ink <= VISIBILITY_INK)
        now += (ink_bgr - now) * (most_ink / VISIBILITY_INK) * (float)ink;
    if (buffer->veil && buffer->veil[pixel]) {
        quad veil_bgr = { buffer->veil_bgr[0], buffer->veil_bgr[1], buffer->veil_bgr[2] };
        now += (veil_bgr - now) * (1 / 255.0f) * (float)buffer->veil[pixel];
    }
    if (ink == VISIBILITY_RIM_DARK)
        now = rim_dark_bgr;
    if (ink == VISIBILITY_RIM_LIGHT)
        now = (1 - white) * now + 255 * white;
    bytes = __builtin_convertvector(__builtin_convertvector(now + 0.5f, quad_int), octets);
    memcpy(&color, &bytes, sizeof(color));
    return color;
}

#endif
