/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Arithmetic expressions on tags (TAGS.md), such as [TT-1] - [TT-2] or mean([A], [B]). Immutable once parsed. Call from any thread. */
#ifndef PLANT_TAGS_EXPRESSION_H
#define PLANT_TAGS_EXPRESSION_H
#include <stdbool.h>
#include <stddef.h>

enum { EXPRESSION_INPUTS = 64 };

struct expression;

/* Parses an expression. `find` returns the index of the tag named in brackets, or -1. On errors, returns NULL with the reason
   in `why` and the character position, from 0, in *at. */
struct expression *expression_parse(const char *text, int (*find)(const void *arg, const char *name), const void *arg, char why[200],
                                    size_t *at);
void expression_destroy(struct expression **expression); /* Frees the expression and sets *expression to NULL; accepts a pointer to NULL. */
/* Returns the number of tags in the expression; *inputs receives their indices (as returned by `find`), without duplicates. */
size_t expression_inputs(const struct expression *expression, const int **inputs);
/* Computes the expression from the values of its tags, in the order of expression_inputs(). Returns NaN or infinity if the expression has
   no value. */
double expression_value(const struct expression *expression, const double *values);

#endif
