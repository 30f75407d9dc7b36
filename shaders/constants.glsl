// SPDX-License-Identifier: GPL-3.0-or-later
// Constants shared by shaders, render/soft (which includes this file) and the page (deploy/stamp generates its copy). Contains only
// #defines, so that the file is valid GLSL and C.
#ifndef CONSTANTS_GLSL
#define CONSTANTS_GLSL

// A surface's brightness is LIGHT_AMBIENT times the light that it gets from sky and ground, plus LIGHT_SUN times its sunlight
// (light_scalar() in light.glsl).
#define LIGHT_AMBIENT 0.52
#define LIGHT_SUN 0.48
// Factors by which the light of the sky and the light of the sun are multiplied in physically based shading (pbr.glsl).
#define SKY_LIGHT 0.55
#define SUN_LIGHT 0.78
// Reflectance of a dielectric at normal incidence.
#define CLEAR_F0 0.04
// Parameters of the Khronos PBR Neutral tone mapper: brightness above which it compresses, and rate at which compressed colours
// turn white.
#define TONE_START 0.76
#define TONE_DESATURATION 0.15
// Assets without values of sensors are muted: their colour is reduced to a grey, which is then mixed with the light grey
// MUTED_GREY, whose share is MUTED_PART.
#define MUTED_GREY 0.88
#define MUTED_PART 0.48
// Weights of the sRGB channels when a colour is reduced to a grey.
#define GREY_RED 0.30
#define GREY_GREEN 0.59
#define GREY_BLUE 0.11
// A vertex normal is flipped towards the viewer if the cosine of its angle to the direction of the viewer is less than this. At
// smoothed rims, slightly negative cosines are expected.
#define MOST_AWAY -0.3
// Minimum openness (visible fraction of the sky, 0..1) of surfaces seen from behind, because the baked openness applies to the
// front.
#define OPEN_BEHIND 0.7
// Light in the glossy look (physically based shading of the value colours), softer than usual so that the colours stay
// recognisable in shadow. GLOSSY_OPEN: minimum openness (visible fraction of the sky); GLOSSY_SKY, GLOSSY_SUN: factors on the
// light of sky and sun in refined frames (final quality); GLOSSY_DARKEST: added to the brightness in previews.
#define GLOSSY_OPEN 0.3
#define GLOSSY_SKY 1.45
#define GLOSSY_SUN 0.75
#define GLOSSY_DARKEST 0.22
// Strength of the ground's shadow: from the sun, from the sky, and the maximum of their sum.
#define GROUND_SUN 0.20
#define GROUND_SKY 0.42
#define GROUND_MOST 0.5
// Columns of the colour map: column 0 is for values below MIN, columns 1 to COLORMAP_PLACES are positions on the scale, the next is for
// values above MAX, then the colours of patterns.
#define COLORMAP_PLACES 1024
// Patterns drawn over the colours of values: diagonal stripes for no data, dots for uncertain, horizontal lines for no alarm
// limits. A cell (one period of a pattern) has 1/PATTERN_PERIODS of the picture's height, but at least PATTERN_LEAST_PX pixels;
// the following sizes are fractions of a cell.
#define PATTERN_PERIODS 90
#define PATTERN_LEAST_PX 6
#define HATCH_SLANT 1.4142
#define HATCH_EDGE 0.25
#define STIPPLE_RADIUS 0.26
#define RULE_EDGE 0.36
// Greys of the patterns, 0 to 255.
#define HATCH_LIGHT_GREY 240
#define HATCH_DARK_GREY 150
#define STIPPLE_GREY 64
#define RULE_LIGHT_GREY 226
#define RULE_DARK_GREY 196
// Feature edges (dark lines at steps of depth): colour, maximum opacity, and the relative depth steps at which a line begins
// and reaches that opacity. The nearer surface must be at least EDGE_THIN_PX pixels wide; from EDGE_WIDE_PX on, the line has
// full opacity.
#define EDGE_RGB 0.08, 0.10, 0.14
#define EDGE_MOST 0.5
#define EDGE_FROM 0.006
#define EDGE_TO 0.03
#define EDGE_THIN_PX 3
#define EDGE_WIDE_PX 6
// Isolines are dark on colours brighter than ISOLINE_BRIGHT, light on others.
#define ISOLINE_BRIGHT 0.32
#define ISOLINE_DARK_RGB 0.07, 0.09, 0.12
#define ISOLINE_LIGHT 0.93
#define ISOLINE_MOST 0.8
// Ghosted (transparent) assets are drawn as lines, in one colour over a light backdrop and another over a dark one. FALL: lines
// where depth has a step, BEND: lines at creases. MOST: maximum opacity; FROM, TO: relative change of depth at which a line
// begins and reaches that opacity. GHOST_LEAST: fainter lines are not drawn. GHOST_LEVEL: opacity of thin horizontal lines
// every GHOST_LEVEL_PX pixels.
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
// Outline of the selected asset: colour of the dark line, and opacity of the white line around it.
#define RIM_RGB 0.05, 0.09, 0.16
#define RIM_WHITE 0.9
// Section cuts. INSIDE: colour of a surface's inner side, its minimum brightness, and how much brighter it is towards the
// viewer and upwards. CAP: colour of section caps (cut faces), and how much darker their stripes are.
#define INSIDE_RGB 0.40, 0.41, 0.43
#define INSIDE_LEAST 0.72
#define INSIDE_TOWARDS 0.28
#define INSIDE_UP 0.12
#define CAP_RGB 0.36, 0.37, 0.39
#define CAP_STRIPE 0.07
#define CAP_PERIOD 0.9
#define CAP_STRIPE_FROM 0.28
#define CAP_STRIPE_TO 0.40
// Lookups in the sun's shadow map: distance of the four samples in texels, and cosine and sine of the rotation of their square.
#define SUN_SPREAD 1.58
#define SUN_TURN 0.949, 0.316

#endif
