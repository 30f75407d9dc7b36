// SPDX-License-Identifier: GPL-3.0-or-later
// Ghosted assets: lines where their depth has steps or creases, and a thin horizontal line every ten pixels, so that the colours behind
// stay recognisable. Dots and slanting lines are not used, because they mean "uncertain" and "no data".
#include "constants.glsl"
#include "frame.glsl"
layout(binding = 0) uniform sampler2D ghosts; // depth of ghosts; 0: none
layout(binding = 1) uniform sampler2D depth;  // depth of everything else
layout(location = 0) in vec2 clip;
layout(location = 0) out vec4 color;

float at(ivec2 pixel)
{
    return texelFetch(ghosts, clamp(pixel, ivec2(0), textureSize(ghosts, 0) - 1), 0).r;
}

// Detects edges of a ghosted asset at a pixel from its two neighbours at +side and -side. x: step: drop of depth to the farther
// neighbour, minus rise to the nearer one (0 on a plane, however steep); y: crease: curvature of the depth. Both are relative
// to distance.
vec2 shape(ivec2 pixel, float here, float scale, ivec2 side)
{
    float a = at(pixel - side), b = at(pixel + side);
    return vec2(here - min(a, b) - max(max(a, b) - here, 0.0), abs(a + b - 2.0 * here)) * scale;
}

void main()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float here = at(pixel);
    if (here <= 0.0 || here < texelFetch(depth, pixel, 0).r)
        discard;
    float scale = frame.back.w > 0.0 ? frame.back.w : 1.0 / here;
    vec2 found = max(shape(pixel, here, scale, ivec2(1, 0)), shape(pixel, here, scale, ivec2(0, 1)));
    float line = max(GHOST_FALL_MOST * smoothstep(GHOST_FALL_FROM, GHOST_FALL_TO, found.x),
                     GHOST_BEND_MOST * smoothstep(GHOST_BEND_FROM, GHOST_BEND_TO, found.y));
    bool level = pixel.y % GHOST_LEVEL_PX == 0;
    if (line < GHOST_LEAST && !level)
        discard;
    vec3 ink = frame.lines.y > 0.0 ? vec3(GHOST_ON_DARK_RGB) : vec3(GHOST_ON_LIGHT_RGB);
    color = vec4(ink, max(line, level ? GHOST_LEVEL : 0.0));
}
