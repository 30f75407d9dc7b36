/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/support/stand_case.h"

struct stand stand;

int stand_tear_down(void **state)
{
    (void)state;
    stand_finish(&stand);
    return 0;
}
