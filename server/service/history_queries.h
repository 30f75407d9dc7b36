/* SPDX-License-Identifier: GPL-3.0-or-later */
/* History queries: series, recording gaps, drifting sensors and the alarm journal, read for HTTP on threads of their own. An answer comes
   in pieces of some hundred kilobytes, each made when it is asked for, so that a slow reader costs the memory of one piece. Addresses take
   turns. Thread: any. */
#ifndef SERVICE_HISTORY_QUERIES_H
#define SERVICE_HISTORY_QUERIES_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log/log.h"
#include "corelink/core_link.h"
#include "plant/plant.h"
#include "scene/scene.h"
#include "service/history_query.h"

enum { HISTORY_QUERIES_MOST = 128 };

struct history_answer { /* one piece of an answer; history_answer_free */
    uint64_t client;
    bool csv;
    bool first, last; /* of its pieces */
    char *text;       /* NULL: history could not be read, and no more pieces come */
    size_t length;
    struct history_answer *next;
};

struct history_queries;
/* Frees the piece; leaves NULL. */
void history_answer_free(struct history_answer **answer);

/* Starts the threads; notify(arg) is called on one of them when there is a piece. Returns NULL if they cannot start, already logged.
   plant and scene must outlive it; scene: of the plant; NULL: nobody asks for drifting sensors. folder: of the history; NULL: the core has
   it, which core_link, that outlives it, too, leads to. */
struct history_queries *history_queries_create(struct log *log, const struct plant *plant, const struct scene *scene, const char *folder,
                                               struct core_link *core_link, void (*notify)(void *arg), void *arg);
/* Ends the threads. &NULL is fine; leaves NULL. */
void history_queries_destroy(struct history_queries **queries);
/* Queues a copy of the query. Returns false when HISTORY_QUERIES_MOST are being answered. */
bool history_queries_ask(struct history_queries *queries, const struct history_query *query);
/* Asks for the next piece of the client's answer; its last one was sent. */
void history_queries_continue(struct history_queries *queries, uint64_t client);
/* Drops the client's query and pieces. */
void history_queries_forget(struct history_queries *queries, uint64_t client);
/* Returns all pieces so far, oldest first; the caller owns them. NULL: none. */
struct history_answer *history_queries_collect(struct history_queries *queries);

#endif
