// SPDX-License-Identifier: GPL-3.0-or-later
// Fragment shader of refined frames (final quality): physically based shading with all textures of the material. Where a
// surface shows values of sensors, light changes only the lightness of their colours, as in previews.
#include "frame.glsl"
#include "light.glsl"
#include "material.glsl"
#include "environment.glsl"
#include "pbr.glsl"
#include "shadow.glsl"
#include "field.glsl"
layout(location = 0) centroid in vec3 place;
layout(location = 1) centroid in vec3 surface_normal;
layout(location = 2) centroid in vec4 uv; // first and second texture coordinates
layout(location = 3) centroid in vec4 tint;
// light computed in advance by bake.comp: x: ambient light; y: openness (visible fraction of the sky). z: refined.vert writes
// 1; what arrives here differs from 1 by the driver's interpolation error, which dividing by z removes
layout(location = 4) centroid in vec3 sky;
layout(location = 5) centroid in FIELD_TYPE field;
#ifdef PIXEL_FIELD
#define CENTROID_ONE sky.z
#endif
#include "field_source.glsl"
layout(location = 2) uniform int material;
// texture maps of the material, as bits 0 to 4: base colour, metallic-roughness, normal, occlusion, emissive; bits 8 to 12: the map uses
// the second texture coordinates
layout(location = 3) uniform int textures;
layout(binding = 3) uniform sampler2D base_color_map;
layout(binding = 4) uniform sampler2D metallic_roughness_map;
layout(binding = 5) uniform sampler2D normal_map;
layout(binding = 6) uniform sampler2D occlusion_map;
layout(binding = 7) uniform sampler2D emissive_map;
layout(location = 0) out vec4 color;
#ifdef CLIP
#include "section.glsl"
#endif

vec2 uv_of(int map) // returns the texture coordinates of a map, given by its bit in `textures`
{
    return (textures >> 8 & map) != 0 ? uv.zw : uv.xy;
}

// Returns the surface's normal with the normal map applied; tangents come from derivatives of position and texture coordinates.
vec3 mapped_normal(vec3 n, float scale)
{
    vec3 dx = dFdx(place), dy = dFdy(place);
    vec2 on_map = uv_of(4), du = dFdx(on_map), dv = dFdy(on_map);
    vec3 cross_y = cross(dy, n), cross_x = cross(n, dx);
    vec3 t = cross_y * du.x + cross_x * dv.x, b = cross_y * du.y + cross_x * dv.y;
    float size = max(dot(t, t), dot(b, b)), turn = sign(dot(dx, cross_y)); // rows may run downwards
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
    // true: the surface is seen from behind, or its vertex normals point away from the viewer
    bool turned = dot(n, v) < (gl_FrontFacing ? MOST_AWAY : 0.0);
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
// llvmpipe interpolates to the centroid but divides by the depth at the pixel's centre; dividing by sky.z, the interpolated constant 1,
// corrects the error
#ifdef FIELD
    color = vec4(field_color(field_here(field / sky.z), light_scalar(ambient, max(dot(n, l), 0.0) * sun_visible)), 1.0);
#endif
#if !defined(FIELD) || defined(GLOSSY)
    Surface s = Surface(base.rgb, m.factors.x, m.factors.y, n, turned ? max(sky.y, OPEN_BEHIND) : sky.y, sun_visible);
    vec3 glow = m.emissive.rgb;
#ifdef GLOSSY
    s.base = linear_from_srgb(color.rgb);
    // treats a surface that shows values as non-metallic, because a metal would reflect the sky instead of showing the values'
    // colours
    s.metallic = 0.0;
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
#ifdef GLOSSY // limits occlusion, so that colours of the field stay recognisable in dark parts
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
