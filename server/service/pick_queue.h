/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The queue of questions about pixels ("what is here?") to the render thread, and of its answers. One question of each client waits; a
   newer one replaces it. Thread: any. */
#ifndef SERVICE_PICK_QUEUE_H
#define SERVICE_PICK_QUEUE_H
#include "render/pick/pick.h"

struct pick_query {
    uint64_t client;
    uint32_t seq; /* the client's own number for it; 0: none */
    struct view view;
    double x_px, y_px;
};

struct pick_answer { /* mem_free */
    struct pick_query query;
    struct pick pick;
    struct pick_answer *next;
};

struct pick_queue;
struct pick_queue *pick_queue_create(void);         /* never NULL */
void pick_queue_destroy(struct pick_queue **queue); /* &NULL is fine; leaves NULL */

/* Puts a copy of the question in line, in place of the client's last one if that still waits. */
void pick_queue_ask(struct pick_queue *queue, const struct pick_query *query);
/* Drops the client's question and answers. */
void pick_queue_forget(struct pick_queue *queue, uint64_t client);
/* Returns whether a question waits. */
bool pick_queue_has_query(struct pick_queue *queue);
/* Takes the oldest question out. Returns false if there is none. */
bool pick_queue_take(struct pick_queue *queue, struct pick_query *out);
/* Adds an answer. Returns true if it is the first since the last pick_queue_collect, so that somebody is to be notified. */
bool pick_queue_answer(struct pick_queue *queue, const struct pick_query *query, const struct pick *pick);
/* Returns all answers, oldest first; the caller frees each with mem_free. NULL: none. */
struct pick_answer *pick_queue_collect(struct pick_queue *queue);

#endif
