/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The transfer function of sRGB (IEC 61966-2-1) and its inverse, for values from 0 to 1; functions that end in f use single
   precision. Call from any thread. */
#ifndef BASE_IMAGE_SRGB_H
#define BASE_IMAGE_SRGB_H
#include <math.h>

static inline double linear_from_srgb(double c)
{
    return c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4);
}

static inline float linear_from_srgbf(float c)
{
    return c <= 0.04045f ? c / 12.92f : powf((c + 0.055f) / 1.055f, 2.4f);
}

static inline double srgb_from_linear(double c)
{
    return c <= 0.0031308 ? c * 12.92 : 1.055 * pow(c, 1 / 2.4) - 0.055;
}

#endif
