/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The scheduler: which class of request is drawn next. Input goes first; changed readings get every second frame beside it; what takes
   long (refined frames, snapshots over HTTP) waits for a pause, or, after a while, gets one step after each other frame. Within a class
   the client goes first that was charged the least drawing time; idle time is not saved up. Pure: time is handed in. */
#ifndef SERVICE_SCHEDULER_H
#define SERVICE_SCHEDULER_H
#include <stdbool.h>
#include <stdint.h>

enum urgency { URGENCY_INPUT, URGENCY_DATA, URGENCY_REFINE, URGENCY_SNAPSHOT, URGENCY_COUNT };

struct scheduler {             /* zero-initialise */
    int64_t input_ns, long_ns; /* when a frame for input, and one that takes long, was last done */
    bool data_next, step_next; /* readings, or a step of what takes long, have the next turn */
};

/* Time is charged in two shares: frames for input and data, and frames that take long. */
enum { SCHEDULER_MOVING, SCHEDULER_LONG, SCHEDULER_SHARES };
/* Returns the share in which frames of that urgency are charged. */
int scheduler_share(enum urgency urgency);
/* Returns the charge with which a client enters the line: its own, but no less than that of the client served last. */
int64_t scheduler_asked(int64_t spent_ns, int64_t served_ns);
/* Returns whether a goes before b: it was charged less, or as much and asked earlier. */
bool scheduler_before(int64_t a_spent_ns, int64_t a_asked_ns, int64_t b_spent_ns, int64_t b_asked_ns);

/* Returns the class to draw from now. asked_ns: when the first request of each class was made; INT64_MAX: there is none. Returns
   URGENCY_COUNT if nothing is due before *wait_until_ns (INT64_MAX: nothing waits). */
enum urgency scheduler_choose(const struct scheduler *scheduler, const int64_t asked_ns[URGENCY_COUNT], int64_t now_ns,
                              int64_t *wait_until_ns);
/* Notes that a frame of that class is complete. */
void scheduler_done(struct scheduler *scheduler, enum urgency urgency, int64_t now_ns);
/* Notes that a step of a frame that takes long was drawn. */
void scheduler_stepped(struct scheduler *scheduler);

#endif
