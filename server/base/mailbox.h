/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A slot that holds the newest of what was put into it: no queue, so nothing is ever late. Thread: any. */
#ifndef BASE_MAILBOX_H
#define BASE_MAILBOX_H
#include <pthread.h>
#include <stdbool.h>
#include <stddef.h>

struct mailbox {
    size_t bytes;
    pthread_mutex_t lock;
    /* --- below: under lock */
    void *slot;
    bool full;
};

void mailbox_init(struct mailbox *box, size_t bytes); /* for structs of that size, copied in and out */
void mailbox_finish(struct mailbox *box);
/* True if the slot was empty: whoever reads it needs to be woken. */
bool mailbox_put(struct mailbox *box, const void *item);
/* False: nothing new. */
bool mailbox_take(struct mailbox *box, void *item);

#endif
