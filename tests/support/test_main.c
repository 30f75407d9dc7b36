/* SPDX-License-Identifier: GPL-3.0-or-later */
/* main() for test programs that have none: the linker takes this object from the archive only then. */
#include "tests/support/test.h"

#pragma weak tests_main

int main(void)
{
    return tests_main ? tests_main() : tests_run(NULL);
}
