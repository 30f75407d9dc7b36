/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reaching a daemon: its URL, and HTTP requests to it. */
#ifndef CLI_DAEMON_H
#define CLI_DAEMON_H
#include <libwebsockets.h>
#include <stdbool.h>

#include "base/text.h"

struct daemon_url {
    char host[256];
    int port;
    bool tls;
};

/* Takes --token-file and --ca, which all commands share, out of the command line. False: the reason is printed. Before any thread. */
bool daemon_take_options(int *argc, char **argv);

/* http://HOST[:PORT][/], https:// (also ws://, wss://). False: the reason is printed. */
bool daemon_url_parse(const char *text, struct daemon_url *url);
/* GET path. Returns the HTTP status; 0: no answer, the reason is printed. body: zero-initialised; free with text_finish. */
int daemon_get(const struct daemon_url *url, const char *path, struct text *body);
const char *daemon_authorization(void); /* the header's value; NULL: there is none */

/* What a client of libwebsockets needs for it: before its context is made, */
void daemon_prepare_context(const struct daemon_url *url, struct lws_context_creation_info *info);
void daemon_prepare_connection(const struct daemon_url *url, struct lws_client_connect_info *info);
/* and for LWS_CALLBACK_CLIENT_APPEND_HANDSHAKE_HEADER. 0, or -1: the headers do not fit. */
int daemon_add_token(struct lws *wsi, void *in, size_t len);

#endif
