/* SPDX-License-Identifier: GPL-3.0-or-later */
/* History queries: series, recording gaps, drifting sensors and the alarm journal, read for HTTP on threads of their own. An
   answer comes in pieces of a few hundred kilobytes, each made on request, so that a slow reader occupies the memory of one
   piece only. Client addresses take turns. Call from any thread. */
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

struct history_answer { /* one piece of the answer to a query; free with history_answer_free() */
    uint64_t client;
    bool csv;
    bool first, last; /* first: this is the first piece of the answer; last: no piece follows */
    char *text;       /* text of the piece; NULL: history could not be read, and no more pieces come */
    size_t length;
    struct history_answer *next;
};

struct history_queries;
/* Frees one piece of an answer and sets *answer to NULL. */
void history_answer_free(struct history_answer **answer);

/* Starts the threads; they call notify(arg) when a piece is ready. Returns NULL if they cannot start, already logged. plant,
   scene and core_link must outlive the queries. scene NULL: drift queries are not used. folder: folder of the recorded history;
   NULL: the core has the history, reached through core_link. */
struct history_queries *history_queries_create(struct log *log, const struct plant *plant, const struct scene *scene, const char *folder,
                                               struct core_link *core_link, void (*notify)(void *arg), void *arg);
/* Ends the threads and sets *queries to NULL; accepts a pointer to NULL. */
void history_queries_destroy(struct history_queries **queries);
/* Queues a copy of the query. Returns false if HISTORY_QUERIES_MOST queries are already in progress. */
bool history_queries_ask(struct history_queries *queries, const struct history_query *query);
/* Requests the next piece of the client's answer, after the previous one was sent. */
void history_queries_continue(struct history_queries *queries, uint64_t client);
/* Drops the client's query, and pieces of its answer that were not collected yet. */
void history_queries_forget(struct history_queries *queries, uint64_t client);
/* Returns all finished pieces of answers, oldest first; the caller owns them. NULL: none. */
struct history_answer *history_queries_collect(struct history_queries *queries);

#endif
