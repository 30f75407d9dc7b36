// SPDX-License-Identifier: GPL-3.0-or-later
// For tests: writes numbers instead of a colour: position of the pixel's value in the range (0..1), share of no data (-1: the
// asset has no values of sensors), share of uncertain, and depth.
#include "frame.glsl"
#ifdef FIELD
#ifdef REFINED
layout(location = 5) centroid in vec3 field;
#else
layout(location = 1) in vec3 field;
#endif
#include "field_source.glsl"
#endif
layout(location = 0) out vec4 measured;

void main()
{
#ifdef FIELD
    measured = vec4(field_here(field), gl_FragCoord.z);
#else
    measured = vec4(0.0, -1.0, 0.0, gl_FragCoord.z); // an asset without a field
#endif
}
