/* SPDX-License-Identifier: GPL-3.0-or-later */
/* HTTP requests: their state, their answers, and waiting for content. Private to http*.c. Call only in the event loop. */
#ifndef NET_HTTP_IMPL_H
#define NET_HTTP_IMPL_H
#include "importing/export_folder.h"
#include "net/server_context.h"

struct asked { /* the picture, or the pick (what is at a pixel), for which an HTTP request waits */
    bool picks;
    struct frame_request frame_request;
    char **args; /* percent-decoded arguments of the URL, which a picture's signature covers; freed by asked_free() */
    size_t arg_count;
    struct pick_query pick;
    /* readings of the past instant that the picture shows (a reference); NULL: it shows the present, or the readings are still being
       loaded */
    const struct historical_snapshot *historical;
};

struct http_exchange {
    struct lws *wsi;
    /* usage of the client's address, while the request waits; the connection holds the reference */
    struct address_usage *usage;
    bool head;              /* true: the request's method is HEAD, so the answer has no body */
    bool close;             /* true: the connection is to be closed once this answer is sent */
    int64_t body_left;      /* number of bytes of the request's body that have not arrived yet */
    /* monotonic time until which the rest of the body is read and discarded, because the request was answered before the body had
       arrived; 0: the request was not answered so early */
    int64_t discards_until_ns;
    bool sandboxed; /* true: the answer belongs to a sandboxed document (opaque origin), which Chromium runs in a process of its own */
    bool varies;            /* true: the next answer depends on the request's header Accept-Encoding */
    bool gzip;              /* true: the body of the next answer is compressed as gzip */
    char *set_cookie;       /* value of the header Set-Cookie of the next answer; NULL: the answer sets no cookie */
    struct refusal refusal; /* refusal to be sent in the header Plantcast-Refusal of the next answer; REFUSAL_NONE: no such header */
    char *body;
    size_t count, sent;
    /* usage of the address to whose answer_bytes the body is added; NULL: the body is not counted. The connection holds the reference */
    struct address_usage *holder;
    bool asks;         /* true: a history query of this request is in progress; it counts in server->http.questions */
    bool asks_instant; /* true: the request comes from a renderer and asks for the readings of a past instant */
    enum {
        PIECES_NONE,
        PIECES_CHUNKED,
        PIECES_TO_END
    } pieces; /* how the body is sent: with the headers, in HTTP chunks, or in pieces up to the end of the connection */
    bool last_piece;             /* true: `body` is the last piece of the answer */
    uint64_t client;             /* id by which request_find() finds the request while it waits */
    int64_t until_ns;            /* monotonic time at which the waiting request is answered with "not ready" */
    uint64_t reload;             /* number of the plant's reload for which the request waits (reload_ask()); 0: none */
    /* true: the requested action was carried out, but the answer waits until line `record` of the audit trail is on disk */
    bool recorded;
    struct settling_ticket record; /* line of the audit trail that records the request */
    struct upload_body *body_in; /* upload in progress; NULL: none */
    const char *step;            /* path of a POST request of an import (static text), for the audit trail */
    struct asked *asked;         /* frame or pick for which the request waits; NULL: none */
    struct http_exchange *next;  /* next element of the linked list server->http.waiting */
};

enum { MAX_ARGS = 64, MAX_ARG_BYTES = 2048 };
struct args { /* decoded arguments of a query */
    char bytes[MAX_ARGS][MAX_ARG_BYTES];
    const char *list[MAX_ARGS];
    size_t count;
};

#define HTTP_TEXT "text/plain; charset=utf-8"
/* paths of POST requests */
#define RELOAD_PATH "/api/v1/reload"
#define LOGOUT_PATH "/logout"

/* Functions that return int return the result for the libwebsockets callback: 0, or -1 to close the connection. */

/* Sends an answer with one extra header (NULL: none). Takes ownership of body (mem_free), which is written as the socket accepts it. */
int request_answer(struct http_exchange *request, int status, const char *type, char *body, size_t count, const char *extra_name,
                   const char *extra);
