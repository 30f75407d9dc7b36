// SPDX-License-Identifier: GPL-3.0-or-later
// What a cut opens, in neutral greys: the inner side of a surface, as round as it is; and, darker and flat, with stripes that lean the
// other way than those of no data, a body that is solid as far as the model says.
#include "constants.glsl"

// v: towards the viewer; n: of the surface, to either side, of any length.
vec3 inside_color(vec3 v, vec3 n)
{
    n *= inversesqrt(max(dot(n, n), 1e-30)) * (dot(n, v) < 0.0 ? -1.0 : 1.0);
    return vec3(INSIDE_RGB) * (INSIDE_LEAST + INSIDE_TOWARDS * dot(n, v) + INSIDE_UP * dot(n, frame.up.xyz));
}

vec3 cap_color()
{
    float phase = fract((gl_FragCoord.x - gl_FragCoord.y) / (CAP_PERIOD * frame.scale.w));
    return vec3(CAP_RGB) - CAP_STRIPE * smoothstep(CAP_STRIPE_FROM, CAP_STRIPE_TO, abs(phase - 0.5));
}
