// SPDX-License-Identifier: GPL-3.0-or-later
// Provides the field (value interpolated between sensors) and its flags (no data, uncertain) at a fragment. They are
// interpolated between the triangle's vertices, or computed from all sensors (reference.glsl).
#if defined(PER_FRAGMENT) || defined(PIXEL_FIELD)
#include "reference.glsl"
FIELD_TYPE field_here(FIELD_TYPE interpolated)
{
    vec4 here = reference_field();
#ifndef PIXEL_FIELD
    // Along surfaces, distances are interpolated over the triangle. Therefore places whose error was measured at the vertices stay marked.
    here.z = choice.y != 0 ? max(here.z, interpolated.z) : here.z;
#endif
#ifndef RICH
    return vec3((here.x - frame.scale.x) * frame.scale.y, here.yz);
#elif defined(PIXEL_FIELD)
    return here;
#else
    return vec4(here.xyz, interpolated.w);
#endif
}
#else
FIELD_TYPE field_here(FIELD_TYPE interpolated)
{
    return interpolated;
}
#endif
