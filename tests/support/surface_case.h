/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared parts of tests of distances along surfaces: an error log, worker threads, and random numbers with a printed seed. */
#ifndef TESTS_SURFACE_CASE_H
#define TESTS_SURFACE_CASE_H
#include "base/log/log.h"
#include "base/workers.h"
#include "tests/support/cad.h"

extern struct log *the_log;
extern struct workers *workers;
extern struct cad_random chance;

/* Returns a random number between low and high. */
double between(double low, double high);

/* Set-up and tear-down of a cmocka group. */
int surface_case_set_up(void **state);
int surface_case_tear_down(void **state);

#endif
