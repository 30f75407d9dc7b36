/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared parts of tests of distances along surfaces: a log of errors, worker threads, and random numbers whose seed is printed. */
#ifndef TESTS_SURFACE_CASE_H
#define TESTS_SURFACE_CASE_H
#include "base/log/log.h"
#include "base/workers.h"
#include "field/influence_fill.h"
#include "preprocess/influence/influence.h"
#include "surface/surface.h"
#include "tests/support/cad.h"

extern struct log *the_log;
extern struct workers *workers;
extern struct cad_random chance;

/* Returns a random number from low to high. */
double between(double low, double high);

/* Skips the test under a sanitizer: the solver would take minutes and is not the code under test. */
void skip_if_watched(void);

/* Returns the surface of the shape, prepared with default parameters, and frees it automatically after the test. Fails the test
   if the surface cannot be prepared. */
struct surface *surface_of(const struct cad *cad);

/* Returns the interpolated value at a vertex for these readings, one per sensor. */
double influence_value(const struct influence *influence, const double *readings, size_t vertex);
/* Adds a triangle at x = 5, so that it is not connected to the shape, which is about 1 in size. */
void add_triangle_apart(struct cad *cad);

/* Set-up and tear-down of a cmocka group. */
int surface_case_set_up(void **state);
int surface_case_tear_down(void **state);

#endif
