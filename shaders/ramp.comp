// SPDX-License-Identifier: GPL-3.0-or-later
// For each material, its muted colour at each step of light: what the moving tier looks up.
#include "light.glsl"
#include "material.glsl"
#include "environment.glsl"
#include "pbr.glsl"
layout(local_size_x = 64) in;
layout(rgba8, binding = 0) writeonly uniform image2D ramps;

void main()
{
    ivec2 at = ivec2(gl_GlobalInvocationID.xy), size = imageSize(ramps);
    if (at.x >= size.x)
        return;
    Material m = materials[at.y];
    float light = float(at.x) / float(size.x - 1);
    float sun = max(light - 0.45, 0.0) / 0.55, ambient = (light - 0.48 * sun) / 0.52; // the usual mixture at that light
    vec3 n = vec3(0.0, 0.0, 1.0), v = normalize(vec3(0.7, 0.0, 0.7));
    vec3 c = shade(m.mean.rgb, m.factors.x, max(m.factors.y, 0.6), n, v, n, n, ambient, 0.0, ambient);
    c += m.mean.rgb * (1.0 - 0.5 * m.factors.x) * irradiance(0.0, sun) + m.emissive.rgb;
    imageStore(ramps, at, vec4(mute(srgb_from_linear(tone_map(c))), 1.0));
}
