/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Deferred requests: groups whose frame cannot be drawn yet, each waiting for its next turn. Pure. Thread: the render thread. */
#ifndef SERVICE_DEFERRED_REQUESTS_H
#define SERVICE_DEFERRED_REQUESTS_H
#include "service/request_group.h"

enum { DEFERRED_MOST = 16 };
struct deferred_requests {                      /* zero-initialise; deferred_requests_finish */
    struct request_group groups[DEFERRED_MOST]; /* the oldest first; those from `count` on are empty, with memory to use again */
    size_t count;
    bool due; /* the next turn is one of theirs */
};

/* Moves the group's tickets to the end of the line and leaves it empty. Returns false, and changes nothing, when there is no room. */
bool deferred_requests_push(struct deferred_requests *deferred, struct request_group *group);
/* Replaces what is in group by the oldest one; there must be one. */
void deferred_requests_pop(struct deferred_requests *deferred, struct request_group *group);
/* Returns whether a deferred group has the next turn: every second one while there is other work, else every one. */
bool deferred_requests_due(struct deferred_requests *deferred, bool others);
/* Frees the memory. */
void deferred_requests_finish(struct deferred_requests *deferred);

#endif
