/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Samples directions of the GGX distribution (microfacet normals). Pure. */
#ifndef RENDER_GGX_H
#define RENDER_GGX_H
#include <math.h>

/* Returns the i-th number of the van der Corput sequence in base 2, which fills [0, 1) evenly. */
static inline double ggx_turn(unsigned i)
{
    i = (i << 16) | (i >> 16);
    i = ((i & 0x55555555u) << 1) | ((i & 0xAAAAAAAAu) >> 1);
    i = ((i & 0x33333333u) << 2) | ((i & 0xCCCCCCCCu) >> 2);
    i = ((i & 0x0F0F0F0Fu) << 4) | ((i & 0xF0F0F0F0u) >> 4);
    i = ((i & 0x00FF00FFu) << 8) | ((i & 0xFF00FF00u) >> 8);
    return i * 2.3283064365386963e-10;
}

/* Samples the GGX distribution: returns the cosine between normal and half vector for the uniform random number `part` (0..1). alpha:
   roughness squared. */
static inline double ggx_cosine(double alpha, double part)
{
    return sqrt((1 - part) / (1 + (alpha * alpha - 1) * part));
}

#endif
