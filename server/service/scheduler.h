/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The scheduler: chooses which class of request is drawn next. Inputs go first, but changed readings get every second frame.
   Long-running frames (refined frames, snapshots over HTTP) wait for a pause, or after a while get one step after each other
   frame. Within a class, the client that was charged the least drawing time goes first; unused time is not saved up. Pure: the
   caller passes the time. */
#ifndef SERVICE_SCHEDULER_H
#define SERVICE_SCHEDULER_H
#include <stdbool.h>
#include <stdint.h>

enum urgency { URGENCY_INPUT, URGENCY_DATA, URGENCY_REFINE, URGENCY_SNAPSHOT, URGENCY_COUNT };

struct scheduler {             /* zero-initialise */
    /* input_ns: monotonic time when the last frame for an input was finished; long_ns: the same for the last long-running frame */
    int64_t input_ns, long_ns;
    /* data_next: the next frame is drawn for changed readings; step_next: the next turn draws a step of a long-running frame */
    bool data_next, step_next;
};

/* Kinds of frames that are charged separately. SCHEDULER_MOVING: previews for inputs and for changed readings. SCHEDULER_LONG:
   long-running frames, that is, refined frames and snapshots over HTTP. */
enum { SCHEDULER_MOVING, SCHEDULER_LONG, SCHEDULER_SHARES };
/* Returns the kind of frames (SCHEDULER_MOVING or SCHEDULER_LONG) to which the drawing time of such a request is charged. */
int scheduler_share(enum urgency urgency);
/* Returns a client's charge when it enters the queue: the drawing time charged to it so far, but at least the charge of the
   client served last. So time that a client left unused gives it no advantage. */
int64_t scheduler_asked(int64_t spent_ns, int64_t served_ns);
/* Returns whether client a is served before client b: because a was charged less drawing time or, if both were charged the
   same, because a's request is older. */
bool scheduler_before(int64_t a_spent_ns, int64_t a_asked_ns, int64_t b_spent_ns, int64_t b_asked_ns);

/* Returns the class (urgency) of the request to draw now. asked_ns: by class: when the oldest request of the class was made;
   INT64_MAX: it has none. Returns URGENCY_COUNT if nothing is due before *wait_until_ns (INT64_MAX: nothing waits). */
enum urgency scheduler_choose(const struct scheduler *scheduler, const int64_t asked_ns[URGENCY_COUNT], int64_t now_ns,
                              int64_t *wait_until_ns);
/* Records that a frame for a request of that class (urgency) is complete. */
void scheduler_done(struct scheduler *scheduler, enum urgency urgency, int64_t now_ns);
/* Records that a step of a long-running frame (refined frame, snapshot over HTTP) was drawn. */
void scheduler_stepped(struct scheduler *scheduler);

#endif
