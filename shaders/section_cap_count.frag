// SPDX-License-Identifier: GPL-3.0-or-later
// Counts the bodies that contain the start of a pixel's view ray, for section caps: outputs +1 where the ray leaves a body and
// -1 where it enters one; blending adds up all surfaces along the ray. A positive sum means that the ray began inside a body.
layout(location = 0) out float bodies;

void main()
{
    bodies = gl_FrontFacing ? -1.0 : 1.0;
}
