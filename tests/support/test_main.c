/* SPDX-License-Identifier: GPL-3.0-or-later */
/* main() for test programs that do not define it themselves. It is in an archive, from which the linker takes it only if main()
   is missing. */
#include "tests/support/test.h"

#pragma weak tests_main

int main(void)
{
    return tests_main ? tests_main() : tests_run(NULL);
}
