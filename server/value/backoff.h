/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Exponential backoff for reconnecting: pauses double from 0.5 to 10 s, with jitter so that clients do not retry in step. */
#ifndef VALUE_BACKOFF_H
#define VALUE_BACKOFF_H
#include <stdint.h>

struct backoff { /* zero-initialise; zero again after a success */
    int failures;
};

/* Counts one more failure and returns the pause before the next try, 0.5 to 10 s. random: any random bits, for the jitter. */
int64_t backoff_next_ns(struct backoff *backoff, uint64_t random);

#endif
