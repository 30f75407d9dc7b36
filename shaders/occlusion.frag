// SPDX-License-Identifier: GPL-3.0-or-later
// Some of a box lies before all that was drawn: its asset is to be drawn, too.
layout(early_fragment_tests) in;
layout(location = 0) flat in uvec2 commands_here;
struct Command {
    uint count, instances, first_index;
    int base_vertex;
    uint base_instance;
};
layout(std430, binding = 1) buffer Commands { Command commands[]; };

void main()
{
    if (commands[commands_here.x].instances != 0u)
        return;
    for (uint i = 0u; i < commands_here.y; i++)
        commands[commands_here.x + i].instances = 1u;
}
