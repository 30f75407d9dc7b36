// SPDX-License-Identifier: GPL-3.0-or-later
// Clips vertices against the section planes of a view. All vertex shaders output positions in clip space, so the planes are
// given in clip space, too, and all shaders share this code.

// A surface whose depth was drawn first by another program must get the same depth again.
invariant gl_Position;
#ifdef CLIP
out float gl_ClipDistance[6];

void clip_away()
{
    for (int i = 0; i < 6; i++)
        gl_ClipDistance[i] = dot(frame.clip[i], gl_Position);
}
#endif
