// SPDX-License-Identifier: GPL-3.0-or-later
// The backdrop, looked up by height over the horizon.
#include "frame.glsl"
layout(binding = 1) uniform sampler2D backdrops;
layout(location = 0) in vec3 ray;
layout(location = 0) out vec4 color;

void main()
{
    float height = dot(ray, frame.up.xyz) * inversesqrt(dot(ray, ray));
    color = texelFetch(backdrops, ivec2(int(height * 511.5 + 512.0), 0), 0);
}
