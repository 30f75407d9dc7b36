/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Whose picture is drawn next. Who moves goes first; changed readings get every second picture beside them; what takes long
   (refinements, snapshots) waits for a pause, but not for ever: then it gets a step after each of the others' pictures. Within a
   class, time is shared fairly: the client goes first that has had the least of it, by what its pictures cost; who asks
   seldom saves nothing up. Pure. */
#ifndef SERVICE_SCHEDULER_H
#define SERVICE_SCHEDULER_H
#include <stdbool.h>
#include <stdint.h>

enum urgency { URGENCY_INPUT, URGENCY_DATA, URGENCY_REFINE, URGENCY_SNAPSHOT, URGENCY_COUNT };

struct scheduler {             /* zero-initialise: what was drawn last */
    int64_t input_ns, long_ns; /* when the last picture of a moving session, and the last that took long, was done */
    bool data_next, step_next;
};

enum { SCHEDULER_MOVING, SCHEDULER_LONG, SCHEDULER_SHARES }; /* what is shared apart from each other: input and data, and what takes long */
int scheduler_share(enum urgency urgency);
/* What a client has had, when it asks again: no less than the one served last had when it was its turn. */
int64_t scheduler_asked(int64_t spent_ns, int64_t served_ns);
/* a goes before b: less was spent on it, or as much, and it has waited longer. */
bool scheduler_before(int64_t a_spent_ns, int64_t a_asked_ns, int64_t b_spent_ns, int64_t b_asked_ns);

/* asked_ns: of the wish of each class that goes first; INT64_MAX: none. Returns the class to draw now, or URGENCY_COUNT: none before
   *wait_until_ns (INT64_MAX: none at all). */
enum urgency scheduler_choose(const struct scheduler *schedule, const int64_t asked_ns[URGENCY_COUNT], int64_t now_ns,
                              int64_t *wait_until_ns);
void scheduler_done(struct scheduler *schedule, enum urgency urgency, int64_t now_ns);
void scheduler_stepped(struct scheduler *schedule); /* a part of what takes long was drawn */

#endif
