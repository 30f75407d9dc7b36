/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tests whether WebSockets can reach a daemon that answers over HTTP. Call from one thread only. */
#ifndef CLI_VIEWER_STREAM_REACH_H
#define CLI_VIEWER_STREAM_REACH_H
#include <stdbool.h>

#include "clients/link/daemon.h"

/* Call it after a failed WebSocket handshake. Requests /stream over HTTP. Returns true, with the reason printed, if a proxy
   between this machine and the daemon blocks WebSockets. */
bool stream_is_blocked(const struct daemon_url *url);
/* Tries a WebSocket handshake. Returns true if it succeeds within 5 s, or if the daemon itself refuses it (without a token, for
   example); else false with the reason printed. */
bool stream_passes(const struct daemon_url *url);

#endif
