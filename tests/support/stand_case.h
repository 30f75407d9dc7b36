/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The stand (plant with a renderer) that each test of a program uses. */
#ifndef TESTS_SUPPORT_STAND_CASE_H
#define TESTS_SUPPORT_STAND_CASE_H
#include "tests/support/rig_case.h"

extern struct stand stand; /* the set-up function of each test fills it */

int stand_tear_down(void **state); /* finishes the stand */

/* Asserts that every pixel of the view, apart from a margin, has one of the two greys of the no-data hatching, that both greys
   occur, and that the frame has no reading with an age. */
void stand_expect_hatched(const struct view *view);

#endif
