// SPDX-License-Identifier: GPL-3.0-or-later
// Draws the backdrop behind the plant: looks up its colour by elevation over the horizon.
#include "frame.glsl"
layout(binding = 1) uniform sampler2D backdrops;
layout(location = 0) in vec3 ray;
layout(location = 0) out vec4 color;

void main()
{
    float height = dot(ray, frame.up.xyz) * inversesqrt(dot(ray, ray));
    ivec2 tile = ivec2(gl_FragCoord.xy) & 3;
    color = texelFetch(backdrops, ivec2(int(height * 1023.5 + 1024.0), tile.y * 4 + tile.x + int(frame.lines.y)), 0);
}
