/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Samples of the GGX distribution. */
#ifndef RENDER_GGX_H
#define RENDER_GGX_H
#include <math.h>

/* The i-th of a sequence that fills (0, 1) evenly, by reversed bits. */
static inline double ggx_turn(unsigned i)
{
    i = (i << 16) | (i >> 16);
    i = ((i & 0x55555555u) << 1) | ((i & 0xAAAAAAAAu) >> 1);
    i = ((i & 0x33333333u) << 2) | ((i & 0xCCCCCCCCu) >> 2);
    i = ((i & 0x0F0F0F0Fu) << 4) | ((i & 0xF0F0F0F0u) >> 4);
    i = ((i & 0x00FF00FFu) << 8) | ((i & 0xFF00FF00u) >> 8);
    return i * 2.3283064365386963e-10;
}

/* Cosine between normal and half vector, distributed as GGX; alpha: roughness squared. */
static inline double ggx_cosine(double alpha, double part)
{
    return sqrt((1 - part) / (1 + (alpha * alpha - 1) * part));
}

#endif
