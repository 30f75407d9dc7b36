// SPDX-License-Identifier: GPL-3.0-or-later
// The colour of the field at a pixel. The palette holds sRGB colours: one column for each colour of the map, then those of
// below, above and the two of the hatching; one row for each step of light (render/palette.c).
layout(binding = 0) uniform sampler2D palette;

const int MAP_COLORS = 256, BELOW = 256, ABOVE = 257, HATCH_LIGHT = 258, HATCH_DARK = 259, STIPPLE = 260;

// The legend's rule (field/colormap.h). value: (v - MIN)/(MAX - MIN). Interpolating equal values may round: the ends have some slack.
int palette_column(float value)
{
    const float slack = 1e-5;
    if (value < -slack)
        return BELOW;
    if (value > 1.0 + slack)
        return ABOVE;
#ifdef RAMP
    float interval = frame.range.z, bands = max(ceil(1.0 / interval - 0.001), 1.0);
    float begin = clamp(floor(value / interval + slack), 0.0, bands - 1.0) * interval;
    value = 0.5 * (begin + min(begin + interval, 1.0));
#endif
    return clamp(int(value * float(MAP_COLORS)), 0, MAP_COLORS - 1);
}

int palette_row(float light)
{
    float rows = float(textureSize(palette, 0).y - 1);
    return int((frame.look.x == LOOK_DEFAULT ? light_row(light) : 0.5) * rows + 0.5);
}

vec3 palette_color(int column, int row)
{
    return texelFetch(palette, ivec2(column, row), 0).rgb;
}

// Diagonal stripes: over 0.5 on the dark ones.
float hatch(vec2 pixel)
{
    float phase = fract((pixel.x + pixel.y) / (frame.range.w * 1.4142));
    return (abs(phase - 0.5) - 0.25) * frame.range.w + 0.5;
}

float stipple(vec2 pixel)
{
    vec2 cell = pixel / frame.range.w;
    cell.x += 0.5 * floor(mod(cell.y, 2.0));
    return (0.26 - length(fract(cell) - 0.5)) * frame.range.w + 0.5;
}

// sRGB. flags: no data, uncertain; 0..1 between vertices.
vec3 field_color(float value, vec2 flags, float light)
{
    int row = palette_row(light), column = palette_column(value), second = column;
    float part = 0.0;
    if (flags.y > 0.5) {
        second = STIPPLE;
        part = stipple(gl_FragCoord.xy);
    }
    if (flags.x > 0.5) {
        column = HATCH_LIGHT;
        second = HATCH_DARK;
        part = hatch(gl_FragCoord.xy);
    }
#ifdef STILL
    return mix(palette_color(column, row), palette_color(second, row), clamp(part, 0.0, 1.0));
#else
    return palette_color(part > 0.5 ? second : column, row); // one look-up
#endif
}
