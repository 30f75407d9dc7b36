/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Colour scale: the mapping from values to colours of a colour map. Legends, frames and clients use the same rules: - Position
   of a value: (value - MIN)/(MAX - MIN), or log(value/MIN)/log(MAX/MIN) on a logarithmic scale. - Colours: values below MIN and
   above MAX have colours of their own. Other values have the colour with index min(255, floor(256 position)); neighbouring
   colours are never mixed. - Bands of equal width (`interval`): band k begins at MIN + k interval, for k < max(1, ceil((MAX -
   MIN)/interval - 0.001)). MAX may make the last band shorter. A band has the colour at the middle of its positions. - Bands
   between `breaks`: n breaks inside (MIN, MAX) make n + 1 bands. Band i has the colour at the position (i + 0.5)/(n + 1). MIN,
   MAX and value are compared as 32-bit floats, because they are stored as such. Pure. Call from any thread. */
#ifndef FIELD_SCALE_H
#define FIELD_SCALE_H
#include <stdbool.h>

#include "base/color/colormap.h"
#include "plant/plant.h"

enum { SCALE_BREAKS = PLANT_BREAKS, SCALE_EDGES = 64 };
struct scale {
    const struct colormap *map;
    double min, max; /* ends of the scale: min < max, and both above 0 if the scale is logarithmic (`log`) */
    bool log;
    double interval;             /* width of bands; 0: none */
    double breaks[SCALE_BREAKS]; /* ascending values that separate the bands of colour; they replace `interval` */
    int break_count;
};
enum { SCALE_BELOW = -1, SCALE_ABOVE = 256 };

/* Returns the value's position on the scale, 0 at MIN and 1 at MAX; value must be positive if the scale is logarithmic. */
double scale_place(const struct scale *scale, double value);
/* Returns the value at a position on the scale (0 at MIN, 1 at MAX); the inverse of scale_place(). */
double scale_value(const struct scale *scale, double place);
/* Returns the index in the colour map for a finite value: 0..255, SCALE_BELOW or SCALE_ABOVE. */
int scale_index(const struct scale *scale, double value);
/* Writes the scale's colour of a value into rgb. */
void scale_look_up(const struct scale *scale, double value, uint8_t rgb[3]);
/* Writes the values at which bands meet, ascending. Returns their number; 0 if there are no bands, or more than SCALE_EDGES values. */
int scale_edges(const struct scale *scale, double edges[SCALE_EDGES]);
/* Returns the smallest difference of two values that may show in their colours. */
double scale_step(const struct scale *scale);

#endif
