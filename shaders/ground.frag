// SPDX-License-Identifier: GPL-3.0-or-later
// Draws the shadow on the ground: outputs a factor that blending multiplies by the backdrop's colour.
#include "constants.glsl"
#include "frame.glsl"
// visible part of the sun, and openness (visible part of the sky), at a point of the ground; both 0..1
layout(binding = 1) uniform sampler2D ground_light;
layout(location = 0) in vec2 at;
layout(location = 1) in vec3 place;
layout(location = 0) out vec4 factor;
#ifdef REFINED
#include "shadow.glsl"
#endif

void main()
{
    vec2 light = texture(ground_light, at).rg;
#ifdef REFINED
    light.x = sun_visibility(frame.sun_from_eye, place, frame.up.xyz, frame.sun.w);
#endif
    vec2 margin = smoothstep(vec2(0.5), vec2(0.3), abs(at - 0.5));
    factor = vec4(vec3(1.0 - margin.x * margin.y * min(GROUND_SUN * (1.0 - light.x) + GROUND_SKY * (1.0 - light.y), GROUND_MOST)), 1.0);
}
