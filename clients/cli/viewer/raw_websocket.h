/* SPDX-License-Identifier: GPL-3.0-or-later */
/* WebSocket client without libwebsockets, over plain TCP, for viewers that do not decode. It reads only the first bytes of a
   binary message and lets the kernel drop the rest. libwebsockets touches every byte, which takes 0.3 ms for a frame of 40 kB;
   with hundreds of viewers on the daemon's machine, that cost would dominate the measurement. Call from one thread only. */
#ifndef CLI_VIEWER_RAW_WEBSOCKET_H
#define CLI_VIEWER_RAW_WEBSOCKET_H
#include "base/text/text.h"
#include "clients/link/daemon.h"

struct raw_websocket_message {
    bool binary;
    size_t count;   /* length of the whole message */
    const char *at; /* text message: all bytes and a terminating 0; binary message: its first RAW_WEBSOCKET_KEPT_BYTES bytes */
};
enum { RAW_WEBSOCKET_KEPT_BYTES = 128 };

struct raw_websocket;
/* Starts to connect to the daemon's /stream. Returns the connection, which the caller destroys, or NULL with the reason in *why. */
struct raw_websocket *raw_websocket_connect(const struct daemon_url *url, const char **why);
/* Sends a close frame if possible, and frees the connection. &NULL is fine; sets *raw to NULL. */
void raw_websocket_destroy(struct raw_websocket **raw);
/* Returns the socket, for polling. */
int raw_websocket_fd(const struct raw_websocket *raw);
/* Returns true if the server has accepted the handshake, so that messages may be sent. */
bool raw_websocket_is_open(const struct raw_websocket *raw);
/* Reads from the socket when it is readable. Returns 1 with *message, valid until the next call (call again for more); 0 if nothing more
   is available now; or a negative number if the connection is closed, with the reason in *why. *why stays valid while `raw` exists; do
   not free it. */
int raw_websocket_read(struct raw_websocket *raw, struct raw_websocket_message *message, const char **why);
/* Sends one text message. Returns false if the connection is closed or its send buffer has no room. */
bool raw_websocket_send(struct raw_websocket *raw, const char *text, size_t count);

#endif
