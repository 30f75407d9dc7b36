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

/* Which of several hosts is tried: one after the other, and a pause once all were. */
struct host_turn { /* zero-initialise */
    int index; /* of the host that is being tried */
    int tried; /* one after the other, without a session */
    struct backoff backoff;
};

/* Turns to the next of count hosts. Returns when to try it: at once, if there is one that was not tried since a session. */
int64_t host_turn_next_ns(struct host_turn *turn, int count, int64_t now_ns);
/* Notes that there is a session with the host. */
void host_turn_succeeded(struct host_turn *turn);

#endif
