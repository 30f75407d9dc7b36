/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Conversion between sRGB and CIELAB (D65), and simulation of deuteranopia. Pure. Call from any thread. */
#ifndef BASE_COLOR_LAB_H
#define BASE_COLOR_LAB_H
#include <stdbool.h>
#include <stdint.h>

enum color_vision { VISION_NORMAL, VISION_DEUTERANOPE, VISION_COUNT };

/* Converts sRGB components 0..255 (fractions allowed) to CIELAB, as perceived with this colour vision. Deuteranopes: Machado,
   Oliveira, Fernandes 2009, severity 1. */
void lab_from_srgb(const double srgb[3], enum color_vision vision, double lab[3]);
/* Converts an sRGB colour of 8 bits per channel to CIELAB, as seen with normal colour vision. */
void lab_from_rgb(const uint8_t rgb[3], double lab[3]);
/* Writes the colour with `offset` added to its lightness L*, as far as the sRGB gamut allows; hue and chroma are unchanged. */
void lab_shade(const uint8_t rgb[3], double offset, uint8_t out[3]);

#endif
