// SPDX-License-Identifier: GPL-3.0-or-later
// Still tier: all that shading by pixel needs.
#include "frame.glsl"
#include "clip.glsl"
#include "normal.glsl"
layout(location = 0) in vec3 position_m;
layout(location = 1) in vec2 normal; // folded
layout(location = 2) in vec2 texcoord;
layout(location = 3) in vec4 vertex_color;
layout(location = 4) in vec4 baked;
layout(location = 5) in float value;
layout(location = 6) in vec3 flags;
layout(location = 7) in vec2 second_texcoord;
layout(location = 0) uniform mat4 clip_from_file;
layout(location = 1) uniform mat4 eye_from_file;
layout(location = 4) uniform mat3 eye_from_normal;
layout(location = 0) centroid out vec3 place;
layout(location = 1) centroid out vec3 surface_normal;
layout(location = 2) centroid out vec4 uv; // both places on the textures
layout(location = 3) centroid out vec4 tint;
layout(location = 4) centroid out vec3 sky;
layout(location = 5) centroid out FIELD_TYPE field;
#ifdef PER_FRAGMENT
layout(location = 7) out vec3 file_place;
#endif

void main()
{
#ifdef PER_FRAGMENT
    file_place = position_m;
#endif
    gl_Position = clip_from_file * vec4(position_m, 1.0);
#ifdef CLIP
    clip_away();
#endif
    place = (eye_from_file * vec4(position_m, 1.0)).xyz;
    surface_normal = eye_from_normal * unfold_normal(normal);
    uv = vec4(texcoord, second_texcoord);
    tint = vertex_color;
    sky = vec3(baked.yz, baked.w < 0.0 ? 0.0 : 1.0); // 1, and compilers cannot know it: what is known is not interpolated
#ifdef RICH
    field = vec4(value, flags);
#else
    field = vec3((value - frame.scale.x) * frame.scale.y, flags.xy);
#endif
}
