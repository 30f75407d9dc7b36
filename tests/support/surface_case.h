/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared parts of tests of distances along surfaces: an error log, worker threads, and random numbers with a printed seed. */
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

/* Returns a random number between low and high. */
double between(double low, double high);

/* Returns the surface of the shape with default parameters. Fails the test if there is none. */
struct surface *surface_of(const struct cad *cad);

/* Returns the value at a vertex that results from these readings of all sensors. */
double influence_value(const struct influence *influence, const double *readings, size_t vertex);
/* Adds a triangle at x = 5, separate from a shape of size 1. */
void add_triangle_apart(struct cad *cad);

/* Set-up and tear-down of a cmocka group. */
int surface_case_set_up(void **state);
int surface_case_tear_down(void **state);

#endif
