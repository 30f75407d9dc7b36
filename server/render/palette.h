/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Colour maps as textures: a column for each colour, a row for each step of lightness. In the default look shading adds to CIELAB L*
   and touches neither hue nor chroma, so that it cannot be read as a value. Thread: the one of the GL context. */
#ifndef RENDER_PALETTE_H
#define RENDER_PALETTE_H
#include <stdint.h>

#include <glad/gl.h>

#include "field/colormap.h"

#define PALETTE_SHADING 7.0 /* L*, at most, up and down */
enum { PALETTE_ROWS = 65 }; /* odd: the middle one leaves the colour alone */
enum palette_column { PALETTE_BELOW = 256, PALETTE_ABOVE, PALETTE_HATCH_LIGHT, PALETTE_HATCH_DARK, PALETTE_STIPPLE, PALETTE_COLUMNS };

extern const uint8_t palette_no_data[2][3]; /* sRGB of the two stripes that mean no data */
extern const uint8_t palette_uncertain[3];  /* sRGB of the dots that mean uncertain */

/* How far shading may go on this map, in L*: at most PALETTE_SHADING, less on maps where lightness tells much of the value, so that
   the nearest colour of the legend misreads at most 3 % of the range in 95 of 100 shaded colours. */
double palette_amplitude(const struct colormap *map);
/* The colour with `offset` added to its L*, as far as sRGB goes. */
void palette_shade(const uint8_t rgb[3], double offset, uint8_t out[3]);
GLuint palette_create(const struct colormap *map);

#endif
