/* SPDX-License-Identifier: GPL-3.0-or-later */
/* JSON as text. Thread: any. */
#ifndef BASE_TEXT_JSON_TEXT_H
#define BASE_TEXT_JSON_TEXT_H
#include <jansson.h>

/* Prints and takes the value: without spaces, numbers with that many digits (0: all that they have). Returns "{}" or "[]" where it cannot
   be printed; free with mem_free. */
char *json_text(json_t *value, int digits);

#endif
