// SPDX-License-Identifier: GPL-3.0-or-later
// Where the field at a fragment comes from: interpolated between vertices, or worked out here.
#ifdef PER_FRAGMENT
#include "reference.glsl"
vec3 field_here(vec3 interpolated)
{
    vec3 here = reference_field();
#ifndef RICH
    here.x = (here.x - frame.scale.x) * frame.scale.y;
#endif
    return here;
}
#else
vec3 field_here(vec3 interpolated)
{
    return interpolated;
}
#endif
