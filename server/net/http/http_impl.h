/* SPDX-License-Identifier: GPL-3.0-or-later */
/* HTTP requests: their state, their answers, and waiting for those. Private to http*.c. Thread: the loop. */
#ifndef NET_HTTP_IMPL_H
#define NET_HTTP_IMPL_H
#include "importing/export_folder.h"
#include "net/server_context.h"

struct asked { /* a frame, or what is at a pixel of it, that a request waits for */
    bool picks;
    struct frame_request frame_request;
    char **args; /* of the query, for the statement of a signed picture (asked_free) */
    size_t arg_count;
    struct pick_query pick;
    const struct historical_snapshot *historical; /* a reference; NULL: readings of now, or they are still being loaded */
};

struct http_exchange {
    struct lws *wsi;
    struct address_usage *usage; /* of its address, while it waits; the connection holds the reference */
    bool head;                   /* no body is wanted */
    bool close;                  /* after the answer */
    bool sandboxed;              /* the answer belongs to a document with an origin and, in Chromium, a process of its own */
    char *set_cookie;            /* sent with the next head; NULL: none */
    struct refusal refusal;      /* sent with the next head, as the header Plantcast-Refusal; REFUSAL_NONE: none */
    char *body;
    size_t count, sent;
    struct address_usage *holder; /* in whose answer_bytes the body is counted; NULL: in none. The connection holds the reference */
    bool asks;                    /* a history query is being answered */
    bool asks_instant;            /* it is one for the readings of an instant, of a renderer */
    enum {
        PIECES_NONE,
        PIECES_CHUNKED,
        PIECES_TO_END
    } pieces;             /* its head was sent, and the body follows in pieces, chunked or up to the end of the connection */
    bool last_piece;      /* `body` is the last piece */
    uint64_t client;      /* its number while it waits (request_await) */
    int64_t until_ns;     /* monotonic: then it is answered that what it waits for is not ready */
    bool reloads;         /* it waits for a reload of the plant */
    struct upload_body *body_in; /* the upload in progress, or NULL */
    const char *step;     /* of an import: its path, static, for the audit trail */
    struct asked *asked;  /* what it waits for; NULL: nothing to be drawn */
    struct http_exchange *next; /* in server->snapshots */
};

enum { MAX_ARGS = 32, MAX_ARG_BYTES = 2048 };
struct args { /* of the query, decoded */
    char bytes[MAX_ARGS][MAX_ARG_BYTES];
    const char *list[MAX_ARGS];
    size_t count;
};

#define HTTP_TEXT "text/plain; charset=utf-8"

/* Functions that return int return what the lws callback is to return. */

/* Sends an answer with one extra header, or none (NULL). Takes body (mem_free), which is written as the socket takes it. */
int request_answer(struct http_exchange *request, int status, const char *type, char *body, size_t count, const char *extra_name,
                   const char *extra);
/* Sends a copy of a text. */
int request_answer_text(struct http_exchange *request, int status, const char *text);
/* Sends the head of an answer whose body comes in pieces (http_chunked.c). */
int chunked_begin(struct http_exchange *request, const char *type);
/* Adds a piece, once the one before was sent. Takes body (mem_free). */
void chunked_append(struct http_exchange *request, char *body, size_t count, bool last);
/* Makes one write. */
int chunked_write(struct server_context *server, struct http_exchange *request);
/* Sends 503 with Retry-After. */
int request_answer_later(struct http_exchange *request, const char *why);
/* Sends a refusal that has no arguments; with 503 also Retry-After. */
int request_refuse(struct http_exchange *request, int status, enum refusal_code code);
/* Says that history cannot be read: 500, or of a renderer, whose core has it, 503 with Retry-After. */
int request_answer_unreadable(const struct server_context *server, struct http_exchange *request);
/* Sends JSON; takes text (mem_free). */
int request_answer_json(struct http_exchange *request, char *text);
/* Sends 400 with the error's text. */
int request_answer_error(struct http_exchange *request, const struct message_error *error);
/* Takes body in place of the one before (NULL: none), and counts its bytes for all and for the address. */
void request_hold(struct http_exchange *request, char *body, size_t count);
/* Writes status line and headers. Returns false when the connection is gone. */
bool request_write_head(struct http_exchange *request, int status, const char *type, const char *extra_name, const char *extra);
/* Ends the request once its answer is sent completely, and frees what it holds. Returns what the callback of libwebsockets returns: 0 keeps
   the connection, -1 closes it. */
