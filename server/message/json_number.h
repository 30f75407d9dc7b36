/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Numbers as messages write them. */
#ifndef MESSAGE_JSON_NUMBER_H
#define MESSAGE_JSON_NUMBER_H
#include <jansson.h>

/* Returns a new JSON number, never -0.0; null where the value is not finite. */
json_t *number(double value);

#endif
