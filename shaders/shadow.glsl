// SPDX-License-Identifier: GPL-3.0-or-later
// How much of the sun a point sees: 8 taps on a disc of a few texels, each one a mean of four comparisons.
layout(binding = 2) uniform sampler2DShadow sun_map;

const vec2 disc[16] = vec2[](vec2(0.177, 0.000), vec2(-0.226, 0.207), vec2(0.035, -0.394), vec2(0.285, 0.371), vec2(-0.522, -0.092),
                             vec2(0.494, -0.314), vec2(-0.166, 0.615), vec2(-0.316, -0.608), vec2(0.685, 0.249), vec2(-0.712, 0.294),
                             vec2(0.343, -0.734), vec2(0.255, 0.808), vec2(-0.764, -0.443), vec2(0.897, -0.197), vec2(-0.548, 0.779),
                             vec2(-0.126, -0.976));

// normal: of the surface, to step off it. spread: radius of the disc in texels.
float sun_visibility(mat4 sun_from_here, vec3 place, vec3 normal, float texel_m, float spread)
{
    vec3 p = (sun_from_here * vec4(place + normal * (texel_m * (1.0 + spread)), 1.0)).xyz;
    float radius = spread / float(textureSize(sun_map, 0).x), sum = 0.0;
    for (int i = 0; i < 8; i++)
        sum += texture(sun_map, vec3(p.xy + disc[i] * radius, p.z));
    return sum / 8.0;
}
