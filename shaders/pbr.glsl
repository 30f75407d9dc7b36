// SPDX-License-Identifier: GPL-3.0-or-later
// Metallic-roughness shading: one sun (GGX) and the analytic surroundings. Linear colours.

float ggx_visible(float n_l, float n_v, float n_h, float alpha)
{
    float a2 = alpha * alpha;
    float d = n_h * n_h * (a2 - 1.0) + 1.0;
    float v = 0.5 / max(n_l * sqrt(n_v * n_v * (1.0 - a2) + a2) + n_v * sqrt(n_l * n_l * (1.0 - a2) + a2), 1e-4);
    return a2 / (3.14159 * d * d) * v;
}

// Scale and bias of F0 for the surroundings: Karis, "Physically based shading on mobile", 2014.
vec2 environment_brdf(float n_v, float roughness)
{
    vec4 r = roughness * vec4(-1.0, -0.0275, -0.572, 0.022) + vec4(1.0, 0.0425, 1.04, -0.04);
    float a = min(r.x * r.x, exp2(-9.28 * n_v)) * r.x + r.y;
    return vec2(-1.04, 1.04) * a + r.zw;
}

// ambient: sky and ground light 0..1; sun_visible 0..1; occlusion 0..1.
vec3 shade(vec3 base, float metallic, float roughness, vec3 n, vec3 v, vec3 up, vec3 l, float ambient, float sun_visible, float occlusion)
{
    float n_v = max(dot(n, v), 1e-3), n_l = max(dot(n, l), 0.0);
    vec3 h = normalize(v + l);
    vec3 f0 = mix(vec3(0.04), base, metallic), diffuse = base * (1.0 - metallic);
    roughness = clamp(roughness, 0.08, 1.0);
    float alpha = roughness * roughness;
    vec3 fresnel = f0 + (1.0 - f0) * pow(1.0 - max(dot(v, h), 0.0), 5.0);
    vec2 brdf = environment_brdf(n_v, roughness);
    vec3 r = reflect(-v, n);
    vec3 c = diffuse * irradiance(ambient, n_l * sun_visible);
    c += mirrored(dot(r, up), roughness) * (f0 * brdf.x + brdf.y) * occlusion;
    c += fresnel * min(ggx_visible(n_l, n_v, max(dot(n, h), 0.0), alpha), 8.0) * n_l * sun_visible * 0.78;
    return c;
}
