// SPDX-License-Identifier: GPL-3.0-or-later
// Added up over all surfaces along a pixel's ray: +1 where the ray leaves a body, -1 where it enters one. A positive sum means that the ray
// began inside a body.
layout(location = 0) out float bodies;

void main()
{
    bodies = gl_FrontFacing ? -1.0 : 1.0;
}
