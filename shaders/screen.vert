// SPDX-License-Identifier: GPL-3.0-or-later
// Vertex shader of full-screen passes: one triangle at the far plane that covers the whole frame.
layout(location = 0) out vec2 clip;

void main()
{
    clip = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
    gl_Position = vec4(clip, 0.0, 1.0);
}