/* Sends a copy of a text as the answer. */
int request_answer_text(struct http_exchange *request, int status, const char *text);
/* Sends the headers of an answer whose body is sent in pieces (http_chunked.c). */
int chunked_begin(struct http_exchange *request, const char *type);
/* Adds a piece of the body. Call it only after the previous piece was sent. Takes ownership of body (mem_free). */
void chunked_append(struct http_exchange *request, char *body, size_t count, bool last);
/* Writes as much of the current piece of the body as the socket accepts in one write. */
int chunked_write(struct server_context *server, struct http_exchange *request);
/* Answers 503 with Retry-After. */
int request_answer_later(struct http_exchange *request, const char *why);
/* Answers with a refusal without arguments; status 503 also gets Retry-After. */
int request_refuse(struct http_exchange *request, int status, enum refusal_code code);
int request_refuse_for(struct http_exchange *request, int status, const struct refusal *refusal);
/* Refuses a request from a page of another site, and records that in the audit trail. path: path of the request. */
int request_refuse_foreign(struct server_context *server, struct http_exchange *request, const char *path);
/* Answers that history cannot be read: with 500; on a renderer, which reads history from its core, with 503 and Retry-After. */
int request_answer_unreadable(const struct server_context *server, struct http_exchange *request);
/* Answers with a JSON text; takes ownership of text (mem_free). */
int request_answer_json(struct http_exchange *request, char *text);
/* Answers with status 400 (bad request) and the text of the error. */
int request_answer_error(struct http_exchange *request, const struct message_error *error);
/* Sets the body of the request's answer (NULL: none) and frees its previous body; takes ownership. Counts the bytes as unread, for the
   server and for the client's address. */
void request_hold(struct http_exchange *request, char *body, size_t count);
/* Writes status line and headers. Returns false if the connection is gone. */
bool request_write_head(struct http_exchange *request, int status, const char *type, const char *extra_name, const char *extra);
/* Ends the request once its answer is sent completely, and frees what the request holds. Returns the result for the
   libwebsockets callback: 0 keeps the connection, -1 closes it. */
int request_done(struct http_exchange *request);
/* Percent-decodes the arguments of the URL's query. Returns false with *error. */
bool request_args(struct lws *wsi, struct args *args, struct message_error *error);
/* Returns the value of the first argument with that name; NULL: there is none. */
const char *arg_of(const struct args *args, const char *name);

/* Makes the request wait, to be answered later from outside of its own libwebsockets callback. Sets request->client, the id by
   which the waiting request is found. */
void request_await(struct server_context *server, struct http_exchange *request);
/* Returns the request that waits under that id; NULL: none. */
struct http_exchange *request_find(const struct server_context *server, uint64_t client);
/* Ends the wait of a request; does nothing if the request does not wait. */
void request_forget(struct server_context *server, struct http_exchange *request);
/* Applies the result of an answer that was given outside of the request's own callback: 0 keeps the connection, -1 closes it soon. */
void request_answered(struct http_exchange *request, int result);

/* Handlers of HTTP paths: each answers the request, or calls request_await() so that it is answered later. */
int ask_snapshot(struct server_context *server, struct http_exchange *request);
int ask_pick(struct server_context *server, struct http_exchange *request);
int ask_history(struct server_context *server, struct http_exchange *request);
int ask_drift(struct server_context *server, struct http_exchange *request);
int ask_gaps(struct server_context *server, struct http_exchange *request);
int ask_journal(struct server_context *server, struct http_exchange *request);
int ask_instant(struct server_context *server, struct http_exchange *request);
int ask_core_tags(struct server_context *server, struct http_exchange *request);
int ask_login(struct server_context *server, struct http_exchange *request);
int ask_login_callback(struct server_context *server, struct http_exchange *request);
int ask_logout(struct server_context *server, struct http_exchange *request);
int api_me(struct server_context *server, struct http_exchange *request);
int ask_reload(struct server_context *server, struct http_exchange *request);
int answer_ready(struct server_context *server, struct http_exchange *request);
int api_import(struct server_context *server, struct http_exchange *request);
int api_import_report(struct server_context *server, struct http_exchange *request);
int api_import_matches(struct server_context *server, struct http_exchange *request);
int api_alarms(struct server_context *server, struct http_exchange *request);
int api_plant(struct server_context *server, struct http_exchange *request);
int api_views(struct server_context *server, struct http_exchange *request);
int api_link(struct server_context *server, struct http_exchange *request);
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

/* Answers the request for which ask_instant() was called, once the readings of the past instant are loaded or loading has failed. */
void answer_instant(struct server_context *server, struct http_exchange *request, const struct history_loader_answer *loaded);

/* --- http_import.c: requests with which engineers import a plant; only if server->params.import is set */

/* Returns whether the path is one of the import's paths that accept POST. */
bool import_takes_post(const struct server_context *server, const char *path);
/* Appends ", PATH" to `out` for each of the import's paths that accept POST, for the text of an error about the method. */
void import_add_posts(const struct server_context *server, struct text *out);
/* Handles the head of a POST request to a path of the import; the body may follow in later events. */
int import_post(struct server_context *server, struct http_exchange *request, const char *path);
/* import_take_body() takes a piece of the POST request's body; call import_end_body() after the last piece. */
int import_take_body(struct server_context *server, struct http_exchange *request, const void *bytes, size_t count);
int import_end_body(struct server_context *server, struct http_exchange *request);
/* Removes the file of an upload that will not be completed. */
void import_abandon_body(struct http_exchange *request);

#endif
