// SPDX-License-Identifier: GPL-3.0-or-later
// Thin dark lines around shapes: where depth breaks, on the farther side, so that they do not lie on the field of what stands in
// front. Lines on both sides would bury shapes of a few pixels' width: these get the fainter ones the thinner they are, so that along a
// pole, of one pixel more here and one less there, a line does not come and go.
#include "constants.glsl"
#include "frame.glsl"
layout(binding = 0) uniform sampler2D depth;
layout(location = 0) in vec2 clip;
layout(location = 0) out vec4 color;

float at(ivec2 pixel)
{
    return texelFetch(depth, clamp(pixel, ivec2(0), textureSize(depth, 0) - 1), 0).r;
}

// How much of a line there is for what is that much nearer, as a part.
float line(float rise)
{
    return smoothstep(EDGE_FROM, EDGE_TO, rise);
}

// From here, one pixel to that side: whether it is nearer. Depth is 1/distance, or falls with distance in an orthographic picture; over a
// flat surface it is a plane on the screen.
// What is nearer must go on for EDGE_THIN_PX, and about as far to one hand: slanting rails are thin though long. All of a line is for
// EDGE_WIDE_PX.
float edge(ivec2 pixel, float here, ivec2 side)
{
    ivec2 other = pixel + side;
    float next = at(other), level = here + max(here - at(pixel - side), 0.0);
    float part = frame.back.w > 0.0 ? frame.back.w : 1.0 / max(next, 1e-9), ahead = next, left = next, right = next, lines = 0.0;
    if (line((next - level) * part) <= 0.0)
        return 0.0;
    for (int i = EDGE_THIN_PX; i <= EDGE_WIDE_PX; i++) {
        ahead = min(ahead, at(pixel + i * side));
        left = min(left, at(other + (i - 1) * side.yx));
        right = min(right, at(other - (i - 1) * side.yx));
        lines += line((min(ahead, max(left, right)) - level) * part);
    }
    return lines / float(EDGE_WIDE_PX - EDGE_THIN_PX + 1);
}

void main()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float here = at(pixel);
    float most = max(max(edge(pixel, here, ivec2(1, 0)), edge(pixel, here, ivec2(-1, 0))),
                     max(edge(pixel, here, ivec2(0, 1)), edge(pixel, here, ivec2(0, -1))));
    if (most <= 0.0)
        discard;
    color = vec4(EDGE_RGB, EDGE_MOST * most);
}
