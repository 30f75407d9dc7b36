/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Questions about pixels, on their way to the render thread and back. One of each client waits: the newest wins. Thread: any. */
#ifndef SERVICE_PICK_QUEUE_H
#define SERVICE_PICK_QUEUE_H
#include "render/pick/pick.h"

struct pick_query {
    uint64_t client;
    uint32_t seq; /* the client's own number */
    struct view view;
    double x_px, y_px;
};

struct pick_answer { /* mem_free */
    struct pick_query order;
    struct pick pick;
    struct pick_answer *next;
};

struct pick_queue;
struct pick_queue *pick_queue_create(void);
void pick_queue_destroy(struct pick_queue **picks); /* &NULL is fine; leaves NULL */

void pick_queue_ask(struct pick_queue *picks, const struct pick_query *order);
void pick_queue_forget(struct pick_queue *picks, uint64_t client);
bool pick_queue_has_query(struct pick_queue *picks);                    /* for the render thread: there is one */
bool pick_queue_take(struct pick_queue *picks, struct pick_query *out); /* the oldest. False: there is none */
/* True: it is the first that nobody has collected. */
bool pick_queue_answer(struct pick_queue *picks, const struct pick_query *order, const struct pick *pick);
struct pick_answer *pick_queue_collect(struct pick_queue *picks); /* all that were given, oldest first. NULL: none */

#endif
