/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Queue of pick queries ("what is at this pixel?") for the render thread, and of its answers. Each client has at most one
   waiting query; a newer one replaces it. Call from any thread. */
#ifndef SERVICE_PICK_QUEUE_H
#define SERVICE_PICK_QUEUE_H
#include "render/pick/pick.h"

struct pick_query {
    uint64_t client;
    uint32_t seq; /* sequence number that the client gave its query; 0: none */
    struct view view;
    double x_px, y_px;
};

struct pick_answer { /* free with mem_free */
    struct pick_query query;
    struct pick pick;
    struct pick_answer *next;
};

struct pick_queue;
struct pick_queue *pick_queue_create(void);         /* never returns NULL */
void pick_queue_destroy(struct pick_queue **queue); /* destroys the queue and sets *queue to NULL; accepts a pointer to NULL */

/* Queues a copy of the query. Replaces the client's last query if that one still waits. */
void pick_queue_ask(struct pick_queue *queue, const struct pick_query *query);
/* Drops the client's pick query, and its answers that were not collected yet. */
void pick_queue_forget(struct pick_queue *queue, uint64_t client);
/* Returns whether a query waits. */
bool pick_queue_has_query(struct pick_queue *queue);
/* Removes the oldest query from the queue and writes it to *out. Returns false if the queue is empty. */
bool pick_queue_take(struct pick_queue *queue, struct pick_query *out);
/* Adds the answer to a pick query. Returns true if the collector must be notified, because this is the first answer since the
   last pick_queue_collect(). */
bool pick_queue_answer(struct pick_queue *queue, const struct pick_query *query, const struct pick *pick);
/* Returns all answers, oldest first; the caller frees each with mem_free. NULL: none. */
struct pick_answer *pick_queue_collect(struct pick_queue *queue);

#endif
