/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Whether a WebSocket gets through to a daemon that answers over HTTP. Thread: one. */
#ifndef CLI_VIEWER_STREAM_REACH_H
#define CLI_VIEWER_STREAM_REACH_H
#include <stdbool.h>

#include "clients/link/daemon.h"

/* After a WebSocket's handshake has failed: asks the stream over HTTP. Returns true with the reason printed if something between this
   machine and the daemon keeps the WebSocket out. */
bool stream_is_blocked(const struct daemon_url *url);
/* Tries a handshake. Returns true if it opens within 5 s, or the daemon itself refuses it, such as without a token; else false with the
   reason printed. */
bool stream_passes(const struct daemon_url *url);

#endif
