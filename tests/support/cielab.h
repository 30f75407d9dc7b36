/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Converts colours to CIELAB (D65) by CIE 15:2004 with the sRGB primaries of IEC 61966-2-1, and simulates deuteranopia
   (red-green blindness). Written for tests, independent of the server's own code. */
#ifndef TESTS_SUPPORT_CIELAB_H
#define TESTS_SUPPORT_CIELAB_H
#include <stdbool.h>
#include <stdint.h>

/* Convert between linear RGB components from 0 to 1 and CIELAB. */
void lab_from_linear(const double c[3], double lab[3]);
void linear_from_lab(const double lab[3], double c[3]);
/* Replaces linear RGB components by those that a person with deuteranopia sees (Machado, Oliveira, Fernandes 2009, severity 1).
   */
void see_without_green(double c[3]);
/* Converts sRGB components from 0 to 255 to CIELAB. deuteranope: as a person with deuteranopia sees the colour. */
void lab_of_rgb(const double rgb[3], bool deuteranope, double lab[3]);
void lab_of(const uint8_t rgb[3], bool deuteranope, double lab[3]);
double lab_distance(const double a[3], const double b[3]);

#endif
