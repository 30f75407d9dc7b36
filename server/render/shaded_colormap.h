/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Scales as tables, in memory and as textures: what a pixel looks up. In the default look shading adds to CIELAB L* and touches neither
   hue nor chroma, so that it cannot be read as a value. Thread: the one of the GL context. */
#ifndef RENDER_SHADED_COLORMAP_H
#define RENDER_SHADED_COLORMAP_H
#include <stdint.h>

#include <glad/gl.h>

#include "render/view.h"
#include "shaders/constants.glsl"

enum { COLORMAP_ROWS = 65 }; /* steps of light; odd: the middle one leaves the colour alone */
enum { COLORMAP_BELOW = 0, COLORMAP_ABOVE = COLORMAP_PLACES + 1, COLORMAP_PATTERNS };
enum colormap_pattern { PATTERN_HATCH_LIGHT, PATTERN_HATCH_DARK, PATTERN_STIPPLE, PATTERN_PLAIN_LIGHT, PATTERN_PLAIN_DARK, PATTERN_COUNT };
enum { COLORMAP_COLUMNS = COLORMAP_PATTERNS + PATTERN_COUNT };

extern const uint8_t colormap_no_data[2][3];   /* sRGB of the two stripes that mean no data */
extern const uint8_t colormap_no_limits[2][3]; /* of field and lines that mean a tag without limits */
extern const uint8_t colormap_uncertain[3];    /* sRGB of the dots that mean uncertain */

/* A colour map's own colours, then below and above, then the patterns, each in every step of light. */
enum { SHADES_BELOW = 256, SHADES_ABOVE, SHADES_PATTERNS, SHADES_COLORS = SHADES_PATTERNS + PATTERN_COUNT };
struct colormap_shades {
    uint8_t rgb[COLORMAP_ROWS][SHADES_COLORS][3];
};
void colormap_shades_init(const struct colormap *map, struct colormap_shades *out);
struct shaded_colormap {
    uint32_t (*texels)[COLORMAP_COLUMNS]; /* COLORMAP_ROWS: blue | green << 8 | red << 16 | 0xff000000 */
    float *nearest;                       /* for each place of the scale the nearest one that has a line; NULL: there are no lines */
    GLuint colors, lines;                 /* textures of both; lines: 0: none */
    uint64_t version;                     /* another one for each that was made, from 1 */
};
/* Works both out and uploads them. lines: values; line_count may be 0. The caller checks for errors of GL, and finishes it. */
void shaded_colormap_init(struct shaded_colormap *colormap, const struct scale *scale, const struct colormap_shades *shades,
                          const double *lines, int line_count);
void shaded_colormap_finish(struct shaded_colormap *colormap);

#endif
