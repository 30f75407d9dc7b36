/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Connection identity: who is at the other end of a connection, by its address and the headers of its requests. Thread: the loop. */
#ifndef NET_CONNECTION_H
#define NET_CONNECTION_H
#include "net/server_context.h"

struct connection {               /* lives as long as the connection */
    struct address_usage *usage;  /* of the address that connected; a reference */
    struct address_usage *client; /* of the client: behind a proxy, the address that the last request names; a reference */
    char address[64];             /* the client's, for the log */
    enum role role;               /* by the last request's headers */
    struct token_holder holder;
    char token[TOKEN_MAX_CHARS + 1]; /* of the last request; "": none */
    bool answered; /* nothing that it asked waits for an answer */
    uint64_t received_before_head; /* bytes, when the wait for the next request began; UINT64_MAX: none (http/stuck_head.h) */
};

/* Decides about a socket before a connection is made of it. Returns false if it is to be closed. */
bool connection_may_open(struct server_context *server, int fd);
/* Adds and removes the identity of a connection. */
void connection_open(struct server_context *server, struct lws *wsi);
void connection_close(struct server_context *server, struct lws *wsi);
/* Notes whether all that it asked was answered, so that a server that goes down waits for those where it was not. */
void connection_set_answered(struct server_context *server, struct lws *wsi, bool answered);
/* Returns the identity of an open connection. */
struct connection *connection_of(struct lws *wsi);

struct http_refusal {
    int status;
    const char *text; /* static */
};
/* Reads the headers of a request and sets role, client and holder by them. Returns false with *refusal holding the answer. */
bool connection_identify(struct server_context *server, struct lws *wsi, struct http_refusal *refusal);
/* Adds a suffix to the name of a person who is signed in if a token has the same name, or if it is `local`: journals and the audit trail
   must tell them apart. */
void connection_tell_apart(const struct server_context *server, struct token_holder *person);
/* Returns the name of whoever made the last request, for journals and lists; "local" without one. */
const char *connection_who(const struct connection *connection);
/* Records what a request of somebody who is known was about. result: as in struct audit_entry; why: of a refusal, or NULL. */
void connection_record(const struct server_context *server, struct lws *wsi, const char *event, const char *result, const char *path,
                       const char *why);
/* Logs and counts what became of a token, or of a session that needed none. way: static; holder: of the token; role ROLE_NOBODY: it is
   not in the file. */
void connection_log_login(struct server_context *server, struct lws *wsi, const char *way, const struct token_holder *holder,
                          enum login login);
/* Copies a header into out; "" if there is none. Returns false if it is too long. */
bool connection_header(struct lws *wsi, enum lws_token_indexes token, char *out, int size);
/* Finds the machine's own host name, under which it may be asked for. Once, at the start. */
void connection_learn_host_name(struct server_context *server);

#endif
