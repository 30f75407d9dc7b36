/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Who is at the other end of a connection: its address, what its headers prove, what it may. Thread: the loop. */
#ifndef NET_VISITOR_H
#define NET_VISITOR_H
#include "net/hub.h"

struct visitor { /* belongs to a connection */
    struct peer *peer;   /* of the connection */
    struct peer *client; /* who is meant by the last request: behind a proxy, whom that names */
    char address[64];    /* the client's, for the log */
    enum role role;      /* by the last request's headers */
    struct token_holder holder;
};

/* Before a connection is made to anything. False: it is cut off. */
bool visitor_may_come(struct hub *hub, int fd);
void visitor_come(struct hub *hub, struct lws *wsi);
void visitor_go(struct hub *hub, struct lws *wsi);
struct visitor *visitor_of(struct lws *wsi);

struct refusal {
    int status;
    const char *text; /* static */
};
/* Reads the headers of a request. False: *refusal is the answer. */
bool visitor_enter(struct hub *hub, struct lws *wsi, struct refusal *refusal);
/* One line in the log, and the counters, for what became of a token, or of a session that needed none. way: static; holder: whose the
   token is; role ROLE_NOBODY: nobody's. */
void visitor_note_login(struct hub *hub, struct lws *wsi, const char *way, const struct token_holder *holder, enum login login);
/* A header; "": there is none. False: it is too long. */
bool visitor_header(struct lws *wsi, enum lws_token_indexes token, char *out, int size);
/* Names the machine goes by, beside those of params. Once. */
void visitor_learn_name(struct hub *hub);

#endif
