/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The client's side of one WebSocket over plain TCP, for viewers that do not decode: of a binary message only the first bytes are read, the
   rest is dropped in the kernel. libwebsockets looks at each byte by itself, 0.3 ms for a frame of 40 kB; that is what hundreds of viewers
   on the daemon's own machine would measure. Thread: one. */
#ifndef CLI_RAW_WEBSOCKET_H
#define CLI_RAW_WEBSOCKET_H
#include "base/text.h"
#include "daemon.h"

struct raw_websocket_message {
    bool binary;
    size_t count;   /* of all of it */
    const char *at; /* of a text all bytes, and a 0; of a binary message the first RAW_WEBSOCKET_KEPT_BYTES of them */
};
enum { RAW_WEBSOCKET_KEPT_BYTES = 128 };

struct raw_websocket;
/* Begins to connect to /stream. NULL: it cannot; *why says so. */
struct raw_websocket *raw_websocket_connect(const struct daemon_url *url, const char **why);
void raw_websocket_destroy(struct raw_websocket **raw); /* says goodbye if it can; &NULL is fine; leaves NULL */
int raw_websocket_fd(const struct raw_websocket *raw);
bool raw_websocket_is_open(const struct raw_websocket *raw); /* the server has agreed: messages may be sent */
/* The socket is ready. 1: *message is there, until the next call: call again; 0: nothing more for now; negative: it is over, *why says
   so. */
int raw_websocket_read(struct raw_websocket *raw, struct raw_websocket_message *message, const char **why);
/* One text. False: the connection is gone, or takes nothing. */
bool raw_websocket_send(struct raw_websocket *raw, const char *text, size_t count);

#endif
