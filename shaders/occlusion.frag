// SPDX-License-Identifier: GPL-3.0-or-later
// Occlusion culling: runs only for visible fragments of an asset's bounding box, and enables the asset's draw commands in the command
// buffer.
layout(early_fragment_tests) in;
// index of the asset's first draw command in the command buffer, and number of its commands
layout(location = 0) flat in uvec2 commands_here;
struct Command {
    uint count, instances, first_index;
    int base_vertex;
    uint base_instance;
};
layout(std430, binding = 1) buffer Commands { Command commands[]; };
layout(std430, binding = 2) readonly buffer Places { uint places[]; };

void main()
{
    if (commands_here.y == 0u || commands[places[commands_here.x]].instances != 0u)
        return;
    for (uint i = 0u; i < commands_here.y; i++)
        commands[places[commands_here.x + i]].instances = 1u;
}
