/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Whose picture is drawn next. Who moves goes first; changed readings get every second picture beside them; what takes long
   (refinements, snapshots) waits for a pause, but not for ever: then it gets a step after each of the others' pictures. Within a
   class the oldest wish goes first. Pure. */
#ifndef NET_SCHEDULE_H
#define NET_SCHEDULE_H
#include <stdbool.h>
#include <stdint.h>

enum urgency { URGENCY_INPUT, URGENCY_DATA, URGENCY_REFINE, URGENCY_SNAPSHOT, URGENCY_COUNT };

struct schedule {              /* zero-initialise: what was drawn last */
    int64_t input_ns, long_ns; /* when the last picture of a moving session, and the last that took long, was done */
    bool data_next, step_next;
};

/* asked_ns: of the oldest wish of each class; INT64_MAX: none. Returns the class to draw now, or URGENCY_COUNT: none before
   *wait_until_ns (INT64_MAX: none at all). */
enum urgency schedule_choose(const struct schedule *schedule, const int64_t asked_ns[URGENCY_COUNT], int64_t now_ns,
                             int64_t *wait_until_ns);
void schedule_done(struct schedule *schedule, enum urgency urgency, int64_t now_ns);
void schedule_stepped(struct schedule *schedule); /* a part of what takes long was drawn */

#endif
