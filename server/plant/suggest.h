/* SPDX-License-Identifier: GPL-3.0-or-later */
/* "Did you mean": the known name nearest to a mistyped one. Thread: any. */
#ifndef PLANT_SUGGEST_H
#define PLANT_SUGGEST_H
#include <stddef.h>

/* names: `count` records of `stride` bytes that begin with a char *; a NULL there is passed over. NULL: nothing is near. */
const char *suggest_nearest(const char *wrong, const void *names, size_t count, size_t stride);

#endif
