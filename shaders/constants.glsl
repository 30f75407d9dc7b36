// SPDX-License-Identifier: GPL-3.0-or-later
// What shaders, render/soft and the page share: render/soft includes this file too, and the build makes the page's of it (deploy/stamp).
// Nothing but numbers, so that it is both GLSL and C.
#ifndef CONSTANTS_GLSL
#define CONSTANTS_GLSL

// Scalar light: of the sky and the ground, and of the sun.
#define LIGHT_AMBIENT 0.52
#define LIGHT_SUN 0.48
// Of what makes white white.
#define SKY_LIGHT 0.55
#define SUN_LIGHT 0.78
// What a dielectric mirrors, looked at head on.
#define CLEAR_F0 0.04
// Khronos PBR Neutral.
#define TONE_START 0.76
#define TONE_DESATURATION 0.15
// Context: so much of the way to an even grey.
#define MUTED_GREY 0.88
#define MUTED_PART 0.48
// Brightness of sRGB.
#define GREY_RED 0.30
#define GREY_GREEN 0.59
#define GREY_BLUE 0.11
// From the eye, cosine of what is smoothed round a rim.
#define MOST_AWAY -0.3
// Openness of what is seen from behind, at least: what is baked is of the other side.
#define OPEN_BEHIND 0.7
// Glossy frames: softer light, so that what lies in shadow keeps a colour that can be named.
#define GLOSSY_OPEN 0.3
#define GLOSSY_SKY 1.45
#define GLOSSY_SUN 0.75
#define GLOSSY_DARKEST 0.22
// The shadow on the ground: of the sun, of the sky, both at most.
#define GROUND_SUN 0.20
#define GROUND_SKY 0.42
#define GROUND_MOST 0.5
// Columns of the colour map: places along the scale from 1 on, what is outside at their ends, then patterns.
#define COLORMAP_PLACES 1024
// Patterns over the field: leaning stripes where there is no data, dots where it is uncertain, level lines where there are no limits. The
// picture's height has so many periods of them, of so many pixels at least; below, parts of a period.
#define PATTERN_PERIODS 90
#define PATTERN_LEAST_PX 6
#define HATCH_SLANT 1.4142
#define HATCH_EDGE 0.25
#define STIPPLE_RADIUS 0.26
#define RULE_EDGE 0.36
// Their greys, of 255.
#define HATCH_LIGHT_GREY 240
#define HATCH_DARK_GREY 150
#define STIPPLE_GREY 64
#define RULE_LIGHT_GREY 226
#define RULE_DARK_GREY 196
// Edges, of what is farther by that part: none, all of it. What is nearer goes on for so many pixels at least, and for all of an edge.
#define EDGE_RGB 0.08, 0.10, 0.14
#define EDGE_MOST 0.5
#define EDGE_FROM 0.006
#define EDGE_TO 0.03
#define EDGE_THIN_PX 3
#define EDGE_WIDE_PX 6
// Isolines: on colours of more brightness than that, and on others.
#define ISOLINE_BRIGHT 0.32
#define ISOLINE_DARK_RGB 0.07, 0.09, 0.12
#define ISOLINE_LIGHT 0.93
#define ISOLINE_MOST 0.8
// Ghosts, over a light backdrop and a dark one: lines where depth falls by that part or bends; level ones.
#define GHOST_ON_LIGHT_RGB 0.20, 0.26, 0.33
#define GHOST_ON_DARK_RGB 0.56, 0.64, 0.72
#define GHOST_FALL_MOST 0.9
#define GHOST_FALL_FROM 0.004
#define GHOST_FALL_TO 0.012
#define GHOST_BEND_MOST 0.55
#define GHOST_BEND_FROM 0.0003
#define GHOST_BEND_TO 0.0009
#define GHOST_LEAST 0.05
#define GHOST_LEVEL 0.4
#define GHOST_LEVEL_PX 10
// The rim of what is selected: a dark line within a white one.
#define RIM_RGB 0.05, 0.09, 0.16
#define RIM_WHITE 0.9
// What a cut opens: the inner side of a surface, brighter the more it faces the viewer and up; a solid body, with darker stripes.
#define INSIDE_RGB 0.40, 0.41, 0.43
#define INSIDE_LEAST 0.72
#define INSIDE_TOWARDS 0.28
#define INSIDE_UP 0.12
#define CAP_RGB 0.36, 0.37, 0.39
#define CAP_STRIPE 0.07
#define CAP_PERIOD 0.9
#define CAP_STRIPE_FROM 0.28
#define CAP_STRIPE_TO 0.40
// Taps of the sun's shadow: texels to the corners of their square, and which way these lie.
#define SUN_SPREAD 1.58
#define SUN_TURN 0.949, 0.316

#endif
