/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Who is at the other end of a connection: its address, what its headers prove, what it may. Thread: the loop. */
#ifndef NET_CONNECTION_H
#define NET_CONNECTION_H
#include "net/server_context.h"

struct connection {               /* belongs to a connection */
    struct address_usage *peer;   /* of the connection */
    struct address_usage *client; /* who is meant by the last request: behind a proxy, whom that names */
    char address[64];             /* the client's, for the log */
    enum role role;               /* by the last request's headers */
    struct token_holder holder;
};

/* Before a connection is made to anything. False: it is cut off. */
bool connection_may_open(struct server_context *hub, int fd);
void connection_open(struct server_context *hub, struct lws *wsi);
void connection_close(struct server_context *hub, struct lws *wsi);
struct connection *connection_of(struct lws *wsi);

struct refusal {
    int status;
    const char *text; /* static */
};
/* Reads the headers of a request. False: *refusal is the answer. */
bool connection_identify(struct server_context *hub, struct lws *wsi, struct refusal *refusal);
/* One line in the log, and the counters, for what became of a token, or of a session that needed none. way: static; holder: whose the
   token is; role ROLE_NOBODY: nobody's. */
void connection_log_login(struct server_context *hub, struct lws *wsi, const char *way, const struct token_holder *holder,
                          enum login login);
/* A header; "": there is none. False: it is too long. */
bool connection_header(struct lws *wsi, enum lws_token_indexes token, char *out, int size);
/* Names the machine goes by, beside those of params. Once. */
void connection_learn_host_name(struct server_context *hub);

#endif
