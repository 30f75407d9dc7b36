/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The main of a test program that has none of its own: the linker takes it from the archive then, and only then. */
#include "tests/support/test.h"

int main(void)
{
    return tests_run(NULL);
}
