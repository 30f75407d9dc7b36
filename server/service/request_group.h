/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A group of frame requests that are answered with one frame. Plain data; only one thread at a time may use a group. */
#ifndef SERVICE_REQUEST_GROUP_H
#define SERVICE_REQUEST_GROUP_H
#include "service/frame_request.h"

struct request_ticket { /* frame request whose drawing has begun ("ticket") */
    uint64_t client, number;
    struct frame_request request;
    int64_t wait_ns; /* time in nanoseconds from the user's input, or the changed reading, to the start of drawing */
};

struct request_group { /* zero-initialise; free with request_group_finish() */
    struct request_ticket *tickets;
    size_t count, capacity;
};

/* Appends a copy of the ticket to the group. */
void request_group_add(struct request_group *group, const struct request_ticket *ticket);
/* Moves the tickets (frame requests) for which belongs(ticket, arg) returns true to `into`, which is emptied first. Both lists
   keep their order. */
void request_group_split(struct request_group *group, bool (*belongs)(const struct request_ticket *ticket, void *arg), void *arg,
                         struct request_group *into);
/* Returns whether a request of the group wants the record of the readings that the frame was drawn from. */
bool request_group_wants_record(const struct request_group *group);
/* Returns whether a request of the group wants the frame with its depth grid (coarse depth, for showing the frame from another
   camera). */
bool request_group_wants_depth(const struct request_group *group);
/* Frees the memory; the group is empty and can be reused. */
void request_group_finish(struct request_group *group);

#endif