int request_done(struct http_exchange *request);
/* Decodes the arguments of the query. Returns false with *error saying what is wrong. */
bool request_args(struct lws *wsi, struct args *args, struct message_error *error);
/* Returns the value of the first argument of that name; NULL: there is none. */
const char *arg_of(const struct args *args, const char *name);

/* Has the request wait: it gets a number, request->client, and is answered outside of its own callback. */
void request_await(struct server_context *server, struct http_exchange *request);
/* Frees what the request asked for. &NULL is fine; leaves NULL. */
void asked_free(struct asked **asked);
/* Returns the request that waits under that number; NULL: none. */
struct http_exchange *request_find(const struct server_context *server, uint64_t client);
/* Ends its waiting, if it waits. */
void request_forget(struct server_context *server, struct http_exchange *request);
/* Notes the result of an answer that was given outside of its callback: a broken connection is closed soon. */
void request_answered(struct http_exchange *request, int result);

/* Handlers, by path: each answers, or has the request wait. */
int ask_snapshot(struct server_context *server, struct http_exchange *request);
int ask_pick(struct server_context *server, struct http_exchange *request);
int ask_history(struct server_context *server, struct http_exchange *request);
int ask_drift(struct server_context *server, struct http_exchange *request);
int ask_gaps(struct server_context *server, struct http_exchange *request);
int ask_journal(struct server_context *server, struct http_exchange *request);
int ask_instant(struct server_context *server, struct http_exchange *request);
int ask_login(struct server_context *server, struct http_exchange *request);
int ask_login_callback(struct server_context *server, struct http_exchange *request);
int ask_logout(struct server_context *server, struct http_exchange *request);
int api_me(struct server_context *server, struct http_exchange *request);
int ask_reload(struct server_context *server, struct http_exchange *request);
int api_import(struct server_context *server, struct http_exchange *request);
int api_import_report(struct server_context *server, struct http_exchange *request);
int api_import_matches(struct server_context *server, struct http_exchange *request);
int api_alarms(struct server_context *server, struct http_exchange *request);
int api_plant(struct server_context *server, struct http_exchange *request);
int api_views(struct server_context *server, struct http_exchange *request);
int api_notes(struct server_context *server, struct http_exchange *request);
int api_walls(struct server_context *server, struct http_exchange *request);
int api_other_plants(struct server_context *server, struct http_exchange *request);
int ask_other_picture(struct server_context *server, struct http_exchange *request);
int api_pair(struct server_context *server, struct http_exchange *request);
int api_devices(struct server_context *server, struct http_exchange *request);
int api_loop_checks(struct server_context *server, struct http_exchange *request);
int api_tags(struct server_context *server, struct http_exchange *request);
int api_neighbours(struct server_context *server, struct http_exchange *request);
int metrics(struct server_context *server, struct http_exchange *request);

/* Answers ask_instant: the instant was read, or could not be. */
void answer_instant(struct server_context *server, struct http_exchange *request, const struct history_loader_answer *loaded);

/* Returns whether the page that sent this request may change things here: a page of another site may have its user's browser send it. */
bool request_may_change(struct server_context *server, struct http_exchange *request);

/* --- http_import.c: requests that engineers bring a plant in with; only where server->params.import is set */

/* Returns whether this is a path for POST. */
bool import_takes_post(const struct server_context *server, const char *path);
/* Begins a POST, whose body may follow. */
int import_post(struct server_context *server, struct http_exchange *request, const char *path);
/* Take a piece of the body, and its end. */
int import_take_body(struct server_context *server, struct http_exchange *request, const void *bytes, size_t count);
int import_end_body(struct server_context *server, struct http_exchange *request);
/* Removes what was uploaded of a body that will not end. */
void import_abandon_body(struct http_exchange *request);

#endif
