// SPDX-License-Identifier: GPL-3.0-or-later
// Draws the outline of the selected asset, whose pixels are set in `mask`: a dark line and a light line around it, so that the outline is
// visible on any colour.
#include "constants.glsl"
layout(binding = 0) uniform sampler2D mask;
layout(location = 0) uniform float width_px;
layout(location = 0) in vec2 clip;
layout(location = 0) out vec4 color;

// Returns 1 if any of 12 points on a circle of this radius around the pixel is inside the mask.
float ring(ivec2 at, float radius)
{
    ivec2 last = textureSize(mask, 0) - 1;
    float most = 0.0;
    for (int i = 0; i < 12; i++) {
        float angle = float(i) * 0.5236;
        most = max(most, texelFetch(mask, clamp(at + ivec2(round(radius * vec2(cos(angle), sin(angle)))), ivec2(0), last), 0).r);
    }
    return most;
}

void main()
{
    ivec2 at = ivec2(gl_FragCoord.xy);
    if (texelFetch(mask, at, 0).r > 0.5)
        discard;
    if (ring(at, width_px) > 0.5)
        color = vec4(RIM_RGB, 1.0);
    else if (ring(at, width_px * 2.0) > 0.5)
        color = vec4(1.0, 1.0, 1.0, RIM_WHITE);
    else
        discard;
}
