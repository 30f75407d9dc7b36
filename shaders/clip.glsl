// SPDX-License-Identifier: GPL-3.0-or-later
// Cuts away what lies outside the planes of a clipped picture. They are in clip space, so that it does not matter how a vertex got there.
#ifdef CLIP
out float gl_ClipDistance[6];

void clip_away()
{
    for (int i = 0; i < 6; i++)
        gl_ClipDistance[i] = dot(frame.clip[i], gl_Position);
}
#endif
