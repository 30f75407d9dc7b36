/* SPDX-License-Identifier: GPL-3.0-or-later */
/* main() for test programs that have none: the linker takes this object from the archive only then. */
#include "tests/support/test.h"

int main(void)
{
    return tests_run(NULL);
}
