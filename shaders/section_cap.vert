// SPDX-License-Identifier: GPL-3.0-or-later
// Transforms the vertices of closed bodies and clips them by the section planes, for section_cap_count.frag.
#include "frame.glsl"
#include "clip.glsl"
layout(location = 0) in vec3 position_m;
layout(location = 0) uniform mat4 clip_from_file;

void main()
{
    gl_Position = clip_from_file * vec4(position_m, 1.0);
    clip_away();
}
