/* SPDX-License-Identifier: GPL-3.0-or-later */
/* CIELAB (D65) by CIE 15:2004 with the IEC 61966-2-1 primaries, and deuteranopia, independent of the production code. */
#ifndef TESTS_SUPPORT_CIELAB_H
#define TESTS_SUPPORT_CIELAB_H
#include <stdbool.h>
#include <stdint.h>

/* Convert between linear RGB components 0..1 and CIELAB. */
void lab_from_linear(const double c[3], double lab[3]);
void linear_from_lab(const double lab[3], double c[3]);
/* Converts linear RGB to what a deuteranope sees (Machado, Oliveira, Fernandes 2009, severity 1). */
void see_without_green(double c[3]);
/* Convert sRGB components 0..255 to CIELAB, as seen with this colour vision. */
void lab_of_rgb(const double rgb[3], bool deuteranope, double lab[3]);
void lab_of(const uint8_t rgb[3], bool deuteranope, double lab[3]);
double lab_distance(const double a[3], const double b[3]);

#endif
