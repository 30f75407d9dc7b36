/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a fuzzer stops at, beside a crash. */
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
