// SPDX-License-Identifier: GPL-3.0-or-later
// Vertex shader of the backdrop: one triangle at the far plane that covers the whole frame; outputs the view ray of each pixel.
#include "frame.glsl"
layout(location = 0) out vec3 ray;

void main()
{
    vec2 clip = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
    vec4 near = frame.eye_from_clip * vec4(clip, 1.0, 1.0);
    ray = frame.back.w > 0.0 ? -frame.back.xyz : near.xyz / near.w;
    gl_Position = vec4(clip, 0.0, 1.0);
}
