// SPDX-License-Identifier: GPL-3.0-or-later
// Computes the visible fraction of the sun at a point (0..1), from the sun's shadow map: averages four lookups on a rotated square. The GL
// sampler makes each lookup the weighted mean of four depth comparisons.
#include "constants.glsl"
layout(binding = 2) uniform sampler2DShadow sun_map;

// normal: the surface's normal, along which the point is moved away from the surface, so that the surface does not shadow
// itself.
float sun_visibility(mat4 sun_from_here, vec3 place, vec3 normal, float texel_m)
{
    vec3 p = (sun_from_here * vec4(place + normal * (texel_m * (1.0 + SUN_SPREAD)), 1.0)).xyz;
    vec2 to = vec2(SUN_TURN) * (SUN_SPREAD / float(textureSize(sun_map, 0).x));
    float sum = texture(sun_map, vec3(p.xy + to, p.z)) + texture(sun_map, vec3(p.xy - to, p.z));
    sum += texture(sun_map, vec3(p.x - to.y, p.y + to.x, p.z)) + texture(sun_map, vec3(p.x + to.y, p.y - to.x, p.z));
    return 0.25 * sum;
}
