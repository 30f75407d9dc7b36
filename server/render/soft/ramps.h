/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Colour ramps: tables that the software renderer looks up for previews, the quick pictures while the camera moves. A ramp has the colours
   of one material, or of one entry of the colour map, from the darkest to the brightest light. Pure. */
#ifndef RENDER_SOFT_RAMPS_H
#define RENDER_SOFT_RAMPS_H
#include <stdbool.h>
#include <stdint.h>

#include "render/light/environments.h"

struct ramp_material {
    float mean[3]; /* the material's base colour times the mean colour of its texture, in linear light */
    float metallic, roughness, emissive[3];
};
/* Fills `steps` colours (a multiple of 8) from dark to bright: blue | green << 8 | red << 16 | 0xff000000. up: the plant's up direction.
   muted true: greyed, for assets without a field. */
void ramp_fill(const struct environment_light *sky, const double up[3], const struct ramp_material *material, bool muted, int steps,
               uint32_t *colors);
/* Fills `steps` elements, `stride` elements apart, with `color` (sRGB, 0xRRGGBB) shaded from the darkest to the brightest
   light. For the glossy style, in which light shades the colours of the field. */
void ramp_fill_glossy(uint32_t color, int steps, uint32_t *colors, int stride);

#endif
