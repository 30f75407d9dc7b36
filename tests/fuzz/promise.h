/* SPDX-License-Identifier: GPL-3.0-or-later */
/* require(): makes a fuzzer abort if a promise (an invariant of the tested code) is broken. */
#ifndef TESTS_FUZZ_PROMISE_H
#define TESTS_FUZZ_PROMISE_H
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

static inline void require(bool promise, const char *what)
{
    if (promise)
        return;
    fprintf(stderr, "broken promise: %s\n", what);
    abort();
}

#endif
