/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How far tests go through what has no end: random views, shapes, faults. In full where PLANTCAST_LONG=1 (`make test-long`). */
#ifndef TESTS_SWEEP_H
#define TESTS_SWEEP_H
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static inline bool sweep_is_whole(void)
{
    const char *value = getenv("PLANTCAST_LONG");
    return value && value[0] == '1';
}

/* Returns how many to try: `whole` in full, otherwise `part`. */
static inline int sweep(int whole, int part)
{
    return sweep_is_whole() ? whole : part;
}

/* Returns whether item i of a row is tried: in full each, otherwise every n-th, another one of them in each row, so that over n rows
   each item has its turn. */
static inline bool sweep_takes(int row, int i, int n)
{
    return sweep_is_whole() || i % n == row % n;
}

/* Returns where a test's random numbers begin, and prints it: as PLANTCAST_SEED says; else by default always the same, so that what fails
   fails again, and in full another one in each run. */
static inline uint64_t sweep_seed(void)
{
    const char *given = getenv("PLANTCAST_SEED");
    uint64_t seed = given ? strtoull(given, NULL, 10) : sweep_is_whole() ? (uint64_t)time(NULL) : 1;
    printf("# PLANTCAST_SEED=%llu\n", (unsigned long long)seed);
    return seed;
}

#endif
