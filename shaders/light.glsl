// SPDX-License-Identifier: GPL-3.0-or-later
// Light at a point and the resulting colour. Previews (lower quality), refined frames (final quality) and colour ramps share
// this code, so that their colours agree.
#include "constants.glsl"

// Returns the brightness of a surface: 0 in a hidden corner, 1 facing the sun under the open sky. ambient: visible fraction of sky and
// ground, 0..1; sun: cosine to the sun times the sun's visible fraction.
float light_scalar(float ambient, float sun)
{
    return clamp(LIGHT_AMBIENT * ambient + LIGHT_SUN * sun, 0.0, 1.0);
}

vec3 linear_from_srgb(vec3 c)
{
    return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), step(0.04045, c));
}

vec3 srgb_from_linear(vec3 c)
{
    c = clamp(c, 0.0, 1.0);
    return mix(c * 12.92, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c));
}

// Khronos PBR Neutral tone mapping: keeps base colours, compresses highlights.
vec3 tone_map(vec3 c)
{
    const float start = TONE_START, desaturation = TONE_DESATURATION;
    float x = min(c.r, min(c.g, c.b));
    c -= x < 0.08 ? x - 6.25 * x * x : 0.04;
    float peak = max(c.r, max(c.g, c.b));
    if (peak < start)
        return c;
    const float d = 1.0 - start;
    float new_peak = 1.0 - d * d / (peak + d - start);
    c *= new_peak / peak;
    return mix(c, vec3(new_peak), 1.0 - 1.0 / (desaturation * (peak - new_peak) + 1.0));
}

float grey_of(vec3 c)
{
    return dot(c, vec3(GREY_RED, GREY_GREEN, GREY_BLUE));
}

// Returns a paler grey version of the colour of an asset without values of sensors, so that no material is mistaken for a
// value. Takes and returns sRGB.
vec3 mute(vec3 c)
{
    return mix(vec3(grey_of(c)), vec3(MUTED_GREY), MUTED_PART);
}
