// SPDX-License-Identifier: GPL-3.0-or-later
// Clips vertices against the section planes of a view. The planes are given in clip space, so all vertex shaders can use the same planes.
#ifdef CLIP
out float gl_ClipDistance[6];

void clip_away()
{
    for (int i = 0; i < 6; i++)
        gl_ClipDistance[i] = dot(frame.clip[i], gl_Position);
}
#endif
