/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "message/json_values.h"

#include <math.h>

json_t *number(double value)
{
    /* adding 0.0 turns -0.0 into 0.0, so that JSON never contains a negative zero */
    return isfinite(value) ? json_real(value + 0.0) : json_null();
}

json_t *reading_number(double value)
{
    double size = fabs(value);
    /* writes a large whole number as a JSON integer, because json_text() rounds real numbers to a limited number of digits */
    if (size >= 1e7 && size < 9e15 && value == trunc(value))
        return json_integer((json_int_t)value);
    return number(round_reading(value));
}

json_t *string(const char *text)
{
    json_t *value = text ? json_string(text) : json_null();
    return value ? value : json_string("(not UTF-8)");
}

json_t *vector(const double v[3])
{
    return json_pack("[o,o,o]", number(v[0]), number(v[1]), number(v[2]));
}

json_t *number_list(const double *values, int count)
{
    json_t *list = count > 0 ? json_array() : json_null();
    for (int i = 0; i < count; i++)
        json_array_append_new(list, number(values[i]));
    return list;
}
