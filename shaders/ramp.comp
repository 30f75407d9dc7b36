// SPDX-License-Identifier: GPL-3.0-or-later
// For each material, its colour at each step of light: what the moving tier looks up.
#include "light.glsl"
#include "material.glsl"
#include "environment.glsl"
#include "pbr.glsl"
layout(local_size_x = 64) in;
layout(rgba8, binding = 0) writeonly uniform image2D ramps;
layout(location = 0) uniform vec3 up;
layout(location = 1) uniform bool muted;

void main()
{
    ivec2 at = ivec2(gl_GlobalInvocationID.xy), size = imageSize(ramps);
    if (at.x >= size.x)
        return;
    Material m = materials[at.y];
    float light = float(at.x) / float(size.x - 1);
    float sun = max(light - 0.45, 0.0) / 0.55, ambient = (light - 0.48 * sun) / 0.52; // the usual mixture at that light
    vec3 n = up, v = normalize(0.7 * up + 0.7 * up.yzx);
    vec3 c = sky_shade(Surface(m.mean.rgb, m.factors.x, max(m.factors.y, 0.6), n, ambient, 0.0), v);
    c += m.mean.rgb * (1.0 - 0.5 * m.factors.x) * sun * SUN_LIGHT + m.emissive.rgb;
    c = srgb_from_linear(tone_map(c));
    imageStore(ramps, at, vec4(muted ? mute(c) : c, 1.0));
}
