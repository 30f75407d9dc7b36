/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The GL context of a test program without main(), which makes it before its tests: see rig_run(). */
#ifndef TESTS_SUPPORT_RIG_CASE_H
#define TESTS_SUPPORT_RIG_CASE_H
#include "tests/support/rig.h"

extern struct rig rig;

#endif
