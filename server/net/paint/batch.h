/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Wishes that were begun and that one picture answers. */
#ifndef NET_BATCH_H
#define NET_BATCH_H
#include "net/paint/picture.h"

struct order {
    uint64_t client, number;
    struct wish wish;
    int64_t wait_ns;
};

struct batch { /* zero-initialise */
    struct order *orders;
    size_t count, capacity;
};

void batch_add(struct batch *batch, const struct order *order);
/* Moves the orders for which belongs(order, arg) is true to `into`, which is emptied first; both keep their order. */
void batch_split(struct batch *batch, bool (*belongs)(const struct order *order, void *arg), void *arg, struct batch *into);
void batch_finish(struct batch *batch);

#endif
