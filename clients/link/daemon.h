/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Connections to a daemon: its URL, TLS and token, and HTTP requests to it. */
#ifndef LINK_DAEMON_H
#define LINK_DAEMON_H
#include <libwebsockets.h>
#include <stdbool.h>

#include "access/access.h"
#include "base/text/text.h"
#include "message/message.h"

struct daemon_access { /* values of the options --token-file and --ca */
    char authorization[TOKEN_MAX_CHARS + sizeof("Bearer ")]; /* value of the HTTP header Authorization; empty: no token */
    const char *token_path, *ca_path;                        /* token file; file of trusted certificates; NULL: not given */
};

struct daemon_url {
    char host[256];
    int port;
    bool tls;
    char base[256]; /* path prefix, such as "/b", if a proxy serves the daemon below one; else empty */
    const struct daemon_access *access;
};

/* Moves --token-file and --ca, which all commands accept, from the command line to *access. Returns false with the reason printed. */
bool daemon_take_options(int *argc, char **argv, struct daemon_access *access);
/* Returns the command line, NULL-terminated, with the options that daemon_take_options() removed, to start another program
   with. The caller frees the array (mem_free), but not its strings. */
char **daemon_command_line(const struct daemon_access *access, int argc, char **argv);
/* Parses http://HOST[:PORT][/BASE][/] or the same with https, ws or wss. `access` must outlive *url. Returns false with the reason
   printed. */
bool daemon_url_parse(const char *text, const struct daemon_access *access, struct daemon_url *url);
/* Requests GET path and appends the body of the response to *body (zero-initialised; free with text_finish()). Returns the HTTP status,
   or 0 with the reason printed if there was no whole answer. */
int daemon_get(const struct daemon_url *url, const char *path, struct text *body);

/* Sets the TLS and CA options for this URL in the creation info of a libwebsockets client context. */
void daemon_prepare_context(const struct daemon_url *url, struct lws_context_creation_info *info);
/* Copies the URL's host, port and TLS setting to the parameters of a libwebsockets connection. */
void daemon_prepare_connection(const struct daemon_url *url, struct lws_client_connect_info *info);
/* Adds the HTTP header with the access token; call it on LWS_CALLBACK_CLIENT_APPEND_HANDSHAKE_HEADER. Returns 0, or -1 if the header does
   not fit. */
int daemon_add_token(const struct daemon_access *access, struct lws *wsi, void *in, size_t len);

#endif
