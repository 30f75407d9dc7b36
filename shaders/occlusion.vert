// SPDX-License-Identifier: GPL-3.0-or-later
// Occlusion culling (render/gl/occlusion.h): draws the bounding boxes of assets, each as a triangle strip of 14 vertices.
layout(location = 0) in mat4 clip_from_box; // maps the unit cube to clip space
layout(location = 4) in uvec2 commands_of;
// index of the asset's first draw command in the command buffer, and number of its commands
layout(location = 0) flat out uvec2 commands_here;

void main()
{
    int corner = 1 << gl_VertexID;
    gl_Position = clip_from_box * vec4((0x287a & corner) != 0, (0x02af & corner) != 0, (0x31e3 & corner) != 0, 1.0);
    commands_here = commands_of;
}
