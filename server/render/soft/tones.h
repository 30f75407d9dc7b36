/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Conversion of linear light to colours, for eight pixels at a time; a C version of shaders/light.glsl. Also packs the light that falls on
   glossy fields, which visibility buffers store separately from the field's colours. Private to soft/. */
#ifndef RENDER_SOFT_TONES_H
#define RENDER_SOFT_TONES_H
#include "render/soft/vectors.h"
#include "shaders/constants.glsl"

struct visibility_gloss;

enum { TONES = 4096 };
struct soft_tones {
    float srgb[TONES + 1]; /* table of sRGB values by linear light; both range from 0 to 1 */
    float linear[256];     /* linear light by sRGB byte */
};
void soft_tones_init(struct soft_tones *tones);

SOFT_INLINE lanes srgb_of_light(const struct soft_tones *tones, lanes x)
{
    lanes at = lanes_clamp(x, 0, 1) * TONES, out;
    lanes_int first = lanes_whole(at);
    lanes part = at - __builtin_convertvector(first, lanes);
    for (int i = 0; i < LANES; i++)
        out[i] = tones->srgb[first[i]];
    lanes next = out;
    for (int i = 0; i < LANES; i++)
        next[i] = tones->srgb[first[i] < TONES ? first[i] + 1 : TONES];
    return out + (next - out) * part;
}

SOFT_INLINE vec tone_map(vec c)
{
    const float start = (float)TONE_START, desaturation = (float)TONE_DESATURATION, d = 1 - start;
    lanes x = least_of(c.x, least_of(c.y, c.z)), off = lanes_choose(x < 0.08f, x - 6.25f * x * x, all(0.04f));
    c = plus(c, grey(-off));
    lanes peak = most_of(c.x, most_of(c.y, c.z)), safe = most_of(peak, all(start));
    lanes new_peak = 1.0f - d * d / (safe + d - start), part = 1.0f - 1.0f / (desaturation * (safe - new_peak) + 1.0f);
    vec rolled = between(times(c, new_peak / safe), grey(new_peak), part);
    lanes_int low = peak < start;
    return (vec){ lanes_choose(low, c.x, rolled.x), lanes_choose(low, c.y, rolled.y), lanes_choose(low, c.z, rolled.z) };
}

/* Packs light of 0..65408 into 32 bits: nine bits for each channel and a shared exponent, like GL_RGB9_E5. */
uint32_t soft_pack_light(const float light[3]);

SOFT_INLINE vec unpack_light(lanes_int packed)
{
    lanes scale = (lanes)((((lanes_int)((lanes_uint)packed >> 27)) + (127 - 24)) << 23);
    return (vec){ __builtin_convertvector(packed & 511, lanes) * scale, __builtin_convertvector(packed >> 9 & 511, lanes) * scale,
                  __builtin_convertvector(packed >> 18 & 511, lanes) * scale };
}

/* Returns the colours of glossy surfaces with these base colours, like GLOSSY in shaders/refined.frag. gloss: eight elements. */
SOFT_INLINE lanes_int glossy_colors(const struct soft_tones *tones, lanes_int colors, const struct visibility_gloss *gloss)
{
    lanes_int halves[2];
    __builtin_memcpy(halves, gloss, sizeof(halves));
    lanes_int of_color = __builtin_shufflevector(halves[0], halves[1], 0, 2, 4, 6, 8, 10, 12, 14);
    lanes_int besides = __builtin_shufflevector(halves[0], halves[1], 1, 3, 5, 7, 9, 11, 13, 15);
    vec base = { lanes_look_up(tones->linear, colors >> 16 & 0xff), lanes_look_up(tones->linear, colors >> 8 & 0xff),
                 lanes_look_up(tones->linear, colors & 0xff) };
    vec c = tone_map(plus(unpack_light(besides), multiplied(base, unpack_light(of_color))));
    return pack_color(srgb_of_light(tones, c.x), srgb_of_light(tones, c.y), srgb_of_light(tones, c.z));
}

#endif
