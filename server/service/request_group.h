/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Wishes that were begun and that one picture answers. */
#ifndef SERVICE_REQUEST_GROUP_H
#define SERVICE_REQUEST_GROUP_H
#include "service/encoded_frame.h"

struct request_ticket {
    uint64_t client, number;
    struct frame_request wish;
    int64_t wait_ns;
};

struct request_group { /* zero-initialise */
    struct request_ticket *orders;
    size_t count, capacity;
};

void request_group_add(struct request_group *batch, const struct request_ticket *order);
/* Moves the orders for which belongs(order, arg) is true to `into`, which is emptied first; both keep their order. */
void request_group_split(struct request_group *batch, bool (*belongs)(const struct request_ticket *order, void *arg), void *arg,
                         struct request_group *into);
void request_group_finish(struct request_group *batch);

#endif
