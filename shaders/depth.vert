// SPDX-License-Identifier: GPL-3.0-or-later
// Depth only: shadow maps, and masks of one asset.
layout(location = 0) in vec3 position_m;
layout(location = 0) uniform mat4 clip_from_file;

void main()
{
    gl_Position = clip_from_file * vec4(position_m, 1.0);
}
