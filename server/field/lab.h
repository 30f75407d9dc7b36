/* SPDX-License-Identifier: GPL-3.0-or-later */
/* CIELAB (D65) and back, and how a deuteranope sees. Pure. Thread: any. */
#ifndef FIELD_LAB_H
#define FIELD_LAB_H
#include <stdbool.h>
#include <stdint.h>

enum color_vision { VISION_NORMAL, VISION_DEUTERANOPE, VISION_COUNT };

/* srgb: 0..255, not necessarily whole. Deuteranopes: Machado, Oliveira, Fernandes 2009, severity 1. */
void lab_from_srgb(const double srgb[3], enum color_vision vision, double lab[3]);
void lab_from_rgb(const uint8_t rgb[3], double lab[3]);
/* The colour with `offset` added to its L*, as far as sRGB goes; hue and chroma stay. */
void lab_shade(const uint8_t rgb[3], double offset, uint8_t out[3]);

#endif
