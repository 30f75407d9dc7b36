// SPDX-License-Identifier: GPL-3.0-or-later
// Thin dark lines around shapes: where depth breaks, on the farther side, so that they do not lie on the field of what stands in
// front. Shapes of a few pixels' width get none: lines on both sides would bury them.
#include "frame.glsl"
layout(binding = 0) uniform sampler2D depth;
layout(location = 0) in vec2 clip;
layout(location = 0) out vec4 color;

float at(ivec2 pixel)
{
    return texelFetch(depth, clamp(pixel, ivec2(0), textureSize(depth, 0) - 1), 0).r;
}

// From here, one pixel to that side: how much nearer, as a part. Depth is 1/distance, or falls with distance in an orthographic
// picture; over a flat surface it is a plane on the screen.
// What is nearer must go on for some pixels, and to one hand at least: slanting rails are thin though long.
float rise(ivec2 pixel, float here, ivec2 side)
{
    ivec2 other = pixel + side, hand = side.yx * 2;
    float next = at(other), wide = min(at(pixel + 3 * side), at(pixel + 4 * side)), high = max(at(other + hand), at(other - hand));
    float back = at(pixel - side);
    return (min(next, min(wide, high)) - here - max(here - back, 0.0)) * (frame.back.w > 0.0 ? frame.back.w : 1.0 / max(next, 1e-9));
}

void main()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float here = at(pixel);
    float most = max(max(rise(pixel, here, ivec2(1, 0)), rise(pixel, here, ivec2(-1, 0))),
                     max(rise(pixel, here, ivec2(0, 1)), rise(pixel, here, ivec2(0, -1))));
    float edge = smoothstep(0.006, 0.03, most);
    if (edge <= 0.0)
        discard;
    color = vec4(0.08, 0.10, 0.14, 0.5 * edge);
}
