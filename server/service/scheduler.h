/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The scheduler: chooses which class of request is drawn next. Inputs go first; changed readings get every second frame besides them.
   Long-running frames (refined frames, snapshots over HTTP) wait for a pause, or after a while get one step after each other frame.
   Within a class, the client that was charged the least drawing time goes first; unused time is not saved up. Pure: the caller passes
   the time. */
#ifndef SERVICE_SCHEDULER_H
#define SERVICE_SCHEDULER_H
#include <stdbool.h>
#include <stdint.h>

enum urgency { URGENCY_INPUT, URGENCY_DATA, URGENCY_REFINE, URGENCY_SNAPSHOT, URGENCY_COUNT };

struct scheduler {             /* zero-initialise */
    int64_t input_ns, long_ns; /* monotonic: when a frame for an input, and a long-running one, was last finished */
    bool data_next, step_next; /* changed readings, or a step of a long-running frame, have the next turn */
};

/* Drawing time is charged in two shares: frames for inputs and readings, and long-running frames. */
enum { SCHEDULER_MOVING, SCHEDULER_LONG, SCHEDULER_SHARES };
/* Returns the share in which frames of that urgency are charged. */
int scheduler_share(enum urgency urgency);
/* Returns the charge with which a client joins the queue: its own, but no less than that of the client served last. */
int64_t scheduler_asked(int64_t spent_ns, int64_t served_ns);
/* Returns whether a goes before b: it was charged less; or the same, and asked earlier. */
bool scheduler_before(int64_t a_spent_ns, int64_t a_asked_ns, int64_t b_spent_ns, int64_t b_asked_ns);

/* Returns the class to draw now. asked_ns: when the first request of each class was made; INT64_MAX: there is none. Returns
   URGENCY_COUNT if nothing is due before *wait_until_ns (INT64_MAX: nothing waits). */
enum urgency scheduler_choose(const struct scheduler *scheduler, const int64_t asked_ns[URGENCY_COUNT], int64_t now_ns,
                              int64_t *wait_until_ns);
/* Notes that a frame of that class is complete. */
void scheduler_done(struct scheduler *scheduler, enum urgency urgency, int64_t now_ns);
/* Notes that a step of a long-running frame was drawn. */
void scheduler_stepped(struct scheduler *scheduler);

#endif
