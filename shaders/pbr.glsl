// SPDX-License-Identifier: GPL-3.0-or-later
// glTF 2.0 metallic-roughness shading with one sun and image-based light. Linear colours. Energy lost between microfacets is added back:
// Fdez-Aguera, "A multiple-scattering microfacet model for real-time image-based lighting", 2019.

float ggx_visible(float n_l, float n_v, float n_h, float alpha)
{
    float a2 = alpha * alpha;
    float d = n_h * n_h * (a2 - 1.0) + 1.0;
    float v = 0.5 / max(n_l * sqrt(n_v * n_v * (1.0 - a2) + a2) + n_v * sqrt(n_l * n_l * (1.0 - a2) + a2), 1e-4);
    return a2 / (d * d) * v; // times pi
}

struct Surface {
    vec3 base;
    float metallic, roughness;
    vec3 normal;
    float open;        // fraction of the sky above the surface that no asset hides, 0..1
    float sun_visible; // visible fraction of the sun, 0..1
};

// Returns the fraction of uniform light that leaves the surface after more than one reflection between microfacets.
vec3 reflected_more(vec3 f0, vec2 brdf)
{
    float lost = 1.0 - brdf.x - brdf.y;
    vec3 mean = f0 + (1.0 - f0) / 21.0;
    return (f0 * brdf.x + brdf.y) * mean / (1.0 - lost * mean) * lost;
}

vec3 sky_shade(Surface s, vec3 v)
{
    float n_v = clamp(dot(s.normal, v), 0.0, 1.0);
    vec2 brdf = textureLod(brdf_map, vec2(n_v, s.roughness), 0.0).rg;
    vec3 f0 = mix(vec3(CLEAR_F0), s.base, s.metallic), diffuse = s.base * (1.0 - s.metallic);
    vec3 clear = reflected_more(vec3(CLEAR_F0), brdf), more = mix(clear, reflected_more(s.base, brdf), s.metallic);
    vec3 once = f0 * brdf.x + brdf.y;
    vec3 soft = (more + diffuse * (1.0 - CLEAR_F0 * brdf.x - brdf.y - clear)) * sky_irradiance(s.normal);
    return (soft + once * mirrored(mix(reflect(-v, s.normal), s.normal, s.roughness * s.roughness), s.roughness)) * (SKY_LIGHT * s.open);
}

vec3 sun_shade(Surface s, vec3 v, vec3 l)
{
    float n_v = max(dot(s.normal, v), 1e-3), n_l = max(dot(s.normal, l), 0.0), roughness = max(s.roughness, 0.1);
    vec3 h = normalize(v + l);
    vec3 f0 = mix(vec3(CLEAR_F0), s.base, s.metallic), diffuse = s.base * (1.0 - s.metallic);
    float x = 1.0 - max(dot(v, h), 0.0), x2 = x * x;
    float grazing = x2 * x2 * x;
    // fraction of the light that the surface mirrors; only the remaining light is reflected diffusely
    vec3 fresnel = f0 + (1.0 - f0) * grazing;
    float mirror = min(ggx_visible(n_l, n_v, max(dot(s.normal, h), 0.0), roughness * roughness), 50.0);
    vec3 c = diffuse * (0.96 - 0.96 * grazing) + fresnel * mirror;
    return c * (n_l * s.sun_visible * SUN_LIGHT);
}
