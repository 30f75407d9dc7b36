/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Answers other daemons of the plant: sends the readings of a past instant to renderers, which keep no history of their own, and
   the tag list to nodes that have an older one. */
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "corelink/core_instant.h"
#include "net/connection.h"
#include "net/core_end.h"
#include "net/http/http_impl.h"

static const char BINARY[] = "application/octet-stream";

static int answer(struct server_context *server, struct http_exchange *request, const struct snapshot *snapshot)
{
    struct text text = { 0 };
    core_instant_write(&text, history_loader_first_us(server->history_loader), snapshot);
    return request_answer(request, HTTP_STATUS_OK, BINARY, text.at, text.length, NULL, NULL);
}

/* Answers with the readings of the past instant at_us. With at_us=0, the answer has only the time when recorded history begins. */
int ask_instant(struct server_context *server, struct http_exchange *request)
{
    struct message_error error = { 0 };
    struct args args;
    if (!server->history_loader)
        return request_refuse(request, HTTP_STATUS_NOT_FOUND, REFUSAL_UNRECORDED);
    if (!request_args(request->wsi, &args, &error))
        return request_answer_error(request, &error);
    const char *text = arg_of(&args, "at_us");
    char *end = NULL;
    long long at_us = text ? strtoll(text, &end, 10) : -1;
    if (at_us < 0 || end == text || *end || at_us == INT64_MAX)
        return request_answer_text(request, HTTP_STATUS_BAD_REQUEST, "at_us: expected microseconds since 1970\n");
    if (at_us == 0)
        return answer(server, request, NULL);
    struct address_usage *usage = connection_of(request->wsi)->client;
    if (server->http.questions >= server->room.quotas->at[QUOTA_QUESTIONS] || !address_limits_may_ask(server->room.addresses, usage))
        return request_answer_later(request, "too many requests in progress; try again\n");
    request_await(server, request);
    request->asks = request->asks_instant = true;
    usage->questions++;
    server->http.questions++;
    history_loader_ask(server->history_loader, request->client, at_us);
    return 0;
}

void answer_instant(struct server_context *server, struct http_exchange *request, const struct history_loader_answer *loaded)
{
    struct snapshot_cache *cache = server->params.plant.snapshot_cache;
    const struct historical_snapshot *historical = loaded->good ? snapshot_cache_take(cache, loaded->at_us) : NULL;
    request_forget(server, request);
    request_answered(request, historical ? answer(server, request, &historical->snapshot) : request_answer_unreadable(server, request));
    snapshot_cache_give(cache, &historical);
}

int ask_core_tags(struct server_context *server, struct http_exchange *request)
{
    const char *list = server->params.plant.tag_list;
    if (!core_end_leads(server) || !list)
        return request_answer_text(request, HTTP_STATUS_SERVICE_UNAVAILABLE,
                                   list ? "this core does not lead\n" : "the tag list could not be read: the log says why\n");
    return request_answer(request, HTTP_STATUS_OK, "text/csv; charset=utf-8", mem_strdup(list), strlen(list), NULL, NULL);
}
