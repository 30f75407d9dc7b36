/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decides whether a client may open a stream, by path, origin and subprotocol of the WebSocket handshake. */
#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"
#include "corelink/core_identity.h"
#include "message/json_fields.h"
#include "net/connection.h"
#include "net/renderers.h"

static int refuse(struct server_context *server, struct lws *wsi, int status, const char *text)
{
    counter_inc(server->counters.refused, 1);
    struct upgrade_refusal *refusal = &server->upgrade.refused[server->upgrade.count++ % UPGRADE_REFUSALS];
    refusal->at_ns = clock_mono_ns();
    snprintf(refusal->address, sizeof(refusal->address), "%s", connection_of(wsi)->address);
    snprintf(refusal->why, sizeof(refusal->why), "%s", text);
    return http_answer(wsi, status, text) < 0 ? -1 : 1;
}

/* Refuses the handshake of a node at /core, which may be the standby. */
static int deny_node(struct server_context *server, struct lws *wsi, int status, const char *text)
{
    renderers_deny(server, connection_of(wsi)->address, status, text);
    return refuse(server, wsi, status, text);
}

static int refuse_protocol(struct server_context *server, struct lws *wsi, const char *list, const char *spoken)
{
    char asked[48], *text = mem_printf("subprotocol %s is unknown; this server speaks %s\n", quoted(list, asked), spoken);
    int result = refuse(server, wsi, HTTP_STATUS_BAD_REQUEST, text);
    mem_free(text);
    return result;
}

int stream_check_upgrade(struct server_context *server, struct lws *wsi)
{
    char path[16], list[512];
    struct http_refusal refusal;
    bool there = lws_hdr_copy(wsi, path, sizeof(path), WSI_TOKEN_GET_URI) >= 0, core = there && !strcmp(path, CORE_PATH);
    const char *spoken = core ? CORE_SUBPROTOCOL : WIRE_SUBPROTOCOL, *why = NULL;
    if (!core && (!there || strcmp(path, "/stream") != 0))
        return refuse(server, wsi, HTTP_STATUS_NOT_FOUND, "the stream is at /stream\n");
    if (!connection_identify(server, wsi, &refusal))
        return (core ? deny_node : refuse)(server, wsi, refusal.status, refusal.text ? refusal.text : refusal_words(refusal.code));
    if (!connection_origin_allowed(server, wsi)) {
        connection_record_refusal(server, wsi, path, refusal_words(REFUSAL_FOREIGN));
        return refuse(server, wsi, HTTP_STATUS_FORBIDDEN, "this origin is not allowed; --origin URL allows one\n");
    }
    if (core && (why = renderers_refusal(server, wsi)))
        return deny_node(server, wsi, HTTP_STATUS_FORBIDDEN, why);
    if (!core && role_is_node(connection_of(wsi)->role))
        return refuse(server, wsi, HTTP_STATUS_FORBIDDEN, refusal_words(REFUSAL_TOKEN_NODE));
    if (!connection_header(wsi, WSI_TOKEN_PROTOCOL, list, sizeof(list)))
        return refuse(server, wsi, 431, "the header Sec-WebSocket-Protocol is too long\n");
    if ((core || list[0]) && !access_list_has(list, spoken))
        return refuse_protocol(server, wsi, list, spoken);
    /* checks the path here, because libwebsockets chooses the handler by subprotocol and not by path */
    if (!core && access_list_has(list, CORE_SUBPROTOCOL))
        return refuse_protocol(server, wsi, CORE_SUBPROTOCOL, spoken);
    return 0;
}
