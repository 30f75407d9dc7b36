// SPDX-License-Identifier: GPL-3.0-or-later
// What a cut opens, in neutral greys: the inner side of a surface, as round as it is; and, darker and flat, with stripes that lean the
// other way than those of no data, a body that is solid as far as the model says.
// v: towards the viewer; n: of the surface, to either side, of any length.
vec3 inside_color(vec3 v, vec3 n)
{
    n *= inversesqrt(max(dot(n, n), 1e-30)) * (dot(n, v) < 0.0 ? -1.0 : 1.0);
    return vec3(0.40, 0.41, 0.43) * (0.72 + 0.28 * dot(n, v) + 0.12 * dot(n, frame.up.xyz));
}

vec3 cap_color()
{
    float phase = fract((gl_FragCoord.x - gl_FragCoord.y) / (0.9 * frame.scale.w));
    return mix(vec3(0.36, 0.37, 0.39), vec3(0.29, 0.30, 0.32), smoothstep(0.28, 0.40, abs(phase - 0.5)));
}
