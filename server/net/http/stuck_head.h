/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Closes connections whose request has begun but stalls before its head is complete. The parser of libwebsockets would never
   end a request head in which a header's name is only the beginning of a known name, such as `Acc:`: it waits for the rest of
   the name. Call only in the event loop. */
#ifndef HTTP_STUCK_HEAD_H
#define HTTP_STUCK_HEAD_H
#include "net/server_context.h"

/* Begins to watch for the next request's head (its first line and headers): call it when a connection opens, and when a request
   is done. first: true: this is the connection's first request, whose bytes may have arrived before the connection was
   accepted. */
void stuck_head_await(struct lws *wsi, bool first);
/* Ends the watch for stalled heads, because the request's head is complete. */
void stuck_head_arrived(struct lws *wsi);
/* Handles LWS_CALLBACK_TIMER. Returns -1 if the connection must be closed because its request stalled for 2 s; the client was
   then sent 408. Otherwise returns 0. */
int stuck_head_look(struct server_context *server, struct lws *wsi);

#endif
