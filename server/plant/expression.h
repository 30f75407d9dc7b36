/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Arithmetic on tags, as PLANT.md describes it: [TT-1] - [TT-2], mean([A], [B]). Immutable once parsed. Thread: any. */
#ifndef PLANT_EXPRESSION_H
#define PLANT_EXPRESSION_H
#include <stdbool.h>
#include <stddef.h>

enum { EXPRESSION_INPUTS = 64 };

struct expression;

/* find: the index of the thing that a name in brackets means, or -1. NULL: why[] says what is wrong, and *at which character, from 0. */
struct expression *expression_parse(const char *text, int (*find)(const void *arg, const char *name), const void *arg, char why[200],
                                    size_t *at);
void expression_destroy(struct expression **expression); /* &NULL is fine; leaves NULL */
/* What find gave, each once. */
size_t expression_inputs(const struct expression *expression, const int **inputs);
/* values: of the inputs, in that order. What cannot be computed is NaN or infinite. */
double expression_value(const struct expression *expression, const double *values);

#endif
