/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "message/json_number.h"

#include <math.h>

json_t *number(double value)
{
    return isfinite(value) ? json_real(value + 0.0) : json_null(); /* of -0.0 it makes 0.0 */
}
