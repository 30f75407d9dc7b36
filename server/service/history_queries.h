/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Questions about the past, answered on threads of their own: the loop never waits for the disk. An answer comes in pieces of some hundred
   kilobytes, each made when it is wanted: who reads slowly costs one of them, not all. Addresses take turns. Thread: any. */
#ifndef SERVICE_HISTORY_QUERIES_H
#define SERVICE_HISTORY_QUERIES_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "message/alarm_text.h"
#include "message/message.h"
#include "plant/plant.h"

enum { HISTORY_QUERY_TAGS = 64, HISTORY_QUERY_POINTS = 20000, HISTORY_QUERIES_MOST = 128 };

struct history_query {
    uint64_t client;
    uint64_t payer;               /* whose turn it takes: the client's address; 0: there are none apart */
    int tags[HISTORY_QUERY_TAGS]; /* indices */
    int tag_count, max_points;
    int64_t from_us, to_us;
    bool csv;
    bool gaps;    /* asked instead of series: when nothing was recorded */
    bool journal; /* this is asked instead: */
    struct alarm_query alarms;
};

/* `tags=A,B&from=-8h&to=now&points=1000&format=csv`, decoded. False: *error says which is wrong. Pure. */
bool history_query_parse(const struct plant *plant, const char *const *args, size_t count, int64_t now_us, struct history_query *order,
                         struct message_error *error);

/* `from=-8h&to=now`, likewise: when nothing was recorded. Pure. */
bool history_query_parse_gaps(const char *const *args, size_t count, int64_t now_us, struct history_query *order,
                              struct message_error *error);

struct history_answer { /* a piece of one: history_answer_free */
    uint64_t client;
    bool csv;
    bool first, last; /* of its pieces */
    char *text;       /* NULL: history could not be read, and nothing more comes */
    size_t length;
    struct history_answer *next;
};

struct history_queries;
void history_answer_free(struct history_answer **answer);

/* notify is called on a thread when there is an answer. NULL: no thread, logged. plant must outlive it. */
struct history_queries *history_queries_create(struct log *log, const struct plant *plant, const char *folder, void (*notify)(void *arg),
                                               void *arg);
void history_queries_destroy(struct history_queries **recall);                               /* &NULL is fine; leaves NULL */
bool history_queries_ask(struct history_queries *recall, const struct history_query *order); /* false: too many are being answered */
void history_queries_continue(struct history_queries *recall, uint64_t client); /* its last piece has gone: the next is wanted */
void history_queries_forget(struct history_queries *recall, uint64_t client);
struct history_answer *history_queries_collect(struct history_queries *recall); /* oldest first; NULL: none */

#endif
