/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Handlers of /api/v1 and /metrics: plant, tags, alarms and recorded history. */
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "access/pairings.h"
#include "base/clock.h"
#include "base/mem.h"
#include "base/system/memory.h"
#include "base/text/json_text.h"
#include "base/metrics/process_counters.h"
#include "net/http/http_impl.h"
#include "net/connection.h"
#include "message/views_message.h"
#include "session/reply/reply.h"

static int await_history(struct server_context *server, struct http_exchange *request, struct history_query *query)
{
    struct address_usage *usage = connection_of(request->wsi)->client;
    query->client = server->streams.next_client;
    query->account = usage->share.account;
    if (server->http.questions >= server->room.quotas->at[QUOTA_QUESTIONS] || !address_limits_may_ask(server->room.addresses, usage) ||
        !history_queries_ask(server->history_queries, query))
        return request_answer_later(request, "too many requests in progress; try again\n");
    request_await(server, request);
    request->asks = true;
    usage->questions++;
    server->http.questions++;
    return 0;
}

/* Returns whether the client may read the requested history. A paired device may read only the tags whose trends its display shows. */
static bool may_read(const struct server_context *server, const struct http_exchange *request, const struct history_query *query)
{
    const struct token_holder *holder = &connection_of(request->wsi)->holder;
    const struct plant *plant = server->params.plant.scene->plant;
    const struct wall_display *display = wall_display_find(plant, holder->wall, holder->display);
    for (int i = 0; i < query->tag_count && holder->display; i++)
        if (!wall_display_has(display, PANE_TREND, plant->tags[query->tags[i]].name))
            return false;
    return true;
}

static int ask_recorded(struct server_context *server, struct http_exchange *request, bool gaps)
{
    struct history_query query;
    struct message_error error = { 0 };
    struct args args;
    int64_t now_us = clock_plant_ns(server->params.plant.clock) / 1000;
    if (!server->history_queries)
        return request_refuse(request, HTTP_STATUS_NOT_FOUND, REFUSAL_UNRECORDED);
    if (!request_args(request->wsi, &args, &error) ||
        !(gaps ? history_query_parse_gaps(args.list, args.count, now_us, &query, &error)
               : history_query_parse(server->params.plant.scene->plant, args.list, args.count, now_us, &query, &error)))
        return request_answer_error(request, &error);
    if (!gaps && !may_read(server, request, &query)) {
        connection_record_refusal(server, request->wsi, "/api/v1/history", "the display's token does not permit these tags");
        return request_answer_text(request, HTTP_STATUS_FORBIDDEN, "this display's token does not permit trends of these tags\n");
    }
    return await_history(server, request, &query);
}

int ask_history(struct server_context *server, struct http_exchange *request)
{
    return ask_recorded(server, request, false);
}

int ask_gaps(struct server_context *server, struct http_exchange *request)
{
    return ask_recorded(server, request, true);
}

int ask_drift(struct server_context *server, struct http_exchange *request)
{
    const struct plant_services *plant = &server->params.plant;
    struct history_query query;
    struct message_error error = { 0 };
    struct args args;
    if (!server->history_queries)
        return request_refuse(request, HTTP_STATUS_NOT_FOUND, REFUSAL_UNRECORDED);
    if (!request_args(request->wsi, &args, &error) ||
        !history_query_parse_drift(plant->scene->plant, args.list, args.count, clock_plant_ns(plant->clock) / 1000, &query, &error))
        return request_answer_error(request, &error);
    return await_history(server, request, &query);
}

static bool read_alarm_query(struct server_context *server, struct http_exchange *request, bool journal, struct alarm_query *query,
                             struct message_error *error)
{
    const struct plant_services *plant = &server->params.plant;
    struct args args;
    return request_args(request->wsi, &args, error) &&
           alarm_query_parse(plant->scene->plant, journal, args.list, args.count, clock_plant_ns(plant->clock) / 1000, query, error);
}

int api_alarms(struct server_context *server, struct http_exchange *request)
{
    const struct plant_services *plant = &server->params.plant;
    struct alarm_query query;
    struct message_error error = { 0 };
    if (!plant->alarm_service)
        return request_answer_text(request, HTTP_STATUS_NOT_FOUND, "this server has no alarms (`alarms` in the plant file)\n");
    if (!read_alarm_query(server, request, false, &query, &error))
        return request_answer_error(request, &error);
    char *text = alarms_api_text(plant->alarm_service, plant->scene->plant, &query, clock_plant_ns(plant->clock));
    return query.csv ? request_answer(request, HTTP_STATUS_OK, "text/csv; charset=utf-8", text, strlen(text), NULL, NULL)
                     : request_answer_json(request, text);
}

