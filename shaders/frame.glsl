// SPDX-License-Identifier: GPL-3.0-or-later
// What holds for a whole picture. "eye" space: axes of the plant frame, origin at the camera, metres. Same layout as render/frame_block.h.
layout(std140, binding = 0) uniform Frame {
    mat4 clip_from_eye;
    mat4 eye_from_clip;
    mat4 sun_from_eye;   // to texture coordinates and depth of the shadow map
    vec4 sun;            // towards the sun; w: size of a texel of the shadow map, in metres
    vec4 up;             // of the plant
    vec4 range;          // MIN, 1/(MAX - MIN), ramp interval/(MAX - MIN) or 0; w: size of a pattern cell, in pixels
    ivec4 look;          // enum look
} frame;

const int LOOK_DEFAULT = 0, LOOK_GLOSSY = 1, LOOK_FLAT = 2;
