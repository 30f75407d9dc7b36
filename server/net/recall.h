/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Questions about the past, answered on threads of their own: the loop never waits for the disk. An answer comes in pieces of some hundred
   kilobytes, each made when it is wanted: who reads slowly costs one of them, not all. Addresses take turns. Thread: any. */
#ifndef NET_RECALL_H
#define NET_RECALL_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/log.h"
#include "net/message/alarm_text.h"
#include "net/message/message.h"
#include "plant/plant.h"

enum { RECALL_TAGS = 64, RECALL_POINTS = 20000, RECALL_QUESTIONS = 128 };

struct recall_order {
    uint64_t client;
    uint64_t payer;        /* whose turn it takes: the client's address; 0: there are none apart */
    int tags[RECALL_TAGS]; /* indices */
    int tag_count, max_points;
    int64_t from_us, to_us;
    bool csv;
    bool gaps;    /* asked instead of series: when nothing was recorded */
    bool journal; /* this is asked instead: */
    struct alarm_query alarms;
};

/* `tags=A,B&from=-8h&to=now&points=1000&format=csv`, decoded. False: *error says which is wrong. Pure. */
bool recall_parse(const struct plant *plant, const char *const *args, size_t count, int64_t now_us, struct recall_order *order,
                  struct message_error *error);

/* `from=-8h&to=now`, likewise: when nothing was recorded. Pure. */
bool recall_parse_gaps(const char *const *args, size_t count, int64_t now_us, struct recall_order *order, struct message_error *error);

struct recall_answer { /* a piece of one: recall_answer_free */
    uint64_t client;
    bool csv;
    bool first, last; /* of its pieces */
    char *text;       /* NULL: history could not be read, and nothing more comes */
    size_t length;
    struct recall_answer *next;
};

struct recall;
void recall_answer_free(struct recall_answer **answer);

/* notify is called on a thread when there is an answer. NULL: no thread, logged. plant must outlive it. */
struct recall *recall_create(struct log *log, const struct plant *plant, const char *folder, void (*notify)(void *arg), void *arg);
void recall_destroy(struct recall **recall); /* &NULL is fine; leaves NULL */
bool recall_ask(struct recall *recall, const struct recall_order *order); /* false: too many are being answered */
void recall_go_on(struct recall *recall, uint64_t client); /* its last piece has gone: the next is wanted */
void recall_forget(struct recall *recall, uint64_t client);
struct recall_answer *recall_collect(struct recall *recall); /* oldest first; NULL: none */

#endif
