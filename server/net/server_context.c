/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes data to a socket, for all parts of the event loop. */
#include "net/server_context.h"

#include <string.h>

bool net_write(struct server_context *server, struct lws *wsi, const void *bytes, size_t count, enum lws_write_protocol how)
{
    memcpy(server->out + LWS_PRE, bytes, count);
    return lws_write(wsi, server->out + LWS_PRE, count, how) >= (int)count;
}
