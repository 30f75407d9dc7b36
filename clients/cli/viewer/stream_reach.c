/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Distinguishes a proxy that blocks WebSockets from a daemon that cannot be reached. */
#include "stream_reach.h"

#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "protocol/wire.h"

enum { OPEN_S = 5 };

/* Requests /stream over HTTP to find out why it failed. Returns the HTTP status; *reached is true if the daemon itself
   answered, with its reason for refusing a WebSocket. */
static int ask_why(const struct daemon_url *url, struct text *body, bool *reached)
{
    int status = daemon_get(url, "/stream?why", body);
    *reached = status == 426 && body->at && strstr(body->at, "\nrefused: ");
    return status;
}

static void print_blocked(int status, const char *text)
{
    if (status == 426)
        fprintf(stderr, "plantcast: the server answers over HTTP, but does not accept a WebSocket. Answer of the server: %s", text);
    else
        fprintf(stderr,
                "plantcast: a proxy in front of the server answered /stream with HTTP status %d: make the proxy forward WebSockets\n",
                status);
}

bool stream_is_blocked(const struct daemon_url *url)
{
    struct text body = { 0 };
    bool reached;
    int status = ask_why(url, &body, &reached);
    bool blocked = status > 0 && status < 500 && !reached;
    if (blocked)
        print_blocked(status, body.at ? body.at : "");
    text_finish(&body);
    return blocked;
}

struct handshake {
    const struct daemon_access *access;
    bool done, open;
};

static int on_event(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in, size_t len)
{
    struct handshake *handshake = user;
    switch (reason) {
    case LWS_CALLBACK_CLIENT_APPEND_HANDSHAKE_HEADER: return daemon_add_token(handshake->access, wsi, in, len);
    case LWS_CALLBACK_CLIENT_ESTABLISHED: handshake->open = handshake->done = true; return -1;
    case LWS_CALLBACK_CLIENT_CONNECTION_ERROR:
    case LWS_CALLBACK_CLIENT_CLOSED: handshake->done = true; return 0;
    default: return 0;
    }
}

static bool handshake_opens(const struct daemon_url *url)
{
    static const struct lws_protocols protocols[] = { { .name = WIRE_SUBPROTOCOL, .callback = on_event }, { 0 } };
    struct handshake handshake = { .access = url->access };
    struct lws_context_creation_info info = {
        .port = CONTEXT_PORT_NO_LISTEN, .protocols = protocols, .gid = -1, .uid = -1, .timeout_secs = OPEN_S
    };
    lws_set_log_level(0, NULL);
    daemon_prepare_context(url, &info);
    struct lws_context *context = lws_create_context(&info);
    char *path = mem_printf("%s/stream", url->base);
    struct lws_client_connect_info connect = { .context = context, .path = path, .userdata = &handshake, .protocol = WIRE_SUBPROTOCOL };
    daemon_prepare_connection(url, &connect);
    if (!context || !lws_client_connect_via_info(&connect))
        handshake.done = true;
    while (!handshake.done)
        lws_service(context, 0);
    if (context)
        lws_context_destroy(context);
    mem_free(path);
    return handshake.open;
}

bool stream_passes(const struct daemon_url *url)
{
    if (handshake_opens(url))
        return true;
    struct text body = { 0 };
    bool reached;
    int status = ask_why(url, &body, &reached);
    if (status >= 500)
        fprintf(stderr, "plantcast: not ready: the server answers /stream with HTTP status %d\n", status);
    else if (status > 0 && !reached)
        print_blocked(status, body.at ? body.at : "");
    text_finish(&body);
    return reached;
}
