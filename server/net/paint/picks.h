/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Questions about pixels, on their way to the render thread and back. One of each client waits: the newest wins. Thread: any. */
#ifndef NET_PICKS_H
#define NET_PICKS_H
#include "render/pick.h"

struct pick_order {
    uint64_t client;
    uint32_t seq; /* the client's own number */
    struct view view;
    double x_px, y_px;
};

struct pick_answer { /* mem_free */
    struct pick_order order;
    struct pick pick;
    struct pick_answer *next;
};

struct picks;
struct picks *picks_create(void);
void picks_destroy(struct picks **picks); /* &NULL is fine; leaves NULL */

void picks_ask(struct picks *picks, const struct pick_order *order);
void picks_forget(struct picks *picks, uint64_t client);
bool picks_wait(struct picks *picks);                         /* for the render thread: there is one */
bool picks_take(struct picks *picks, struct pick_order *out); /* the oldest. False: there is none */
/* True: it is the first that nobody has collected. */
bool picks_give(struct picks *picks, const struct pick_order *order, const struct pick *pick);
struct pick_answer *picks_collect(struct picks *picks); /* all that were given, oldest first. NULL: none */

#endif
