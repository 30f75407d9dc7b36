// SPDX-License-Identifier: GPL-3.0-or-later
// Image-based light (render/light/environments.c), scaled so that a level white surface under the open sky reflects 1. Directions are in
// plant axes.
#include "constants.glsl"
layout(std140, binding = 1) uniform Environment {
    vec4 irradiance_terms[9];
};
layout(binding = 8) uniform sampler3D mirrored_map; // octahedral map; third coordinate: roughness
// lookup table by cosine to the viewer and by roughness: the reflected fraction is x * F0 + y (F0: reflectance at normal
// incidence)
layout(binding = 9) uniform sampler2D brdf_map;

// Returns the light that a white, matt surface with the normal n reflects (irradiance divided by pi).
vec3 sky_irradiance(vec3 n)
{
    vec3 e = irradiance_terms[0].rgb + irradiance_terms[1].rgb * n.y + irradiance_terms[2].rgb * n.z + irradiance_terms[3].rgb * n.x;
    e += irradiance_terms[4].rgb * (n.x * n.y) + irradiance_terms[5].rgb * (n.y * n.z) + irradiance_terms[6].rgb * (3.0 * n.z * n.z - 1.0);
    e += irradiance_terms[7].rgb * (n.x * n.z) + irradiance_terms[8].rgb * (n.x * n.x - n.y * n.y);
    return max(e, vec3(0.0));
}

// Returns the brightness of the sky that the surface faces, 0 to about 1.
float sky_brightness(vec3 n)
{
    return clamp(dot(sky_irradiance(n), vec3(0.2126, 0.7152, 0.0722)), 0.0, 1.0);
}

// Returns the light around the mirrored view direction r, prefiltered over the directions that a surface of this roughness
// reflects.
vec3 mirrored(vec3 r, float roughness)
{
    const float side = 128.0, layers = 8.0;
    vec3 a = abs(r);
    vec2 p = r.xy / (a.x + a.y + a.z);
    if (r.z < 0.0)
        p = (1.0 - abs(p.yx)) * vec2(p.x >= 0.0 ? 1.0 : -1.0, p.y >= 0.0 ? 1.0 : -1.0);
    p = (p * 0.5 + 0.5) * ((side - 1.0) / side) + 0.5 / side;
    return textureLod(mirrored_map, vec3(p, (roughness * (layers - 1.0) + 0.5) / layers), 0.0).rgb;
}
