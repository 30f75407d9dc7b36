// SPDX-License-Identifier: GPL-3.0-or-later
// Still tier: physically based shading with every texture of the material; on the field only lightness, as in the moving tier.
#include "frame.glsl"
#include "light.glsl"
#include "material.glsl"
#include "environment.glsl"
#include "pbr.glsl"
#include "shadow.glsl"
#include "field.glsl"
#include "field_source.glsl"
layout(location = 0) centroid in vec3 place;
layout(location = 1) centroid in vec3 surface_normal;
layout(location = 2) centroid in vec4 uv; // both places on the textures
layout(location = 3) centroid in vec4 tint;
layout(location = 4) centroid in vec3 sky; // ambient light and openness, baked; 1, as centroids make it
layout(location = 5) centroid in FIELD_TYPE field;
layout(location = 2) uniform int material;
layout(location = 3) uniform int textures; // bits: base colour, metallic-roughness, normal, occlusion, emissive; from 8 on: second uv
layout(binding = 3) uniform sampler2D base_color_map;
layout(binding = 4) uniform sampler2D metallic_roughness_map;
layout(binding = 5) uniform sampler2D normal_map;
layout(binding = 6) uniform sampler2D occlusion_map;
layout(binding = 7) uniform sampler2D emissive_map;
layout(location = 0) out vec4 color;
#ifdef CLIP
#include "section.glsl"
#endif

vec2 uv_of(int map) // its bit
{
    return (textures >> 8 & map) != 0 ? uv.zw : uv.xy;
}

// The surface's normal with the normal map on it; the tangents come from the derivatives of place and uv.
vec3 mapped_normal(vec3 n, float scale)
{
    vec3 dx = dFdx(place), dy = dFdy(place);
    vec2 on_map = uv_of(4), du = dFdx(on_map), dv = dFdy(on_map);
    vec3 cross_y = cross(dy, n), cross_x = cross(n, dx);
    vec3 t = cross_y * du.x + cross_x * dv.x, b = cross_y * du.y + cross_x * dv.y;
    float size = max(dot(t, t), dot(b, b)), turn = sign(dot(dx, cross_y)); // rows may run downward
    if (size < 1e-20)
        return n;
    vec3 m = texture(normal_map, on_map).xyz * 2.0 - 1.0;
    m.xy *= scale;
    t *= turn * inversesqrt(size), b *= turn * inversesqrt(size);
    return normalize(t * m.x - b * m.y + n * m.z);
}

void main()
{
    vec3 v = frame.back.w > 0.0 ? frame.back.xyz : normalize(-place), n = normalize(surface_normal), l = frame.sun.xyz;
#ifdef CLIP
    if (!gl_FrontFacing) {
        color = vec4(inside_color(v, n), 1.0);
        return;
    }
#endif
    bool turned = dot(n, v) < (gl_FrontFacing ? MOST_AWAY : 0.0); // from behind; or its normals are those of the other side
    if (turned)
        n = -n;
#if defined(TEXTURED) || !defined(FIELD) || defined(GLOSSY)
    Material m = materials[material];
    vec4 base = m.base_color * tint;
#endif
#ifdef TEXTURED
    if ((textures & 1) != 0)
        base *= texture(base_color_map, uv.xy);
    if (base.a < m.emissive.a)
        discard;
#endif
    float sun_visible = sun_visibility(frame.sun_from_eye, place, n, frame.sun.w);
    float ambient = sky.x;
#ifdef FIELD // llvmpipe interpolates to the centroid, but divides by the depth at the middle of the pixel: by what that makes of 1
    color = vec4(field_color(field_here(field / sky.z), light_scalar(ambient, max(dot(n, l), 0.0) * sun_visible)), 1.0);
#endif
#if !defined(FIELD) || defined(GLOSSY)
    Surface s = Surface(base.rgb, m.factors.x, m.factors.y, n, turned ? max(sky.y, OPEN_BEHIND) : sky.y, sun_visible);
    vec3 glow = m.emissive.rgb;
#ifdef GLOSSY
    s.base = linear_from_srgb(color.rgb);
    s.metallic = 0.0; // a mirror would show the sky instead of the field
#endif
#ifdef TEXTURED
    if ((textures & 2) != 0) {
        vec4 t = texture(metallic_roughness_map, uv_of(2));
        s.roughness *= t.g;
        s.metallic *= t.b;
    }
    if ((textures & 4) != 0)
        s.normal = mapped_normal(n, m.factors.z);
    if ((textures & 8) != 0)
        s.open *= mix(1.0, texture(occlusion_map, uv_of(8)).r, m.factors.w);
    if ((textures & 16) != 0)
        glow *= texture(emissive_map, uv_of(16)).rgb;
#endif
#ifdef GLOSSY // likewise in a black part of an occlusion map
    s.open = mix(GLOSSY_OPEN, 1.0, s.open);
    vec3 c = srgb_from_linear(tone_map(GLOSSY_SKY * sky_shade(s, v) + GLOSSY_SUN * sun_shade(s, v, l) + glow));
#else
    vec3 c = srgb_from_linear(tone_map(sky_shade(s, v) + sun_shade(s, v, l) + glow));
#endif
#ifdef GLOSSY
    color.rgb = c;
#else
    color = vec4(frame.up.w > 0.0 ? frame.up.w * mute(c) : c, base.a);
#ifdef RICH
    color.rgb = vec3(grey_of(color.rgb));
#endif
#endif
#endif
}
