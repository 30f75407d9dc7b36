/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Who may open a stream: path, origin and subprotocol of the hand-shake. */
#include <string.h>

#include "net/hub.h"

static bool header(struct lws *wsi, enum lws_token_indexes token, char *out, int size)
{
    out[0] = 0;
    return lws_hdr_total_length(wsi, token) == 0 || lws_hdr_copy(wsi, out, size, token) >= 0;
}

/* A page of another host must not use the browser of someone who may: same host, or no browser. */
static bool origin_allowed(struct lws *wsi)
{
    char origin[256], host[256];
    if (!header(wsi, WSI_TOKEN_ORIGIN, origin, sizeof(origin)) || !header(wsi, WSI_TOKEN_HOST, host, sizeof(host)))
        return false;
    if (!origin[0])
        return true;
    const char *name = strstr(origin, "://");
    return name && !strcasecmp(name + 3, host);
}

static bool names_our_protocol(const char *list)
{
    size_t n = strlen(WIRE_SUBPROTOCOL);
    for (const char *at = list; *at;) {
        at += strspn(at, " ,\t");
        size_t word = strcspn(at, " ,\t");
        if (word == n && !strncmp(at, WIRE_SUBPROTOCOL, n))
            return true;
        at += word;
    }
    return false;
}

static int refuse(struct hub *hub, struct lws *wsi, int status, const char *text)
{
    counter_inc(hub->counters.refused, 1);
    return http_answer(wsi, status, text) < 0 ? -1 : 1;
}

int stream_check_upgrade(struct hub *hub, struct lws *wsi)
{
    char path[16], list[256];
    if (lws_hdr_copy(wsi, path, sizeof(path), WSI_TOKEN_GET_URI) < 0 || strcmp(path, "/stream") != 0)
        return refuse(hub, wsi, HTTP_STATUS_NOT_FOUND, "the stream is at /stream\n");
    if (!origin_allowed(wsi) || (!hub->params.open_viewers && !hub_is_trusted(wsi)))
        return refuse(hub, wsi, HTTP_STATUS_FORBIDDEN, "this origin is not allowed\n");
    if (!header(wsi, WSI_TOKEN_PROTOCOL, list, sizeof(list)) || (list[0] && !names_our_protocol(list)))
        return refuse(hub, wsi, HTTP_STATUS_BAD_REQUEST, "unknown subprotocol; this server speaks " WIRE_SUBPROTOCOL "\n");
    return 0;
}
