/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Raw WebSocket client over plain TCP, for viewers that do not decode: of a binary message only the first bytes are read, the rest is
   dropped in the kernel. libwebsockets looks at every byte, 0.3 ms for a frame of 40 kB; hundreds of viewers on the daemon's own machine
   would measure that instead. Thread: one. */
#ifndef CLI_VIEWER_RAW_WEBSOCKET_H
#define CLI_VIEWER_RAW_WEBSOCKET_H
#include "base/text/text.h"
#include "clients/link/daemon.h"

struct raw_websocket_message {
    bool binary;
    size_t count;   /* of all of it */
    const char *at; /* of a text all bytes, and a 0; of a binary message the first RAW_WEBSOCKET_KEPT_BYTES of them */
};
enum { RAW_WEBSOCKET_KEPT_BYTES = 128 };

struct raw_websocket;
/* Begins to connect to /stream. Returns the connection, which the caller destroys, or NULL with the reason in *why. */
struct raw_websocket *raw_websocket_connect(const struct daemon_url *url, const char **why);
/* Sends a close frame if it can, and frees the connection. &NULL is fine; leaves NULL. */
void raw_websocket_destroy(struct raw_websocket **raw);
/* Returns the socket, for polling. */
int raw_websocket_fd(const struct raw_websocket *raw);
/* Returns whether the server has accepted the handshake, so that messages may be sent. */
bool raw_websocket_is_open(const struct raw_websocket *raw);
/* Reads from the socket when it is ready. Returns 1 with *message set until the next call (call again), 0 if there is nothing more for now,
   or a negative number with the reason in *why if the connection is over; *why is not to be freed, and valid while `raw` is. */
int raw_websocket_read(struct raw_websocket *raw, struct raw_websocket_message *message, const char **why);
/* Sends one text message. Returns false if the connection is gone or takes nothing. */
bool raw_websocket_send(struct raw_websocket *raw, const char *text, size_t count);

#endif
