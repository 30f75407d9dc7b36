// SPDX-License-Identifier: GPL-3.0-or-later
// Colour of the field (values interpolated between sensors) at a pixel: a lookup in the colour map by position on the scale
// (column) and by brightness of the surface (row). The colour map (render/shaded_colormap.h) holds sRGB colours by the legend's
// rule (field/scale.h): bands, colours outside MIN and MAX, and patterns.
#include "constants.glsl"
layout(binding = 0) uniform sampler2D colormap;
#ifdef RICH
// lookup table: for each position on the scale (0 at MIN, 1 at MAX), the position of the nearest isoline
layout(binding = 15) uniform sampler2D lines;
#endif

const int PLACES = COLORMAP_PLACES, HATCH_LIGHT = PLACES + 2, HATCH_DARK = PLACES + 3, STIPPLE = PLACES + 4,
          PLAIN_LIGHT = PLACES + 5, PLAIN_DARK = PLACES + 6;

// Returns the column of the colour map for a position on the scale (0 at MIN, 1 at MAX). Positions up to 1e-5 beyond the ends still count
// as inside, because interpolation between vertices rounds. Column 0 is below MIN, PLACES + 1 above MAX.
int colormap_column(float place)
{
    const float slack = 1e-5, columns = float(PLACES) / (1.0 + 2.0 * slack);
    return int(clamp(place * columns + (1.0 + slack * columns), 0.0, float(PLACES + 1)));
}

int colormap_row(float light)
{
    return int(clamp(light * frame.shade.x + frame.shade.y, 0.0, frame.shade.z));
}

vec3 colormap_color(int column, int row)
{
    return texelFetch(colormap, ivec2(column, row), 0).rgb;
}

// Pattern of places without data, diagonal stripes: returns a value above 0.5 in the dark stripes.
float hatch(vec2 pixel)
{
    float phase = fract((pixel.x + pixel.y) / (frame.scale.w * HATCH_SLANT));
    return (abs(phase - 0.5) - HATCH_EDGE) * frame.scale.w + 0.5;
}

float stipple(vec2 pixel)
{
    vec2 cell = pixel / frame.scale.w;
    cell.x += 0.5 * floor(mod(cell.y, 2.0));
    return (STIPPLE_RADIUS - length(fract(cell) - 0.5)) * frame.scale.w + 0.5;
}

#ifdef RICH
// Pattern of tags without alarm limits, widely spaced horizontal lines: returns a value above 0.5 on the lines.
float rule(float y)
{
    return (abs(fract(y / frame.scale.w) - 0.5) - RULE_EDGE) * frame.scale.w + 0.5;
}

float place_of(float value)
{
    return ((frame.scale.z > 0.5 ? log2(max(value, 1e-30)) : value) - frame.scale.x) * frame.scale.y;
}

// Returns the fraction of the pixel that an isoline covers, 0..1. The line's width does not depend on the field's slope. Where the field is
// constant within rounding (relative to the scale's largest value), returns 0.
float line_part(float place, int column)
{
    float slope = length(vec2(dFdx(place), dFdy(place)));
    float rounding = 4e-6 * (1.0 + (abs(frame.scale.x) + 2.0 * frame.scale.z) * abs(frame.scale.y));
    float nearest = texelFetch(lines, ivec2(clamp(column - 1, 0, PLACES - 1), 0), 0).r;
    return slope > rounding ? clamp(0.5 * frame.lines.x + 0.5 - abs(place - nearest) / slope, 0.0, 1.0) : 0.0;
}
#endif

// Returns the field's sRGB colour with patterns and isolines. field.x: position on the scale; the value itself if RICH is defined
// (frame.glsl). The other components: shares of no data, uncertain and (RICH) no limits, each 0..1, interpolated between vertices.
vec3 field_color(FIELD_TYPE field, float light)
{
#ifdef RICH
    float place = place_of(field.x);
#else
    float place = field.x;
#endif
    int row = colormap_row(light), column = colormap_column(place), second = column;
    float part = 0.0;
#ifdef RICH
    float line = frame.lines.x > 0.0 ? line_part(place, column) : 0.0;
#endif
    if (field.z > 0.5) {
        second = STIPPLE;
        part = stipple(gl_FragCoord.xy);
    }
#ifdef RICH
    if (field.w > 0.5) {
        column = PLAIN_LIGHT;
        second = PLAIN_DARK;
        part = rule(gl_FragCoord.y);
    }
#endif
    if (field.y > 0.5) {
        column = HATCH_LIGHT;
        second = HATCH_DARK;
        part = hatch(gl_FragCoord.xy);
    }
#ifdef REFINED
    vec3 color = mix(colormap_color(column, row), colormap_color(second, row), clamp(part, 0.0, 1.0));
#else
    // previews (frames in lower quality) look up a single colour per pixel, so the edges of patterns are not antialiased
    vec3 color = colormap_color(part > 0.5 ? second : column, row);
#endif
#ifdef RICH
    vec3 ink = dot(color, vec3(GREY_RED, GREY_GREEN, GREY_BLUE)) > ISOLINE_BRIGHT ? vec3(ISOLINE_DARK_RGB) : vec3(ISOLINE_LIGHT);
    color = mix(color, ink, max(field.y, field.w) > 0.5 ? 0.0 : ISOLINE_MOST * line);
#endif
    return color;
}
