/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rounds readings for messages to clients. */
#include "base/math/round_reading.h"

#include <math.h>

double round_reading(double value)
{
    double size = fabs(value);
    /* returns other numbers unrounded: below 1e-300, `scale` would overflow; from 1e12 on, rounding to three decimals would
       change nothing */
    if (!(size >= 1e-300 && size < 1e12))
        return value + 0.0; /* adding 0.0 turns -0.0 into 0.0, so that no minus sign is sent */
    double scale = size >= 1e4 ? 1000 : pow(10, 6 - floor(log10(size)));
    return rint(value * scale) / scale;
}
