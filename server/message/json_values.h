/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Numbers, texts and vectors as used in messages. Each function returns a new JSON value, owned by the caller. Pure. Call from any
   thread. */
#ifndef MESSAGE_JSON_VALUES_H
#define MESSAGE_JSON_VALUES_H
#include <jansson.h>

#include "base/math/round_reading.h"

/* Returns a number, never -0.0; null if the value is not finite. */
json_t *number(double value);
/* Returns a reading's value, rounded by round_reading(); print it with json_text() and READING_DIGITS digits. Returns null if
   the value is not finite. */
json_t *reading_number(double value);
/* Returns a string; null for NULL; "(not UTF-8)" for text that is not UTF-8. */
json_t *string(const char *text);
/* Returns a JSON array of three numbers. */
json_t *vector(const double v[3]);
/* Returns a JSON array of `count` numbers; null if count is 0. */
json_t *number_list(const double *values, int count);

#endif
