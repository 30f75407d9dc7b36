// SPDX-License-Identifier: GPL-3.0-or-later
// What holds for a whole picture. "eye" space: axes of the plant frame, origin at the camera, metres. Same layout as
// render/gl/frame_uniforms.h.
layout(std140, binding = 0) uniform Frame {
    mat4 clip_from_eye;
    mat4 eye_from_clip;
    mat4 sun_from_eye;   // to texture coordinates and depth of the shadow map
    vec4 sun;            // towards the sun; w: size of a texel of the shadow map, in metres
    vec4 up;             // of the plant; w: brightness of assets without a field, which are muted; 0: they are not
    vec4 scale;          // linear: MIN, 1/(MAX - MIN); of the binary logarithms on a logarithmic scale, where z is 1; w: size of a
                         // pattern cell, in pixels
    vec4 shade;          // row of the colormap = light * x + y, at most z
    vec4 lines;          // width of isolines in pixels; 0: none; y: first row of the backdrop
    vec4 back;           // orthographic: towards the viewer; w: of depth, to what perspective would give. 0: perspective
    vec4 clip[6];        // planes that cut, in clip space
} frame;

// The field from vertices to pixels: shaders/field.glsl.
#ifdef RICH
#define FIELD_TYPE vec4
#else
#define FIELD_TYPE vec3
#endif
