// SPDX-License-Identifier: GPL-3.0-or-later
// The backdrop; below the horizon a ground that only shows where the plant stands between it and the light.
#include "frame.glsl"
#include "environment.glsl"
layout(binding = 1) uniform sampler2D ground_light; // sun and openness
layout(location = 0) in vec2 clip;
layout(location = 0) out vec4 color;
#ifdef STILL
#include "shadow.glsl"
#endif

void main()
{
    vec4 far = frame.eye_from_clip * vec4(clip, 0.5, 1.0);
    vec3 ray = normalize(far.xyz / far.w);
    float height = dot(ray, frame.up.xyz);
    color = vec4(backdrop(height), 1.0);
    if (frame.look.y == 0 || height > -1e-4)
        return;
    vec3 place = ray * (frame.up.w / height);
    vec2 at = (frame.ground_from_eye * vec4(place, 1.0)).xy;
    vec2 margin = smoothstep(vec2(0.5), vec2(0.32), abs(at - 0.5));
    float near = margin.x * margin.y;
    if (near == 0.0)
        return;
    vec2 light = texture(ground_light, at).rg;
#ifdef STILL
    light.x = sun_visibility(frame.sun_from_eye, place, frame.up.xyz, frame.sun.w, 2.5);
#endif
    float dim = 0.20 * (1.0 - light.x) + 0.42 * (1.0 - light.y);
    color.rgb *= 1.0 - near * min(dim, 0.5);
}
