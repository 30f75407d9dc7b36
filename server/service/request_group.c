/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Orders in a list. */
#include "service/request_group.h"

#include "base/mem.h"

void request_group_add(struct request_group *batch, const struct request_ticket *order)
{
    mem_grow(&batch->orders, &batch->capacity, batch->count + 1, sizeof(*batch->orders));
    batch->orders[batch->count++] = *order;
}

void request_group_split(struct request_group *batch, bool (*belongs)(const struct request_ticket *order, void *arg), void *arg,
                         struct request_group *into)
{
    size_t kept = 0;
    into->count = 0;
    for (size_t i = 0; i < batch->count; i++) {
        if (belongs(&batch->orders[i], arg))
            request_group_add(into, &batch->orders[i]);
        else
            batch->orders[kept++] = batch->orders[i];
    }
    batch->count = kept;
}

void request_group_finish(struct request_group *batch)
{
    mem_free(batch->orders);
    *batch = (struct request_group){ 0 };
}
