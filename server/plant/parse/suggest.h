/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Suggests a known name for a mistyped one ("did you mean"). Call from any thread. */
#ifndef PLANT_PARSE_SUGGEST_H
#define PLANT_PARSE_SUGGEST_H
#include <stddef.h>

/* Returns the name most similar to `wrong`, or NULL if no name is similar enough. `names`: `count` records of `stride` bytes,
   each beginning with a char * that may be NULL. */
const char *suggest_nearest(const char *wrong, const void *names, size_t count, size_t stride);

#endif
