/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Exponential backoff for reconnecting: pauses double from 0.5 to 10 s. Random jitter keeps clients from retrying all at the same time. */
#ifndef VALUE_BACKOFF_H
#define VALUE_BACKOFF_H
#include <stdint.h>

struct backoff { /* number of failures since the last success; initialise with zeros, and reset to zero after a success */
    int failures;
};

/* Counts one more failure and returns the delay before the next attempt, 0.5 to 10 s. `random`: any random bits, used for the jitter. */
int64_t backoff_next_ns(struct backoff *backoff, uint64_t random);

/* Chooses the next of several hosts of one source: tries each host once without a delay, then backs off before the next round. */
struct host_turn { /* zero-initialise */
    int index;     /* index of the host that is being tried or is connected */
    int tried;     /* number of hosts that were tried since a connection last succeeded */
    struct backoff backoff;
};

/* Moves on to the next of `count` hosts. Returns the monotonic time at which to try it: now_ns, or later if all hosts have failed since
   a connection last succeeded. */
int64_t host_turn_next_ns(struct host_turn *turn, int count, int64_t now_ns);
/* Records that a connection to the current host succeeded, so that the next failure starts again with the shortest delay. */
void host_turn_succeeded(struct host_turn *turn);

#endif
