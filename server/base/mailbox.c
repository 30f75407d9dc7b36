/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A slot that holds the newest of what was put into it. */
#include "base/mailbox.h"

#include <string.h>

#include "base/mem.h"

void mailbox_init(struct mailbox *box, size_t bytes)
{
    *box = (struct mailbox){ .bytes = bytes, .slot = mem_new(bytes) };
    pthread_mutex_init(&box->lock, NULL);
}

void mailbox_finish(struct mailbox *box)
{
    if (!box->slot)
        return;
    pthread_mutex_destroy(&box->lock);
    mem_free(box->slot);
    box->slot = NULL;
}

bool mailbox_put(struct mailbox *box, const void *item)
{
    pthread_mutex_lock(&box->lock);
    bool was_empty = !box->full;
    memcpy(box->slot, item, box->bytes);
    box->full = true;
    pthread_mutex_unlock(&box->lock);
    return was_empty;
}

bool mailbox_take(struct mailbox *box, void *item)
{
    pthread_mutex_lock(&box->lock);
    bool full = box->full;
    if (full)
        memcpy(item, box->slot, box->bytes);
    box->full = false;
    pthread_mutex_unlock(&box->lock);
    return full;
}
