// SPDX-License-Identifier: GPL-3.0-or-later
// Summed up over all that a pixel's ray meets: 1 where it leaves a body, -1 where it comes into one. What is left over is what it was in
// from the beginning.
layout(location = 0) out float bodies;

void main()
{
    bodies = gl_FrontFacing ? -1.0 : 1.0;
}
