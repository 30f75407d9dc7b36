/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Waits for other threads and programs. Call from any thread. */
#ifndef TESTS_SLEEP_H
#define TESTS_SLEEP_H
#include <errno.h>
#include <stdint.h>
#include <time.h>

static inline void sleep_ns(int64_t ns)
{
    struct timespec t = { .tv_sec = ns / 1000000000, .tv_nsec = ns % 1000000000 };
    while (ns > 0 && nanosleep(&t, &t) != 0 && errno == EINTR)
        ;
}

#endif
