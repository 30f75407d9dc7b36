/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How long to leave alone what does not answer: doubling from 0.5 to 10 s, with jitter so that many do not knock at once. */
#ifndef VALUE_BACKOFF_H
#define VALUE_BACKOFF_H
#include <stdint.h>

struct backoff { /* zero-initialise; zero again after a success */
    int failures;
};

/* The pause after one more failure. random: anything. Between 0.5 and 10 s. */
int64_t backoff_next_ns(struct backoff *backoff, uint64_t random);

#endif
