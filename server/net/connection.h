/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Connection identity: the user and the address at the other end of a connection, from its socket and its request headers. Call
   only in the event loop. */
#ifndef NET_CONNECTION_H
#define NET_CONNECTION_H
#include "net/server_context.h"

struct connection {               /* identity of one connection; lives as long as the connection */
    struct address_usage *usage;  /* quota usage of the address that opened the connection (a reference) */
    struct address_usage *client; /* usage of the client's address: behind a proxy, the one named by the last request; a reference */
    char address[64];             /* the client's address as text, for the log */
    enum role role;               /* the user's role, according to the last request's headers */
    struct token_holder holder;
    char token[TOKEN_MAX_CHARS + 1]; /* access token of the last request on this connection; "": none */
    bool from_proxy;                 /* true: the last request came from a trusted reverse proxy */
    bool forwarded;                  /* true: the trusted proxy forwarded a client's request; false also for the proxy's own checks */
    bool answered;                   /* true: all requests of this connection have been answered */
    /* bytes that the connection had received when it began to wait for its next request; UINT64_MAX: not waiting (http/stuck_head.h) */
    uint64_t received_before_head;
};

/* Decides whether an accepted socket may become a connection, before libwebsockets adopts it. Returns false if it must be closed. */
bool connection_may_open(struct server_context *server, int fd);
/* connection_open() creates the identity of a connection, connection_close() destroys it. */
void connection_open(struct server_context *server, struct lws *wsi);
void connection_close(struct server_context *server, struct lws *wsi);
/* Sets whether all requests of the connection are answered. A server that shuts down waits for unanswered ones. */
void connection_set_answered(struct server_context *server, struct lws *wsi, bool answered);
/* Returns the identity of an open connection; it is owned by the connection. */
struct connection *connection_of(struct lws *wsi);

struct http_refusal {
    int status;
    const char *text; /* body of the answer, static text; NULL: the standard text for `code` */
    /* code of the refusal, for which pages have texts in the user's language. REFUSAL_NONE: an error of the server's operator
       or a proxy, described only by `text` */
    enum refusal_code code;
};
/* Reads the headers of a request and sets the connection's role, client and holder. Returns false, with the answer in *refusal,
   if the request must be refused. */
bool connection_identify(struct server_context *server, struct lws *wsi, struct http_refusal *refusal);
/* Appends a suffix to the name of a signed-in user if a token's holder has the same name, or if the name is `local`. So
   journals and the audit trail can distinguish these users. */
void connection_tell_apart(const struct server_context *server, struct token_holder *person);
/* Returns the name of the user behind this connection's last request, for journals and lists; "local" if the user needed no token. */
const char *connection_who(const struct connection *connection);
/* Records a request of an identified user in the audit trail. result: as in struct audit_entry; why: the reason of a refusal, or NULL. */
void connection_record(const struct server_context *server, struct lws *wsi, const char *event, const char *result, const char *path,
                       const char *why);
/* Records a refused request, event `access`, in the audit trail. why: the reason. */
void connection_record_refusal(const struct server_context *server, struct lws *wsi, const char *path, const char *why);
/* Logs and counts an accepted or refused token, or a session that needed no token. way: how the client gained access (static
   text). holder: the token's owner; role ROLE_NOBODY: the token is unknown. */
void connection_log_login(struct server_context *server, struct lws *wsi, const char *way, const struct token_holder *holder,
                          enum login login);
/* Copies a request header into out; "" if it is missing. Returns false if it is too long. */
bool connection_header(struct lws *wsi, enum lws_token_indexes token, char *out, int size);
/* Returns true if a request has no Origin header, because the client is not a browser, or one that names this host or that --origin allows.
   Callers refuse other requests: another site's page could use the rights that its visitor has here. */
bool connection_origin_allowed(const struct server_context *server, struct lws *wsi);
/* Looks up the machine's host name, which clients may use in the Host header. Call it once, at the start. */
void connection_learn_host_name(struct server_context *server);

#endif