int ask_journal(struct server_context *server, struct http_exchange *request)
{
    struct history_query query = { .journal = true };
    struct message_error error = { 0 };
    if (!server->history_queries)
        return request_refuse(request, HTTP_STATUS_NOT_FOUND, REFUSAL_UNRECORDED);
    if (!read_alarm_query(server, request, true, &query.alarms, &error))
        return request_answer_error(request, &error);
    return await_history(server, request, &query);
}

/* Sends the first or the next piece of an answer to a history query. */
static int take_piece(struct http_exchange *request, struct history_answer *piece, const char *type)
{
    if (piece->first && chunked_begin(request, type) < 0)
        return -1;
    chunked_append(request, piece->text, piece->length, piece->last);
    piece->text = NULL;
    return 0;
}

static int answer_whole(struct http_exchange *request, struct history_answer *answer, const char *type)
{
    char *text = answer->text;
    answer->text = NULL;
    return request_answer(request, HTTP_STATUS_OK, type, text, answer->length, NULL, NULL);
}

void http_on_history_answer(struct server_context *server, struct history_answer *answer)
{
    struct http_exchange *request = request_find(server, answer->client);
    const char *type = answer->csv ? "text/csv; charset=utf-8" : "application/json";
    bool whole = answer->first && answer->last;
    if (!request)
        return;
    if (answer->text && !whole && !request->head) {
        request_answered(request, take_piece(request, answer, type));
        return;
    }
    request_forget(server, request);
    /* History could not be read. If the first piece of the answer was sent already, no error can replace it, so the connection
       is closed, which shows the client that the answer is incomplete. */
    if (!answer->text)
        request_answered(request, answer->first ? request_answer_unreadable(server, request) : -1);
    else
        request_answered(request, whole ? answer_whole(request, answer, type) : chunked_begin(request, type));
}

/* Updates the process's memory metrics. Called only when /metrics is read, because it takes time. */
static void count_memory(struct server_context *server)
{
    struct counters *counters = server->params.counters;
    struct memory_use use;
    memory_measure(&use);
    counter_set(counters_add(counters, "plantcast_anonymous_bytes", "gauge",
                             "Resident memory of the daemon in bytes that is not backed by a file (anonymous)."),
                (int64_t)use.anonymous);
    counter_set(counters_add(counters, "plantcast_heap_bytes", "gauge", "Memory in bytes that the daemon has allocated with malloc."),
                (int64_t)use.allocated);
}

int metrics(struct server_context *server, struct http_exchange *request)
{
    struct text text = { 0 };
    count_memory(server);
    process_counters_set(server->params.counters);
    counters_print(server->params.counters, &text);
    return request_answer(request, HTTP_STATUS_OK, "text/plain; version=0.0.4; charset=utf-8", text.at, text.length, NULL, NULL);
}

int api_plant(struct server_context *server, struct http_exchange *request)
{
    return request_answer_json(request, reply_api_plant_text(&server->session_context));
}

enum { TAGS_PAGE = 1000, TAGS_PAGE_MAX = 5000 };

/* Reads the arguments `first` and `count` of the query, which select a part of a list. Returns false if an argument is wrong. */
static bool read_page(const struct args *args, size_t *first, size_t *count)
{
    static const char *const names[] = { "first=", "count=" };
    size_t *const numbers[] = { first, count };
    for (size_t i = 0; i < args->count; i++) {
        char *end = NULL;
        for (int n = 0; n < 2; n++)
            if (!strncmp(args->list[i], names[n], 6) && args->list[i][6] >= '0' && args->list[i][6] <= '9')
                *numbers[n] = strtoul(args->list[i] + 6, &end, 10);
        if (!end || *end)
            return false;
    }
    return *count >= 1 && *count <= TAGS_PAGE_MAX;
}

int api_tags(struct server_context *server, struct http_exchange *request)
{
    struct message_error error = { 0 };
    struct args args;
    size_t first = 0, count = TAGS_PAGE;
    if (!request_args(request->wsi, &args, &error) || !read_page(&args, &first, &count))
        return request_answer_text(request, HTTP_STATUS_BAD_REQUEST, "expected first=N and count=N, with a count from 1 to 5000\n");
    net_refresh_readings(server);
    return request_answer_json(request, reply_api_tags_text(&server->session_context, first, count));
}

