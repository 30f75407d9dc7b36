/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Connections to a daemon: its URL, TLS and token, and HTTP requests to it. */
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
    char base[256]; /* path prefix if a proxy serves the daemon below a path, such as "/b"; else empty */
};

/* Removes the options --token-file and --ca, which all commands share, from the command line, and stores their values. Returns false
   with the reason printed. Call it before any thread starts. */
bool daemon_take_options(int *argc, char **argv);
/* Returns the command line with the options that daemon_take_options() removed, NULL-terminated, for starting another program. The
   caller frees the array (mem_free), but not its strings. */
char **daemon_command_line(int argc, char **argv);
/* Parses http://HOST[:PORT][/BASE][/] or the same with https, ws or wss. Returns false with the reason printed. */
bool daemon_url_parse(const char *text, struct daemon_url *url);
/* Requests GET path and appends the body of the response to *body (zero-initialised; free with text_finish()). Returns the HTTP status,
   or 0 with the reason printed if there was no answer. */
int daemon_get(const struct daemon_url *url, const char *path, struct text *body);
/* Returns the value of the HTTP header Authorization, a static string; NULL: there is no token. */
const char *daemon_authorization(void);

/* Sets the TLS and CA options that this URL needs in the creation info of a libwebsockets client context. */
void daemon_prepare_context(const struct daemon_url *url, struct lws_context_creation_info *info);
/* Sets host, port and TLS of the URL in the parameters of a libwebsockets connection. */
void daemon_prepare_connection(const struct daemon_url *url, struct lws_client_connect_info *info);
/* Adds the HTTP header with the token; call it on LWS_CALLBACK_CLIENT_APPEND_HANDSHAKE_HEADER. Returns 0, or -1 if the header does not
   fit. */
int daemon_add_token(struct lws *wsi, void *in, size_t len);

#endif
