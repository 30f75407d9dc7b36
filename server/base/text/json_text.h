/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Prints JSON as text. Thread: any. */
#ifndef BASE_TEXT_JSON_TEXT_H
#define BASE_TEXT_JSON_TEXT_H
#include <jansson.h>

/* Prints a JSON value and takes its ownership. The text has no spaces; numbers have `digits` significant digits (0: all). Returns "{}"
   or "[]" if the value cannot be printed; free with mem_free(). */
char *json_text(json_t *value, int digits);

#endif
