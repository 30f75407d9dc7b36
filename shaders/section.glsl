// SPDX-License-Identifier: GPL-3.0-or-later
// What a cut opens, flat and neutral: the inner side of a surface; and, darker, with stripes that lean the other way than those of
// no data, a body that is solid as far as the model says.
const vec3 INSIDE = vec3(0.40, 0.41, 0.43);

vec3 cap_color()
{
    float phase = fract((gl_FragCoord.x - gl_FragCoord.y) / (0.9 * frame.scale.w));
    return mix(vec3(0.36, 0.37, 0.39), vec3(0.29, 0.30, 0.32), smoothstep(0.28, 0.40, abs(phase - 0.5)));
}
