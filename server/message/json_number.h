/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MESSAGE_JSON_NUMBER_H
#define MESSAGE_JSON_NUMBER_H
#include <jansson.h>

/* As messages have a number: null where it is not finite; never -0.0. */
json_t *number(double value);

#endif
