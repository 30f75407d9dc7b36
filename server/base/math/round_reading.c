/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rounds a reading for messages. */
#include "base/math/round_reading.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

double round_reading(double value)
{
    char text[32];
    if (!(fabs(value) < 1e12))
        return value;
    if (fabs(value) >= 1e4)
        return round(value * 1000) / 1000;
    snprintf(text, sizeof(text), "%.7g", value);
    return strtod(text, NULL) + 0.0; /* adding 0.0 turns -0.0 into 0.0, so that no minus sign is sent */
}
