// SPDX-License-Identifier: GPL-3.0-or-later
// Colours of section cuts, in neutral greys: the inner side of a surface, shaded; and section caps of closed bodies, darker and flat, with
// stripes that slant the opposite way to the stripes that mean "no data".
#include "constants.glsl"

// Returns the colour of a surface's inner side. v: unit vector towards the viewer; n: normal of any length and sign.
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
