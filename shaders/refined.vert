// SPDX-License-Identifier: GPL-3.0-or-later
// Vertex shader of refined frames (final quality): outputs position, normal, texture coordinates, light baked by bake.comp and
// the value interpolated between sensors, for shading in refined.frag.
#include "frame.glsl"
#include "clip.glsl"
#include "instance.glsl"
#include "normal.glsl"
layout(location = 0) in vec3 position_m;
layout(location = 1) in vec2 normal; // packed as in normal.glsl
layout(location = 2) in vec2 texcoord;
layout(location = 3) in vec4 vertex_color;
layout(location = 7) in vec2 second_texcoord;
layout(location = 0) centroid out vec3 place;
layout(location = 1) centroid out vec3 surface_normal;
layout(location = 2) centroid out vec4 uv; // first and second texture coordinates
layout(location = 3) centroid out vec4 tint;
layout(location = 4) centroid out vec3 sky;
layout(location = 5) centroid out FIELD_TYPE field;
#ifdef PIXEL_FIELD
layout(location = 7) centroid out vec3 interpolated_place;
#elif defined(PER_FRAGMENT)
layout(location = 7) out vec3 interpolated_place;
#endif

void main()
{
#if defined(PER_FRAGMENT) || defined(PIXEL_FIELD)
    interpolated_place = position_m;
#endif
    gl_Position = clip_from_file * vec4(position_m, 1.0);
#ifdef CLIP
    clip_away();
#endif
    place = vec4(position_m, 1.0) * from_file;
    surface_normal = unfold_normal(normal) * mat3(eye_from_normal);
    uv = vec4(texcoord, second_texcoord);
    tint = vertex_color;
    vec4 baked = light_here();
    // z is always 1, because baked.w is never negative. The compiler must not know this: it would not interpolate a constant
    sky = vec3(baked.yz, baked.w < 0.0 ? 0.0 : 1.0);
    field = scalar_here();
}
