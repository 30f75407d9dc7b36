/* SPDX-License-Identifier: GPL-3.0-or-later */
/* main() for test programs without one: only then does the linker take this object from the archive. */
#include "tests/support/test.h"

#pragma weak tests_main

int main(void)
{
    return tests_main ? tests_main() : tests_run(NULL);
}
