/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/support/rig_case.h"

#include "tests/support/test.h"

struct rig rig;

int tests_main(void)
{
    return rig_run(&rig);
}
