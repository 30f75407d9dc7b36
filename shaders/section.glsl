// SPDX-License-Identifier: GPL-3.0-or-later
// What a cut opens: the inner side of a surface, flat and neutral, darker than no data and with faint stripes that lean the other way.
vec3 section_color()
{
    float phase = fract((gl_FragCoord.x - gl_FragCoord.y) / (0.9 * frame.scale.w));
    return mix(vec3(0.36, 0.37, 0.39), vec3(0.31, 0.32, 0.34), smoothstep(0.28, 0.40, abs(phase - 0.5)));
}
