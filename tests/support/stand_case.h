/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The plant that each test of a program draws. */
#ifndef TESTS_SUPPORT_STAND_CASE_H
#define TESTS_SUPPORT_STAND_CASE_H
#include "tests/support/rig_case.h"

extern struct stand stand; /* made by the set-up of each test */

int stand_tear_down(void **state); /* finishes the stand */

#endif
