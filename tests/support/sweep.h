/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How much of a large set of random views, shapes or faults a test tries: all of it if PLANTCAST_LONG=1 (`make test-long`). */
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

/* Returns how many items to try: `whole` in a long run, otherwise `part`. */
static inline int sweep(int whole, int part)
{
    return sweep_is_whole() ? whole : part;
}

/* Returns whether item i of a row is tested: in a long run every item, otherwise every nth, with a different offset in each
   row, so that n rows together cover each item. */
static inline bool sweep_takes(int row, int i, int n)
{
    return sweep_is_whole() || i % n == row % n;
}

/* Returns the seed of a test's random numbers and prints it: PLANTCAST_SEED if set; otherwise a new one in each long run, and
   always the same in other runs, so that failures repeat. */
static inline uint64_t sweep_seed(void)
{
    const char *given = getenv("PLANTCAST_SEED");
    uint64_t seed = given ? strtoull(given, NULL, 10) : sweep_is_whole() ? (uint64_t)time(NULL) : 1;
    printf("# PLANTCAST_SEED=%llu\n", (unsigned long long)seed);
    return seed;
}

#endif
