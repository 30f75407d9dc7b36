/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What tests of distances along surfaces have in common: a log of errors, threads, and chance from a seed that is printed. */
#ifndef TESTS_SURFACE_CASE_H
#define TESTS_SURFACE_CASE_H
#include "base/log/log.h"
#include "base/workers.h"
#include "tests/support/cad.h"

extern struct log *the_log;
extern struct workers *workers;
extern struct cad_random chance;

/* Of a group of cmocka's tests. */
int surface_case_set_up(void **state);
int surface_case_tear_down(void **state);

#endif
