// SPDX-License-Identifier: GPL-3.0-or-later
// Vertex shader of previews, the frames in lower quality: outputs position, baked light and, for assets with sensors, the value
// interpolated between them. Keep it short, because Mesa's software driver llvmpipe runs vertex shaders on one thread.
#include "frame.glsl"
#include "clip.glsl"
#include "instance.glsl"
layout(location = 0) in vec3 position_m;
#ifdef FIELD
layout(location = 0) out float light;
layout(location = 1) out FIELD_TYPE field;
#else
layout(location = 0) out vec2 light; // light computed in advance (bake.comp) at the vertex: ambient light, cosine of the angle to the sun
layout(location = 1) out vec3 sun_place;
#endif
#ifdef CLIP
layout(location = 6) out vec3 place;
#endif
#if defined(PER_FRAGMENT) || defined(PIXEL_FIELD)
layout(location = 7) out vec3 interpolated_place;
#endif
#ifdef TEXTURED
layout(location = 2) in vec2 texcoord;
layout(location = 3) in vec4 vertex_color;
layout(location = 2) out vec3 hole; // texture coordinates, alpha
#endif

void main()
{
#if defined(PER_FRAGMENT) || defined(PIXEL_FIELD)
    interpolated_place = position_m;
#endif
    gl_Position = clip_from_file * vec4(position_m, 1.0);
#ifdef TEXTURED
    hole = vec3(texcoord, vertex_color.a);
#endif
#ifdef CLIP
    clip_away();
    place = (frame.eye_from_clip * gl_Position).xyz;
#endif
    vec4 baked = light_here();
#ifdef FIELD
    light = baked.x;
    field = scalar_here();
#else
    light = baked.yw;
    sun_place = vec4(position_m, 1.0) * from_file;
#endif
}
