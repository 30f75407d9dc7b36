/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tells a proxy that does not pass WebSockets on from a daemon that cannot be reached. */
#include "stream_reach.h"

#include <poll.h>
#include <stdio.h>
#include <string.h>

#include "raw_websocket.h"

enum { TRIES = 50, TRY_MS = 100 };

bool stream_is_blocked(const struct daemon_url *url)
{
    struct text body = { 0 };
    int status = daemon_get(url, "/stream?why", &body);
    const char *text = body.at ? body.at : "";
    bool blocked = status > 0 && status < 500 && !(status == 426 && strstr(text, "\nrefused: "));
    if (blocked && status == 426)
        fprintf(stderr, "plantcast: the server answers over HTTP, but no WebSocket gets through. It says: %s", text);
    else if (blocked)
        fprintf(stderr, "plantcast: something in front of the server answers /stream with %d itself; it must pass WebSockets on\n", status);
    text_finish(&body);
    return blocked;
}

bool stream_opens(const struct daemon_url *url)
{
    struct raw_websocket_message message;
    const char *why;
    if (url->tls)
        return true;
    struct raw_websocket *raw = raw_websocket_connect(url, &why);
    bool over = !raw;
    for (int i = 0; i < TRIES && !over && !raw_websocket_is_open(raw); i++) {
        struct pollfd fd = { .fd = raw_websocket_fd(raw), .events = i == 0 ? POLLOUT : POLLIN };
        poll(&fd, 1, TRY_MS);
        over = raw_websocket_read(raw, &message, &why) < 0;
    }
    bool open = raw && raw_websocket_is_open(raw);
    raw_websocket_destroy(&raw);
    return open;
}
