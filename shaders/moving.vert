// SPDX-License-Identifier: GPL-3.0-or-later
// Moving tier: a place, a baked light and, on assets with a field, a scalar. llvmpipe runs this on one thread: keep it short.
#include "frame.glsl"
#include "clip.glsl"
layout(location = 0) in vec3 position_m;
layout(location = 4) in vec4 baked;
layout(location = 5) in float value;
layout(location = 6) in vec3 flags;
layout(location = 0) uniform mat4 clip_from_file;
layout(location = 1) uniform mat4 sun_from_file; // texture coordinates and depth of the shadow map
#ifdef FIELD
layout(location = 0) out float light;
layout(location = 1) out FIELD_TYPE field;
#else
layout(location = 0) out vec2 light; // ambient, facing the sun
layout(location = 1) out vec3 sun_place;
#endif
#ifdef CLIP
layout(location = 6) out vec3 place;
#endif
#ifdef PER_FRAGMENT
layout(location = 7) out vec3 file_place;
#endif
#ifdef TEXTURED
layout(location = 2) in vec2 texcoord;
layout(location = 3) in vec4 vertex_color;
layout(location = 2) out vec3 hole; // place on the texture, alpha
#endif

void main()
{
#ifdef PER_FRAGMENT
    file_place = position_m;
#endif
    gl_Position = clip_from_file * vec4(position_m, 1.0);
#ifdef TEXTURED
    hole = vec3(texcoord, vertex_color.a);
#endif
#ifdef CLIP
    clip_away();
    place = (frame.eye_from_clip * gl_Position).xyz;
#endif
#ifdef FIELD
    light = baked.x;
#ifdef RICH
    field = vec4(value, flags);
#else
    field = vec3((value - frame.scale.x) * frame.scale.y, flags.xy);
#endif
#else
    light = baked.yw;
    sun_place = (sun_from_file * vec4(position_m, 1.0)).xyz;
#endif
}
