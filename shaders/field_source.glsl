// SPDX-License-Identifier: GPL-3.0-or-later
// Provides the field at a fragment: interpolated between vertices, or computed from all sensors (reference.glsl).
#ifdef PER_FRAGMENT
#include "reference.glsl"
FIELD_TYPE field_here(FIELD_TYPE interpolated)
{
    vec3 here = reference_field();
#ifdef RICH
    return vec4(here, interpolated.w);
#else
    here.x = (here.x - frame.scale.x) * frame.scale.y;
    return here;
#endif
}
#else
FIELD_TYPE field_here(FIELD_TYPE interpolated)
{
    return interpolated;
}
#endif
