/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Calculations with vectors of three components, for eight vectors at a time. Private to soft/. */
#ifndef RENDER_SOFT_VECTORS_H
#define RENDER_SOFT_VECTORS_H
#include <math.h>

#include "render/soft/lanes.h"

typedef struct {
    lanes x, y, z;
} vec;

SOFT_INLINE lanes all(float x)
{
    return (lanes){ 0 } + x;
}

SOFT_INLINE lanes least_of(lanes a, lanes b)
{
    return lanes_choose(a < b, a, b);
}

SOFT_INLINE lanes most_of(lanes a, lanes b)
{
    return lanes_choose(a > b, a, b);
}

SOFT_INLINE lanes root(lanes x)
{
    lanes out;
    for (int i = 0; i < LANES; i++)
        out[i] = sqrtf(x[i]);
    return out;
}

SOFT_INLINE vec grey(lanes x)
{
    return (vec){ x, x, x };
}

SOFT_INLINE vec times(vec a, lanes by)
{
    return (vec){ a.x * by, a.y * by, a.z * by };
}

SOFT_INLINE vec plus(vec a, vec b)
{
    return (vec){ a.x + b.x, a.y + b.y, a.z + b.z };
}

SOFT_INLINE vec multiplied(vec a, vec b)
{
    return (vec){ a.x * b.x, a.y * b.y, a.z * b.z };
}

SOFT_INLINE vec between(vec a, vec b, lanes part)
{
    return (vec){ a.x + (b.x - a.x) * part, a.y + (b.y - a.y) * part, a.z + (b.z - a.z) * part };
}

SOFT_INLINE lanes dot(vec a, vec b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

SOFT_INLINE vec unit(vec a)
{
    return times(a, 1.0f / root(most_of(dot(a, a), all(1e-30f))));
}

/* Packs colour channels of 0..1 into 24-bit colours: blue | green << 8 | red << 16. */
SOFT_INLINE lanes_int pack_color(lanes red, lanes green, lanes blue)
{
    return lanes_whole(blue * 255.0f + 0.5f) | lanes_whole(green * 255.0f + 0.5f) << 8 | lanes_whole(red * 255.0f + 0.5f) << 16;
}

#endif
