// SPDX-License-Identifier: GPL-3.0-or-later
// Transforms the square of ground that receives the plant's shadow.
#include "frame.glsl"
layout(location = 0) uniform mat4 clip_from_ground;
layout(location = 1) uniform mat4 eye_from_ground;
layout(location = 0) out vec2 at;
layout(location = 1) out vec3 place;

void main()
{
    at = vec2(gl_VertexID & 1, gl_VertexID >> 1);
    gl_Position = clip_from_ground * vec4(at, 0.0, 1.0);
    place = (eye_from_ground * vec4(at, 0.0, 1.0)).xyz;
}
