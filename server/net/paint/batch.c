/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Orders in a list. */
#include "net/paint/batch.h"

#include "base/mem.h"

void batch_add(struct batch *batch, const struct order *order)
{
    mem_grow(&batch->orders, &batch->capacity, batch->count + 1, sizeof(*batch->orders));
    batch->orders[batch->count++] = *order;
}

void batch_split(struct batch *batch, bool (*belongs)(const struct order *order, void *arg), void *arg, struct batch *into)
{
    size_t kept = 0;
    into->count = 0;
    for (size_t i = 0; i < batch->count; i++) {
        if (belongs(&batch->orders[i], arg))
            batch_add(into, &batch->orders[i]);
        else
            batch->orders[kept++] = batch->orders[i];
    }
    batch->count = kept;
}

void batch_finish(struct batch *batch)
{
    mem_free(batch->orders);
    *batch = (struct batch){ 0 };
}
