/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of HTTP share: a request, its answer, and waiting for it. Private to http*.c. Thread: the loop. */
#ifndef NET_HTTP_IMPL_H
#define NET_HTTP_IMPL_H
#include "net/server_context.h"

struct asked { /* a picture, or what is at a pixel of it */
    bool picks;
    struct frame_request wish;
    struct pick_query pick;
    const struct historical_snapshot *historical; /* held; NULL: of now, or it is being read */
};

struct request {
    struct lws *wsi;
    struct address_usage *peer; /* whose it is, while it waits; the connection's visitor keeps it */
    bool head;                  /* no body is wanted */
    bool close;                 /* after the answer */
    char *body;
    size_t count, sent;
    struct address_usage *holder; /* in whose answer_bytes the body is counted; NULL: in none. The connection's visitor keeps it */
    bool asks;                    /* a question about the past is being answered: */
    enum { PIECES_NONE, PIECES_CHUNKED, PIECES_TO_END } pieces; /* its head was sent, and the body comes in so many pieces as it takes */
    bool last_piece;                                            /* the body is */
    uint64_t client;                                            /* of the painter, while a picture is awaited */
    bool reloads;                                               /* the plant is: that is what is awaited */
    struct asked *asked;                                        /* meanwhile; NULL: not for one */
    struct request *next;                                       /* in hub->snapshots */
};

enum { MAX_ARGS = 32, MAX_ARG_BYTES = 2048 };
struct args { /* of the query, decoded */
    char bytes[MAX_ARGS][MAX_ARG_BYTES];
    const char *list[MAX_ARGS];
    size_t count;
};

#define HTTP_TEXT "text/plain; charset=utf-8"
#define HTTP_NOTHING_RECORDED "this daemon records nothing (history: record: no)\n"
#define HTTP_UNREADABLE "history cannot be read; the log says why\n"

/* Answers return what the callback is to return. request_answer takes body; the rest happens as the socket takes it. */
int request_answer(struct request *request, int status, const char *type, char *body, size_t count, const char *extra_name,
                   const char *extra);
int request_answer_text(struct request *request, int status, const char *text);
/* The same for a body that comes in pieces, each when the one before was sent: http_pieces.c. */
int chunked_begin(struct request *request, const char *type);
void chunked_append(struct request *request, char *body, size_t count, bool last); /* takes body */
int chunked_write(struct server_context *hub, struct request *request);            /* one write; as on_writeable */
int request_answer_later(struct request *request, const char *why);                /* 503, and when to come again */
int request_answer_json(struct request *request, char *text);                      /* takes text */
int request_answer_error(struct request *request, const struct message_error *error);
/* Takes body in place of the one before, and counts what there is of it in memory: of all, and of the address. NULL: none. */
void request_hold(struct request *request, char *body, size_t count);
bool request_write_head(struct request *request, int status, const char *type, const char *extra_name, const char *extra);
int request_done(struct request *request); /* all of its answer was sent */
bool request_args(struct lws *wsi, struct args *args, struct message_error *error);

/* A request that waits has a number, request->client, and is answered outside of its own callback. */
void request_await(struct server_context *hub, struct request *request);
struct request *request_find(const struct server_context *hub, uint64_t client);
void request_forget(struct server_context *hub, struct request *request); /* it waits no more; as well if it did not */
void request_answered(struct request *request, int result);               /* result of its answer: a broken connection is closed soon */

int ask_snapshot(struct server_context *hub, struct request *request);
int ask_pick(struct server_context *hub, struct request *request);
int ask_history(struct server_context *hub, struct request *request);
int ask_gaps(struct server_context *hub, struct request *request);
int ask_journal(struct server_context *hub, struct request *request);
int ask_reload(struct server_context *hub, struct request *request);
int api_alarms(struct server_context *hub, struct request *request);
int api_plant(struct server_context *hub, struct request *request);
int api_proofs(struct server_context *hub, struct request *request);
int api_tags(struct server_context *hub, struct request *request);
int metrics(struct server_context *hub, struct request *request);

#endif
