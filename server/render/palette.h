/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Scales as textures: what a pixel looks up. In the default look shading adds to CIELAB L* and touches neither hue nor chroma, so that
   it cannot be read as a value. Thread: the one of the GL context. */
#ifndef RENDER_PALETTE_H
#define RENDER_PALETTE_H
#include <stdint.h>

#include <glad/gl.h>

#include "render/view.h"

enum { PALETTE_ROWS = 65 }; /* steps of light; odd: the middle one leaves the colour alone */
/* Columns of the texture, as in shaders/field.glsl: PALETTE_PLACES along the scale, what is outside at their ends, patterns behind. */
enum { PALETTE_PLACES = 1024, PALETTE_BELOW = 0, PALETTE_ABOVE = PALETTE_PLACES + 1, PALETTE_PATTERNS };
enum palette_pattern { PATTERN_HATCH_LIGHT, PATTERN_HATCH_DARK, PATTERN_STIPPLE, PATTERN_PLAIN_LIGHT, PATTERN_PLAIN_DARK, PATTERN_COUNT };
enum { PALETTE_COLUMNS = PALETTE_PATTERNS + PATTERN_COUNT };

extern const uint8_t palette_no_data[2][3]; /* sRGB of the two stripes that mean no data */
extern const uint8_t palette_no_limits[2][3]; /* of field and lines that mean a tag without limits */
extern const uint8_t palette_uncertain[3];  /* sRGB of the dots that mean uncertain */

/* A colour map's own colours, then below and above, then the patterns, each in every step of light. */
enum { SHADED_BELOW = 256, SHADED_ABOVE, SHADED_PATTERNS, SHADED_COLORS = SHADED_PATTERNS + PATTERN_COUNT };
struct shaded {
    uint8_t rgb[PALETTE_ROWS][SHADED_COLORS][3];
};
void palette_shade_map(const struct colormap *map, struct shaded *out);
/* Colours by place and light; 0: out of memory. */
GLuint palette_create(const struct scale *scale, const struct shaded *shaded);
/* For each place of the scale the nearest place that has a line (R32F). */
GLuint palette_create_lines(const struct scale *scale, const double *lines, int count);

#endif
