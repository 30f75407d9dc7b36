/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Answers a request at once, while its body is still on its way. libsoup itself reads a whole body before it answers, however long that
 * takes. Thread: the main loop. */
#ifndef VIDEO_REFUSAL_H
#define VIDEO_REFUSAL_H

#include <libsoup/soup.h>

/* For each connection, before soup_server_accept_iostream is given it with this address: what refusal_send ends. */
void refusal_know(GSocketAddress *peer, GSocket *socket);

/* Sends the status, headers and body that message has as its response, takes no more requests on that connection, and closes it when the
 * peer has, or 5 s later. For early handlers: the message is done when this returns. */
void refusal_send(SoupServer *server, SoupServerMessage *message);

#endif