/* Answers with each sensor's estimate from its neighbouring sensors, for the sensors of a group; with tag=NAME, for that sensor only. */
int api_neighbours(struct server_context *server, struct http_exchange *request)
{
    const struct plant *plant = server->session_context.plant;
    struct message_error error = { 0 };
    struct args args;
    int group = -1, tag = -1;
    if (!request_args(request->wsi, &args, &error))
        return request_answer_error(request, &error);
    if (args.count == 1 && !strncmp(args.list[0], "group=", 6))
        group = plant_find_group(plant, args.list[0] + 6);
    if (args.count == 1 && !strncmp(args.list[0], "tag=", 4))
        tag = plant_find_tag(plant, args.list[0] + 4);
    group = tag >= 0 ? plant->tags[tag].group : group;
    if (group < 0)
        return request_answer_text(request, HTTP_STATUS_BAD_REQUEST, "expected group=ID of a group, or tag=NAME of one of its tags\n");
    net_refresh_readings(server);
    return request_answer_json(request, neighbour_text(&server->texts.neighbours, &server->session_context, group, tag));
}

/* Lists all named views; with id=ID also the earlier versions of that view. */
int api_views(struct server_context *server, struct http_exchange *request)
{
    struct message_error error = { 0 };
    struct args args;
    if (!request_args(request->wsi, &args, &error) || args.count > 1 || (args.count == 1 && strncmp(args.list[0], "id=", 3) != 0))
        return request_answer_text(request, HTTP_STATUS_BAD_REQUEST, "expected no argument, or id=ID\n");
    return request_answer_json(request, reply_views_text(&server->session_context, args.count ? args.list[0] + 3 : NULL));
}

/* Returns the view of a short link. A renderer that is not connected to the core, or has not received the core's lists yet, answers an
   unknown link with 503, because the link may exist. */
int api_link(struct server_context *server, struct http_exchange *request)
{
    struct message_error error = { 0 };
    struct args args;
    if (!request_args(request->wsi, &args, &error) || args.count != 1 || !arg_of(&args, "id"))
        return request_answer_text(request, HTTP_STATUS_BAD_REQUEST, "expected id=ID\n");
    const char *view = short_links_find(server->params.plant.short_links, arg_of(&args, "id"));
    if (!view && server->params.plant.core_link && !(server->session_context.core.up && server->core.listed))
        return request_refuse(request, HTTP_STATUS_SERVICE_UNAVAILABLE, REFUSAL_CORELESS);
    if (!view)
        return request_refuse(request, HTTP_STATUS_NOT_FOUND, REFUSAL_LINKLESS);
    return request_answer_json(request, json_text(json_pack("{s:s}", "view", view), 0));
}

/* Lists the notes that were active between `from` and `to`; by default from an hour ago until now. */
int api_notes(struct server_context *server, struct http_exchange *request)
{
    struct message_error error = { 0 };
    struct args args;
    int64_t now_us = clock_plant_ns(server->params.plant.clock) / 1000, from_us = now_us - INT64_C(3600000000), to_us = now_us;
    if (!request_args(request->wsi, &args, &error))
        return request_answer_error(request, &error);
    for (size_t i = 0; i < args.count; i++) {
        bool from = !strncmp(args.list[i], "from=", 5);
        if (!from && strncmp(args.list[i], "to=", 3) != 0)
            return request_answer_text(request, HTTP_STATUS_BAD_REQUEST, "expected from=TIME and to=TIME\n");
        if (!message_take_time(from ? "from" : "to", strchr(args.list[i], '=') + 1, now_us, from ? &from_us : &to_us, &error))
            return request_answer_error(request, &error);
    }
    return request_answer_json(request, notes_text_between(server->params.plant.notes, from_us, to_us));
}

static bool sees_view(const void *holder, const char *view)
{
    return tokens_may_see(holder, view);
}

int api_walls(struct server_context *server, struct http_exchange *request)
{
    const struct token_holder *holder = &connection_of(request->wsi)->holder;
    const struct walls_reader reader = { .wall = holder->display ? holder->wall : NULL,
                                         .display = holder->display,
                                         .sees = holder->views[0] ? sees_view : NULL,
                                         .arg = holder };
    return request_answer_json(request, walls_text(server->params.plant.scene->plant, &reader));
}

