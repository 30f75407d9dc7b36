/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Deferred requests: groups of requests whose frame cannot be drawn yet, for example because a field is not computed. They wait
   for a later turn of the render thread. (In each turn, the thread draws a frame, or a step of one.) Pure. Call only in the
   render thread. */
#ifndef SERVICE_DEFERRED_REQUESTS_H
#define SERVICE_DEFERRED_REQUESTS_H
#include "service/request_group.h"

enum { DEFERRED_MOST = 16 };
struct deferred_requests { /* zero-initialise; free with deferred_requests_finish() */
    /* deferred groups, oldest first; the groups from index `count` on are empty and keep their memory for reuse */
    struct request_group groups[DEFERRED_MOST];
    size_t count;
    bool due; /* true: the next turn of the render thread is for a deferred group */
};

/* Moves the group's frame requests (tickets) to the end of the queue and leaves the group empty. Returns false, and changes nothing, if the
   queue is full. */
bool deferred_requests_push(struct deferred_requests *deferred, struct request_group *group);
/* Replaces the content of `group` by the oldest deferred group, which must exist. */
void deferred_requests_pop(struct deferred_requests *deferred, struct request_group *group);
/* Returns whether the render thread's next turn belongs to a deferred group. others: true: there is other work to do. Deferred
   groups then get every second turn, otherwise every turn. */
bool deferred_requests_due(struct deferred_requests *deferred, bool others);
/* Frees the memory. */
void deferred_requests_finish(struct deferred_requests *deferred);

#endif
