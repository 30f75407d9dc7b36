// SPDX-License-Identifier: GPL-3.0-or-later
// Marks what it covers.
layout(location = 0) out vec4 mark;

void main()
{
    mark = vec4(1.0);
}
