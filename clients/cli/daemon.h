/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reaching a daemon: its URL, and HTTP requests to it. */
#ifndef CLI_DAEMON_H
#define CLI_DAEMON_H
#include <stdbool.h>

#include "base/text.h"

struct daemon_url {
    char host[256];
    int port;
};

/* http://HOST[:PORT][/] (also ws://). False: the reason is printed. */
bool daemon_url_parse(const char *text, struct daemon_url *url);
/* GET path. Returns the HTTP status; 0: no answer, the reason is printed. body: zero-initialised; free with text_finish. */
int daemon_get(const struct daemon_url *url, const char *path, struct text *body);

#endif
