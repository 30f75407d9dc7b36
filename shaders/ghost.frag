// SPDX-License-Identifier: GPL-3.0-or-later
// Assets that are only hinted at: lines where their depth breaks or bends, and a thin level one each ten pixels in between, so that
// the colours behind stay what they are. No dots and no slanting lines: those say uncertain and no data.
#include "constants.glsl"
#include "frame.glsl"
layout(binding = 0) uniform sampler2D ghosts; // their depth; 0: none
layout(binding = 1) uniform sampler2D depth;  // of all else
layout(location = 0) in vec2 clip;
layout(location = 0) out vec4 color;

float at(ivec2 pixel)
{
    return texelFetch(ghosts, clamp(pixel, ivec2(0), textureSize(ghosts, 0) - 1), 0).r;
}

// x: how far it falls to either side, beyond how it rises to the other (a plane does, however steep), y: how much it bends; as parts of the
// distance.
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
