/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shaded colour maps: lookup tables of a scale's colours, in memory and as textures. In the default look, shading changes only
   CIELAB L* and neither hue nor chroma, so that a viewer cannot mistake shading for another value. Call only in the thread that
   owns the GL context. */
#ifndef RENDER_SHADED_COLORMAP_H
#define RENDER_SHADED_COLORMAP_H
#include <stdint.h>

#include <glad/gl.h>

#include "render/view.h"
#include "shaders/constants.glsl"

enum { COLORMAP_ROWS = 65 }; /* number of brightness steps; odd, so that the middle step leaves the colour unchanged */
enum { COLORMAP_BELOW = 0, COLORMAP_ABOVE = COLORMAP_PLACES + 1, COLORMAP_PATTERNS };
enum colormap_pattern { PATTERN_HATCH_LIGHT, PATTERN_HATCH_DARK, PATTERN_STIPPLE, PATTERN_PLAIN_LIGHT, PATTERN_PLAIN_DARK, PATTERN_COUNT };
enum { COLORMAP_COLUMNS = COLORMAP_PATTERNS + PATTERN_COUNT };

extern const uint8_t colormap_no_data[2][3];   /* sRGB colours of light and dark stripes of the hatch that marks places without data */
/* sRGB colours of background and lines of the pattern that marks tags without alarm limits */
extern const uint8_t colormap_no_limits[2][3];
extern const uint8_t colormap_uncertain[3];    /* sRGB colour of the dots that mark uncertain values */

/* Columns of colormap_shades: the map's 256 colours, the colour below the range, the colour above it, then the colours of patterns. Each
   row is one brightness step. */
enum { SHADES_BELOW = 256, SHADES_ABOVE, SHADES_PATTERNS, SHADES_COLORS = SHADES_PATTERNS + PATTERN_COUNT };
struct colormap_shades {
    uint8_t rgb[COLORMAP_ROWS][SHADES_COLORS][3];
};
void colormap_shades_init(const struct colormap *map, struct colormap_shades *out);
struct shaded_colormap {
    /* colours of the scale, one row per brightness step: blue | green << 8 | red << 16 | 0xff000000 */
    uint32_t (*texels)[COLORMAP_COLUMNS];
    float *nearest;       /* for each position on the scale, the nearest position that has an isoline; NULL: there are no isolines */
    GLuint colors, lines; /* colors: texture of `texels`; lines: texture of `nearest`, 0: there are no isolines */
    uint64_t version;     /* sequence number of the colour map, from 1 up, unique among all shaded colour maps made so far */
};
/* Computes the tables `texels` and `nearest`, and uploads them as textures. lines: values of isolines; line_count may be 0. The caller
   checks for GL errors and calls shaded_colormap_finish(). */
void shaded_colormap_init(struct shaded_colormap *colormap, const struct scale *scale, const struct colormap_shades *shades,
                          const double *lines, int line_count);
void shaded_colormap_finish(struct shaded_colormap *colormap);

#endif