/* Forwards a display's pairing request to the core, which chooses the digits and sends them to its renderers. The renderer
   forwards every such request of the display, because the digits would expire otherwise. Returns the state of the pairing as
   known to this renderer. */
static enum pairing ask_core(struct server_context *server, const struct pairing_request *asked, char digits[PAIRING_DIGITS + 1],
                             int *left_s)
{
    char *text = pairings_request_text(asked);
    enum pairing now = pairings_look(server->params.plant.pairings, asked, clock_mono_ns(), digits, left_s);
    if (now == PAIRING_WAITS)
        core_link_tell(server->params.plant.core_link, text);
    mem_free(text);
    return now;
}

/* Answers a display that has no token yet and asks, with its secret, whether an engineer has accepted it (pairing). Until then
   the display shows digits that the engineer must type. */
static int pair(struct server_context *server, struct http_exchange *request, const struct pairing_request *asked)
{
    char digits[PAIRING_DIGITS + 1];
    int left_s;
    enum pairing now = server->params.plant.core_link
                           ? ask_core(server, asked, digits, &left_s)
                           : pairings_ask(server->params.plant.pairings, asked, clock_mono_ns(), digits, &left_s);
    if (now == PAIRING_FULL)
        return request_answer_later(request, "too many displays wait for pairing; try again\n");
    if (now == PAIRING_OTHER)
        return request_answer_text(request, HTTP_STATUS_CONFLICT,
                                   "this pairing secret belongs to another display; create a new secret for this display\n");
    if (now == PAIRING_DONE)
        return request_answer_json(request, mem_strdup("{\"paired\":true}"));
    return request_answer_json(request, mem_printf("{\"paired\":false,\"digits\":\"%s\",\"left_s\":%d}", digits, left_s));
}

int api_pair(struct server_context *server, struct http_exchange *request)
{
    const struct connection *connection = connection_of(request->wsi);
    struct message_error error = { 0 };
    struct wall_place place = { .display = 1 };
    struct args args;
    char secret[256];
    if (!server->logins.tokens)
        return request_answer_text(request, HTTP_STATUS_NOT_FOUND, "this server does not pair displays (it runs without --tokens)\n");
    enum refusal_code why = server->params.plant.core_link ? REFUSAL_NONE : pairings_refusal(server->params.plant.pairings);
    if (why)
        return request_refuse(request, HTTP_STATUS_NOT_FOUND, why);
    if (!request_args(request->wsi, &args, &error))
        return request_answer_error(request, &error);
    for (size_t i = 0; i < args.count; i++)
        if (!strncmp(args.list[i], "wall=", 5))
            snprintf(place.wall, sizeof(place.wall), "%s", args.list[i] + 5);
        else if (!strncmp(args.list[i], "display=", 8))
            place.display = atoi(args.list[i] + 8);
    if (wall_place_wrong(server->params.plant.scene->plant, &place))
        return request_answer_text(request, HTTP_STATUS_BAD_REQUEST, "expected wall=WALL and display=N of a wall in the plant file\n");
    if (!connection_header(request->wsi, WSI_TOKEN_HTTP_AUTHORIZATION, secret, sizeof(secret)) || strncasecmp(secret, "Pairing ", 8) != 0 ||
        !pairings_secret_valid(secret + 8))
        return request_answer_text(request, HTTP_STATUS_BAD_REQUEST, "expected Authorization: Pairing SECRET\n");
    return pair(server, request,
                &(struct pairing_request){
                    .secret = secret + 8, .place = place, .address = connection->client->address, .from = connection->address });
}

int api_devices(struct server_context *server, struct http_exchange *request)
{
    if (!server->logins.tokens)
        return request_answer_json(request, mem_strdup("{\"list\":null}"));
    return request_answer_json(request, pairings_text(server->params.plant.pairings));
}

int api_loop_checks(struct server_context *server, struct http_exchange *request)
{
    struct text text = { 0 };
    enum refusal_code why = loop_checks_refusal(server->params.plant.loop_checks);
    if (why)
        return request_refuse(request, HTTP_STATUS_NOT_FOUND, why);
    loop_checks_print(server->params.plant.loop_checks, &text);
    return request_answer(request, HTTP_STATUS_OK, "text/csv; charset=utf-8", text.at, text.length,
                          "content-disposition:", "attachment; filename=\"proofs.csv\"");
}
