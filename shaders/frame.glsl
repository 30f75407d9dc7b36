// SPDX-License-Identifier: GPL-3.0-or-later
// Uniforms of a frame. Eye space: axes of the plant frame, origin at the camera, metres. The layout must match render/gl/frame_uniforms.h.
layout(std140, binding = 0) uniform Frame {
    mat4 clip_from_eye;
    mat4 eye_from_clip;
    mat4 sun_from_eye;   // matrix from eye space to texture coordinates and depth of the shadow map
    vec4 sun;            // unit vector towards the sun; w: texel size of the shadow map in metres
    // the plant's up direction; w: factor on the brightness of assets without values of sensors, which are muted (paled); 0:
    // they are not muted
    vec4 up;
    // colour scale: x: MIN, y: 1/(MAX - MIN); z: 1 if the scale is logarithmic (x and y are then computed from binary logarithms), else 0;
    // w: cell size of patterns in pixels
    vec4 scale;
    vec4 shade;          // row of the colour map for a surface's brightness b: min(b * x + y, z)
    // x: width of isolines in pixels, 0: none; y: index of the first row of this backdrop's colours in the texture of backdrops
    vec4 lines;
    // direction of the viewer in an orthographic frame: unit vector; w: distance between near and far plane, divided by the
    // viewing distance. Perspective: all 0
    vec4 back;
    vec4 clip[6];        // section planes in clip space
} frame;

// Type of the field (value interpolated between sensors) and its flags, which vertex shaders pass to fragment shaders
// (field_color() in shaders/field.glsl). RICH is defined for isolines, a logarithmic scale and the operator's display (values
// relative to alarm limits).
#ifdef RICH
#define FIELD_TYPE vec4
#else
#define FIELD_TYPE vec3
#endif
