/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the parts of the loop share: writing to a socket, and letting the render thread begin. */
#include "net/server_context.h"

#include <string.h>

bool net_write(struct server_context *server, struct lws *wsi, const void *bytes, size_t count, enum lws_write_protocol how)
{
    memcpy(server->out + LWS_PRE, bytes, count);
    return lws_write(wsi, server->out + LWS_PRE, count, how) >= (int)count;
}

void net_wake_render_service(struct server_context *server)
{
    if (server->asked)
        render_service_wake(server->params.plant.render_service);
    server->asked = false;
}
