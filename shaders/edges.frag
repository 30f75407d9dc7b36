// SPDX-License-Identifier: GPL-3.0-or-later
// Feature edges: thin dark lines where depth has a step. A line is on the farther side, so that it does not cover the value
// colours of the nearer surface. Lines on both sides would hide shapes only a few pixels wide. Thinner shapes get fainter
// lines, because a pole's width varies by a pixel and its line would flicker.
#include "constants.glsl"
#include "frame.glsl"
layout(binding = 0) uniform sampler2D depth;
layout(location = 0) in vec2 clip;
layout(location = 0) out vec4 color;

float at(ivec2 pixel)
{
    return texelFetch(depth, clamp(pixel, ivec2(0), textureSize(depth, 0) - 1), 0).r;
}

// Returns the opacity (0..1) of the line at a depth step; `rise`: the step relative to distance.
float line(float rise)
{
    return smoothstep(EDGE_FROM, EDGE_TO, rise);
}

// Returns the opacity (0..1) of a line at this pixel, if the neighbour at the offset `side` is nearer to the eye. side: step of one pixel.
// Depth is 1/distance, or falls with distance in an orthographic view, so depth is linear over a flat surface on the screen. The nearer
// surface must continue for EDGE_THIN_PX pixels in direction `side`, and about as far along one side (slanting rails are thin but long).
// Opacity is 1 if it continues for EDGE_WIDE_PX.
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
