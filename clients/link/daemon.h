/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Connects to a daemon: its URL, TLS and token, and HTTP requests to it. */
#ifndef LINK_DAEMON_H
#define LINK_DAEMON_H
#include <libwebsockets.h>
#include <stdbool.h>

#include "access/access.h"
#include "base/text/text.h"

struct daemon_url {
    char host[256];
    int port;
    bool tls;
    char base[256]; /* path in front of all others, where a proxy serves the daemon below one: "/b", or "" */
};

/* Removes --token-file and --ca, which all commands share, from the command line and remembers them. Returns false with the reason printed.
   Before any thread starts. */
bool daemon_take_options(int *argc, char **argv);
/* Returns the command line with these options put back, as another program is to be given it, NULL at its end. The caller frees it
   (mem_free), but not its words. */
char **daemon_command_line(int argc, char **argv);
/* Parses http://HOST[:PORT][/BASE][/] or https:// (also ws://, wss://). Returns false with the reason printed. */
bool daemon_url_parse(const char *text, struct daemon_url *url);
/* Requests GET path and appends the response body to *body (zero-initialised; free with text_finish()). Returns the HTTP status, or 0 if
   there was no answer, with the reason printed. */
int daemon_get(const struct daemon_url *url, const char *path, struct text *body);
/* Returns the value of the Authorization header, or NULL if there is no token. Static. */
const char *daemon_authorization(void);

/* Sets what a libwebsockets client needs for this URL (TLS, CA) in the parameters of its context. */
void daemon_prepare_context(const struct daemon_url *url, struct lws_context_creation_info *info);
/* Sets host, port and TLS in the parameters of a connection. */
void daemon_prepare_connection(const struct daemon_url *url, struct lws_client_connect_info *info);
/* Adds the token's header; to be called for LWS_CALLBACK_CLIENT_APPEND_HANDSHAKE_HEADER. Returns 0, or -1 if the headers do not fit. */
int daemon_add_token(struct lws *wsi, void *in, size_t len);

#endif
