/* SPDX-License-Identifier: GPL-3.0-or-later */
/* HTTP beside the stream: the web client, the state of the server, pictures on request. */
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"
#include "net/hub.h"
#include "net/query.h"
#include "net/reply.h"
#include "net/site.h"
#include "net/tls.h"
#include "net/visitor.h"

static const struct encoder_params LOSSLESS = { .quality = 100, .full_chroma = true };

struct asked { /* a picture, or what is at a pixel of it */
    bool picks;
    struct wish wish;
    struct pick_order pick;
    const struct moment *moment; /* held; NULL: of now, or it is being read */
};

struct request {
    struct lws *wsi;
    bool head;  /* no body is wanted */
    bool close; /* after the answer */
    char *body;
    size_t count, sent;
    uint64_t client;      /* of the painter, while a picture is awaited */
    bool reloads;         /* the plant is: that is what is awaited */
    struct asked *asked;  /* meanwhile; NULL: not for one */
    struct request *next; /* in hub->snapshots */
};

static const char *const security[][2] = {
    { "content-security-policy:", "default-src 'self'; connect-src 'self' ws: wss:; img-src 'self' data: blob:; worker-src 'self' blob:; "
                                  "object-src 'none'; base-uri 'none'; form-action 'none'; frame-ancestors 'self'" },
    { "x-content-type-options:", "nosniff" },
    { "referrer-policy:", "no-referrer" },
    { "cross-origin-resource-policy:", "same-origin" },
    { "cache-control:", "no-cache" },
};

static bool add_header(struct lws *wsi, const char *name, const char *value, unsigned char **p, unsigned char *end)
{
    return lws_add_http_header_by_name(wsi, (const unsigned char *)name, (const unsigned char *)value, (int)strlen(value), p, end) == 0;
}

static bool write_head(struct request *request, int status, const char *type, const char *extra_name, const char *extra)
{
    unsigned char buffer[LWS_PRE + 2048], *start = buffer + LWS_PRE, *p = start, *end = buffer + sizeof(buffer) - 1;
    struct lws *wsi = request->wsi;
    if (lws_add_http_common_headers(wsi, (unsigned)status, type, status == HTTP_STATUS_NOT_MODIFIED ? 0 : request->count, &p, end))
        return false;
    for (size_t i = 0; i < sizeof(security) / sizeof(security[0]); i++)
        if (!add_header(wsi, security[i][0], security[i][1], &p, end))
            return false;
    if (extra_name && !add_header(wsi, extra_name, extra, &p, end))
        return false;
    return lws_finalize_write_http_header(wsi, start, &p, end) == 0;
}

static int done(struct request *request)
{
    mem_free(request->body);
    request->body = NULL;
    request->count = request->sent = 0;
    return request->close || lws_http_transaction_completed(request->wsi) ? -1 : 0;
}

/* Takes body. The rest happens as the socket takes it. */
static int answer(struct request *request, int status, const char *type, char *body, size_t count, const char *extra_name,
                  const char *extra)
{
    mem_free(request->body);
    request->body = body;
    request->count = count;
    request->sent = 0;
    if (!write_head(request, status, type, extra_name, extra))
        return -1;
    if (request->head || count == 0)
        return done(request);
    lws_callback_on_writable(request->wsi);
    return 0;
}

static int answer_text(struct request *request, int status, const char *text)
{
    return answer(request, status, "text/plain; charset=utf-8", mem_strdup(text), strlen(text), NULL, NULL);
}

static int answer_json(struct request *request, char *text)
{
    return answer(request, HTTP_STATUS_OK, "application/json", text, strlen(text), NULL, NULL);
}

int http_answer(struct lws *wsi, int status, const char *text)
{
    struct request request = { .wsi = wsi, .count = strlen(text) };
    if (!write_head(&request, status, "text/plain; charset=utf-8", NULL, NULL))
        return -1;
    return lws_write(wsi, (unsigned char *)text, strlen(text), LWS_WRITE_HTTP_FINAL) < 0 ? -1 : 0;
}

/* --- pictures --------------------------------------------------------------------------------------------------------------- */

static void forget_snapshot(struct hub *hub, struct request *request)
{
    struct request **at = &hub->snapshots;
    while (*at && *at != request)
        at = &(*at)->next;
    if (!*at)
        return;
    *at = request->next;
    hub->snapshot_count--;
    painter_forget(hub->params.painter, request->client);
    if (hub->recall)
        recall_forget(hub->recall, request->client);
    if (hub->past)
        past_forget(hub->past, request->client);
    if (request->asked && request->asked->moment)
        moments_give(hub->params.moments, &request->asked->moment);
    mem_free(request->asked);
    request->asked = NULL;
}

enum { MAX_ARGS = 32, MAX_ARG_BYTES = 2048 };
struct args { /* of the query, decoded */
    char bytes[MAX_ARGS][MAX_ARG_BYTES];
    const char *list[MAX_ARGS];
    size_t count;
};

static bool read_args(struct lws *wsi, struct args *args, struct message_error *error)
{
    int count = 0;
    for (; count < MAX_ARGS && lws_hdr_fragment_length(wsi, WSI_TOKEN_HTTP_URI_ARGS, count) > 0; count++) {
        if (lws_hdr_copy_fragment(wsi, args->bytes[count], MAX_ARG_BYTES, WSI_TOKEN_HTTP_URI_ARGS, count) < 0) {
            message_fail(error, "bad_field", "argument %d is longer than %d bytes", count + 1, MAX_ARG_BYTES - 1);
            return false;
        }
        args->list[count] = args->bytes[count];
    }
    args->count = (size_t)count;
    return true;
}

static int answer_error(struct request *request, const struct message_error *error)
{
    char *text = mem_printf("%s\n", error->text);
    int status = strcmp(error->code, "not_allowed") == 0 ? HTTP_STATUS_FORBIDDEN : HTTP_STATUS_BAD_REQUEST;
    return answer(request, status, "text/plain; charset=utf-8", text, strlen(text), NULL, NULL);
}

/* place: x and y of a pick; NULL: none is asked. */
static bool read_query(struct hub *hub, struct lws *wsi, struct view *view, double place[2], struct message_error *error)
{
    const struct params_world world = {
        .scene = hub->params.scene, .baselines = hub->params.baselines, .now_us = clock_utc_ns() / 1000
    };
    struct args args;
    return read_args(wsi, &args, error) && query_parse(&world, visitor_of(wsi)->role, args.list, args.count, view, place, error);
}

static void await(struct hub *hub, struct request *request)
{
    request->client = hub->next_client++;
    request->next = hub->snapshots;
    hub->snapshots = request;
    hub->snapshot_count++;
    lws_set_timeout(request->wsi, PENDING_TIMEOUT_HTTP_CONTENT, 60);
}

static const char NOTHING_RECORDED[] = "this daemon records nothing (history: record: no)\n";

static struct view *asked_view(struct asked *asked)
{
    return asked->picks ? &asked->pick.view : &asked->wish.view;
}

/* Of now at once; of an instant when it was read. */
static void begin(struct hub *hub, struct request *request)
{
    struct asked *asked = request->asked;
    if (asked_view(asked)->at_us && !asked->moment) {
        past_ask(hub->past, request->client, asked_view(asked)->at_us);
    } else if (asked->picks) {
        painter_pick(hub->params.painter, &asked->pick);
    } else {
        painter_ask(hub->params.painter, request->client, &asked->wish);
        painter_go(hub->params.painter);
    }
}

/* Whether it may be, before it waits; if not, *result is what came of the answer. */
static bool may_ask(struct hub *hub, struct request *request, const struct view *view, int *result)
{
    if (view->at_us && !hub->past) {
        *result = answer_text(request, HTTP_STATUS_NOT_FOUND, NOTHING_RECORDED);
        return false;
    }
    if (hub->snapshot_count < hub->quotas->at[QUOTA_SNAPSHOTS])
        return true;
    *result = answer_text(request, HTTP_STATUS_SERVICE_UNAVAILABLE, "too many pictures are being made; try again\n");
    return false;
}

static int ask_snapshot(struct hub *hub, struct request *request)
{
    struct wish wish = { .codec = WIRE_CODEC_PNG, .quality = LOSSLESS, .urgency = URGENCY_SNAPSHOT, .always = true, .overlay = true };
    struct message_error error = { 0 };
    int result;
    if (!read_query(hub, request->wsi, &wish.view, NULL, &error))
        return answer_error(request, &error);
    if (!may_ask(hub, request, &wish.view, &result))
        return result;
    wish.asked_ns = wish.view.input_ns = clock_mono_ns();
    await(hub, request);
    request->asked = mem_new(sizeof(*request->asked));
    request->asked->wish = wish;
    begin(hub, request);
    return 0;
}

static struct request *find_awaiting(const struct hub *hub, uint64_t client)
{
    struct request *request = hub->snapshots;
    while (request && request->client != client)
        request = request->next;
    return request;
}

void http_on_picture(struct hub *hub, struct picture *picture)
{
    struct request *request = find_awaiting(hub, picture->client);
    if (request) {
        int status;
        forget_snapshot(hub, request);
        if (picture->packet) {
            char *body = mem_array(picture->packet->count, 1);
            memcpy(body, picture->packet->bytes, picture->packet->count);
            status = answer(request, HTTP_STATUS_OK, "image/png", body, picture->packet->count, NULL, NULL);
        } else {
            status = answer_text(request, HTTP_STATUS_INTERNAL_SERVER_ERROR, "the picture could not be made\n");
        }
        if (status < 0)
            lws_set_timeout(request->wsi, PENDING_TIMEOUT_CLOSE_SEND, LWS_TO_KILL_ASYNC);
    }
    picture_destroy(&picture);
}

/* --- pixels ---------------------------------------------------------------------------------------------------------------- */

static int ask_pick(struct hub *hub, struct request *request)
{
    struct pick_order order = { 0 };
    struct message_error error = { 0 };
    double place[2];
    int result;
    if (!read_query(hub, request->wsi, &order.view, place, &error))
        return answer_error(request, &error);
    if (!may_ask(hub, request, &order.view, &result))
        return result;
    await(hub, request);
    order.client = request->client;
    order.x_px = place[0];
    order.y_px = place[1];
    request->asked = mem_new(sizeof(*request->asked));
    request->asked->picks = true;
    request->asked->pick = order;
    begin(hub, request);
    return 0;
}

void http_on_pick(struct hub *hub, const struct pick_answer *pick)
{
    struct request *request = find_awaiting(hub, pick->order.client);
    if (!request)
        return;
    forget_snapshot(hub, request);
    if (answer_json(request, reply_picked_text(hub->params.scene->plant, pick)) < 0)
        lws_set_timeout(request->wsi, PENDING_TIMEOUT_CLOSE_SEND, LWS_TO_KILL_ASYNC);
}

/* --- the past --------------------------------------------------------------------------------------------------------------- */

static int ask_history(struct hub *hub, struct request *request)
{
    struct recall_order order;
    struct message_error error = { 0 };
    struct args args;
    if (!hub->recall)
        return answer_text(request, HTTP_STATUS_NOT_FOUND, NOTHING_RECORDED);
    if (!read_args(request->wsi, &args, &error) ||
        !recall_parse(hub->params.scene->plant, args.list, args.count, clock_utc_ns() / 1000, &order, &error))
        return answer_error(request, &error);
    order.client = hub->next_client;
    if (!recall_ask(hub->recall, &order))
        return answer_text(request, HTTP_STATUS_SERVICE_UNAVAILABLE, "too much is being asked; try again\n");
    await(hub, request);
    return 0;
}

/* --- alarms ----------------------------------------------------------------------------------------------------------------- */

static bool read_alarm_query(struct hub *hub, struct request *request, bool journal, struct alarm_query *query, struct message_error *error)
{
    struct args args;
    return read_args(request->wsi, &args, error) &&
           alarm_query_parse(hub->params.scene->plant, journal, args.list, args.count, clock_utc_ns() / 1000, query, error);
}

static int api_alarms(struct hub *hub, struct request *request)
{
    struct alarm_query query;
    struct message_error error = { 0 };
    if (!hub->params.alarming)
        return answer_text(request, HTTP_STATUS_NOT_FOUND, "there are no alarms here\n");
    if (!read_alarm_query(hub, request, false, &query, &error))
        return answer_error(request, &error);
    char *text = alarms_api_text(hub->params.alarming, hub->params.scene->plant, &query, clock_utc_ns());
    return query.csv ? answer(request, HTTP_STATUS_OK, "text/csv; charset=utf-8", text, strlen(text), NULL, NULL)
                     : answer_json(request, text);
}

static int ask_journal(struct hub *hub, struct request *request)
{
    struct recall_order order = { .journal = true };
    struct message_error error = { 0 };
    if (!hub->recall)
        return answer_text(request, HTTP_STATUS_NOT_FOUND, NOTHING_RECORDED);
    if (!read_alarm_query(hub, request, true, &order.alarms, &error))
        return answer_error(request, &error);
    order.client = hub->next_client;
    if (!recall_ask(hub->recall, &order))
        return answer_text(request, HTTP_STATUS_SERVICE_UNAVAILABLE, "too much is being asked; try again\n");
    await(hub, request);
    return 0;
}

/* --- instants ---------------------------------------------------------------------------------------------------------------- */

static const char UNREADABLE[] = "history cannot be read; the log says why\n";

void http_on_moment(struct hub *hub, const struct past_answer *past)
{
    struct request *request = find_awaiting(hub, past->client);
    if (!request)
        return;
    struct asked *asked = request->asked;
    asked->moment = past->good ? moments_take(hub->params.moments, past->at_us) : NULL;
    if (asked->moment) {
        view_travel(asked_view(asked), past->at_us, asked->moment->slot);
        begin(hub, request);
        return;
    }
    forget_snapshot(hub, request);
    if (answer_text(request, HTTP_STATUS_INTERNAL_SERVER_ERROR, UNREADABLE) < 0)
        lws_set_timeout(request->wsi, PENDING_TIMEOUT_CLOSE_SEND, LWS_TO_KILL_ASYNC);
}

void http_on_recall(struct hub *hub, struct recall_answer *recalled)
{
    struct request *request = find_awaiting(hub, recalled->client);
    if (!request) {
        mem_free(recalled->text);
        return;
    }
    forget_snapshot(hub, request);
    int status = recalled->text ? answer(request, HTTP_STATUS_OK, recalled->csv ? "text/csv; charset=utf-8" : "application/json",
                                         recalled->text, recalled->length, NULL, NULL)
                                : answer_text(request, HTTP_STATUS_INTERNAL_SERVER_ERROR, UNREADABLE);
    if (status < 0)
        lws_set_timeout(request->wsi, PENDING_TIMEOUT_CLOSE_SEND, LWS_TO_KILL_ASYNC);
}

/* --- the plant anew --------------------------------------------------------------------------------------------------------- */

/* A page of another site may have its user's browser send this. */
static bool may_change(struct hub *hub, struct lws *wsi)
{
    char origin[256], host[256];
    return visitor_header(wsi, WSI_TOKEN_ORIGIN, origin, sizeof(origin)) && visitor_header(wsi, WSI_TOKEN_HOST, host, sizeof(host)) &&
           access_origin(&hub->params.access, origin, host, hub->tls != NULL);
}

static int ask_reload(struct hub *hub, struct request *request)
{
    request->close = true; /* there may be a body that nobody reads */
    if (!may_change(hub, request->wsi))
        return answer_text(request, HTTP_STATUS_FORBIDDEN, "pages of other sites may not do this\n");
    if (!hub->params.reload)
        return answer_text(request, HTTP_STATUS_NOT_FOUND, "this plant cannot be loaded anew\n");
    request->reloads = true;
    await(hub, request);
    hub->params.reload(hub->params.reload_arg);
    return 0;
}

static void answer_all(struct hub *hub, bool reloads, int status, const char *type, const char *text)
{
    for (struct request *request = hub->snapshots, *next; request; request = next) {
        next = request->next;
        if (request->reloads != reloads)
            continue;
        forget_snapshot(hub, request);
        request->reloads = false;
        if (answer(request, status, type, mem_strdup(text), strlen(text), NULL, NULL) < 0)
            lws_set_timeout(request->wsi, PENDING_TIMEOUT_CLOSE_SEND, LWS_TO_KILL_ASYNC);
    }
}

void http_let_go(struct hub *hub)
{
    answer_all(hub, false, HTTP_STATUS_SERVICE_UNAVAILABLE, "text/plain; charset=utf-8",
               "the plant was loaded anew meanwhile; try again\n");
}

void http_on_reloaded(struct hub *hub, bool good, const char *text)
{
    answer_all(hub, true, good ? HTTP_STATUS_OK : 422, "application/json", text);
}

/* --- routes ----------------------------------------------------------------------------------------------------------------- */

static int metrics(struct hub *hub, struct request *request)
{
    struct text text = { 0 };
    counters_print(hub->params.counters, &text);
    return answer(request, HTTP_STATUS_OK, "text/plain; version=0.0.4; charset=utf-8", text.at, text.length, NULL, NULL);
}

static int api_plant(struct hub *hub, struct request *request)
{
    return answer_json(request, reply_api_plant_text(&hub->world));
}

enum { TAGS_PAGE = 1000, TAGS_PAGE_MAX = 5000 };

/* `first` and `count` of the query. */
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

static int api_tags(struct hub *hub, struct request *request)
{
    struct message_error error = { 0 };
    struct args args;
    size_t first = 0, count = TAGS_PAGE;
    if (!read_args(request->wsi, &args, &error) || !read_page(&args, &first, &count))
        return answer_text(request, HTTP_STATUS_BAD_REQUEST, "expected first=N and count=N, 1 to 5000\n");
    return answer_json(request, reply_api_tags_text(&hub->world, first, count));
}

static int alive(struct hub *hub, struct request *request)
{
    (void)hub;
    return answer_text(request, HTTP_STATUS_OK, "ok\n");
}

static int ready(struct hub *hub, struct request *request)
{
    if (painter_ready(hub->params.painter))
        return answer_text(request, HTTP_STATUS_OK, "ok\n");
    return answer_text(request, HTTP_STATUS_SERVICE_UNAVAILABLE, "the GL context was lost; a new one is being made\n");
}

static int stream_without_upgrade(struct hub *hub, struct request *request)
{
    (void)hub;
    static const char text[] = "a WebSocket with the subprotocol " WIRE_SUBPROTOCOL " is here\n";
    return answer(request, 426, "text/plain; charset=utf-8", mem_strdup(text), strlen(text), "upgrade:", "websocket");
}

static int file(struct hub *hub, struct request *request, const char *path)
{
    struct site_file found;
    char seen[64] = "";
    bool cached = false;
    if (lws_hdr_copy(request->wsi, seen, sizeof(seen), WSI_TOKEN_HTTP_IF_NONE_MATCH) > 0)
        cached = site_read(hub->params.web_folder, path, true, &found) && !strcmp(seen, found.etag);
    if (cached)
        return answer(request, HTTP_STATUS_NOT_MODIFIED, found.type, NULL, 0, "etag:", found.etag);
    if (!site_read(hub->params.web_folder, path, false, &found))
        return answer_text(request, HTTP_STATUS_NOT_FOUND, "not found\n");
    return answer(request, HTTP_STATUS_OK, found.type, found.bytes, found.count, "etag:", found.etag);
}

static const struct {
    const char *path;
    int (*serve)(struct hub *hub, struct request *request);
    enum role least;
} routes[] = {
    { "/healthz", alive, ROLE_NOBODY },
    { "/readyz", ready, ROLE_NOBODY }, /* the loop only runs once model, GL and store are there; GL may go again */
    { "/stream", stream_without_upgrade, ROLE_NOBODY },
    { "/snapshot.png", ask_snapshot, ROLE_OPEN },
    { "/metrics", metrics, ROLE_VIEWER },
    { "/api/v1/plant", api_plant, ROLE_VIEWER },
    { "/api/v1/tags", api_tags, ROLE_VIEWER },
    { "/api/v1/pick", ask_pick, ROLE_VIEWER },
    { "/api/v1/history", ask_history, ROLE_VIEWER },
    { "/api/v1/alarms", api_alarms, ROLE_VIEWER },
    { "/api/v1/alarms/journal", ask_journal, ROLE_VIEWER },
};
static const char RELOAD_PATH[] = "/api/v1/reload"; /* POST */

static int refuse(struct request *request, const struct refusal *refusal)
{
    bool whose = refusal->status == HTTP_STATUS_UNAUTHORIZED;
    return answer(request, refusal->status, "text/plain; charset=utf-8", mem_strdup(refusal->text), strlen(refusal->text),
                  whose ? "www-authenticate:" : NULL, "Bearer realm=\"plantcast\"");
}

/* Pages of other sites may link to us, but not have us draw. */
static bool is_foreign_page(struct lws *wsi)
{
    char site[32];
    return lws_hdr_custom_copy(wsi, site, sizeof(site), "sec-fetch-site:", 15) > 0 && !strcmp(site, "cross-site");
}

static const struct refusal NEED_TOKEN = { HTTP_STATUS_UNAUTHORIZED, "a token is needed: Authorization: Bearer TOKEN\n" };
static const struct refusal NOT_FOR_YOU = { HTTP_STATUS_FORBIDDEN, "viewers get pictures only\n" };
static const struct refusal NOT_ENGINEER = { HTTP_STATUS_FORBIDDEN, "this takes the role engineer\n" };
static const struct refusal FOREIGN = { HTTP_STATUS_FORBIDDEN, "pages of other sites do not get this\n" };

static int serve_route(struct hub *hub, struct request *request, size_t i)
{
    enum role role = visitor_of(request->wsi)->role;
    if (role < routes[i].least)
        return refuse(request, role == ROLE_NOBODY ? &NEED_TOKEN : &NOT_FOR_YOU);
    if (routes[i].least > ROLE_NOBODY && is_foreign_page(request->wsi))
        return refuse(request, &FOREIGN);
    return routes[i].serve(hub, request);
}

static int serve_reload(struct hub *hub, struct request *request)
{
    enum role role = visitor_of(request->wsi)->role;
    request->close = true;
    if (role < ROLE_ENGINEER)
        return refuse(request, role == ROLE_NOBODY ? &NEED_TOKEN : &NOT_ENGINEER);
    return is_foreign_page(request->wsi) ? refuse(request, &FOREIGN) : ask_reload(hub, request);
}

static int serve(struct hub *hub, struct request *request, const char *path)
{
    bool post = lws_hdr_total_length(request->wsi, WSI_TOKEN_POST_URI) > 0 && !strcmp(path, RELOAD_PATH);
    bool get = lws_hdr_total_length(request->wsi, WSI_TOKEN_GET_URI) > 0;
    struct refusal refusal;
    request->head = lws_hdr_total_length(request->wsi, WSI_TOKEN_HEAD_URI) > 0;
    counter_inc(hub->counters.requests, 1);
    if (!get && !request->head && !post) {
        request->close = true; /* there may be a body that nobody reads */
        static const char text[] = "only GET and HEAD (POST: /api/v1/reload)\n";
        return answer(request, HTTP_STATUS_METHOD_NOT_ALLOWED, "text/plain; charset=utf-8", mem_strdup(text), strlen(text),
                      "allow:", "GET, HEAD");
    }
    if (!visitor_enter(hub, request->wsi, &refusal))
        return refuse(request, &refusal);
    if (post)
        return serve_reload(hub, request);
    for (size_t i = 0; i < sizeof(routes) / sizeof(routes[0]); i++)
        if (!strcmp(routes[i].path, path))
            return serve_route(hub, request, i);
    return file(hub, request, path);
}

static int on_writeable(struct hub *hub, struct request *request)
{
    size_t left = request->count - request->sent, slice = left < SLICE_BYTES ? left : SLICE_BYTES;
    if (!request->body)
        return 0;
    if (!hub_write(hub, request->wsi, request->body + request->sent, slice, slice == left ? LWS_WRITE_HTTP_FINAL : LWS_WRITE_HTTP))
        return -1;
    request->sent += slice;
    if (slice == left)
        return done(request);
    lws_set_timeout(request->wsi, PENDING_TIMEOUT_HTTP_CONTENT, 20);
    lws_callback_on_writable(request->wsi);
    return 0;
}

static struct request *request_of(struct lws *wsi, struct request **slot)
{
    if (!*slot) {
        *slot = mem_new(sizeof(**slot));
        (*slot)->wsi = wsi;
    }
    return *slot;
}

static void request_end(struct hub *hub, struct request **slot)
{
    if (!slot || !*slot)
        return;
    forget_snapshot(hub, *slot);
    mem_free((*slot)->body);
    mem_free(*slot);
    *slot = NULL;
}

/* False: not about a connection as such. */
static bool on_connection(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in, int *result)
{
    *result = 0;
    switch (reason) {
    case LWS_CALLBACK_FILTER_NETWORK_CONNECTION: *result = visitor_may_come(hub_of(wsi), (int)(intptr_t)in) ? 0 : -1; return true;
    case LWS_CALLBACK_SERVER_NEW_CLIENT_INSTANTIATED: visitor_come(hub_of(wsi), wsi); return true;
    case LWS_CALLBACK_WSI_DESTROY: visitor_go(hub_of(wsi), wsi); return true;
    case LWS_CALLBACK_OPENSSL_LOAD_EXTRA_SERVER_VERIFY_CERTS: tls_serve(hub_of(wsi)->tls, user); return true;
    default: return false;
    }
}

int http_callback(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in, size_t len)
{
    struct request **slot = user;
    int result;
    (void)len;
    if (on_connection(wsi, reason, user, in, &result))
        return result;
    switch (reason) {
    case LWS_CALLBACK_HTTP: return serve(hub_of(wsi), request_of(wsi, slot), in);
    case LWS_CALLBACK_HTTP_WRITEABLE: return *slot ? on_writeable(hub_of(wsi), *slot) : 0;
    case LWS_CALLBACK_HTTP_DROP_PROTOCOL: /* also when the connection is upgraded */
    case LWS_CALLBACK_CLOSED_HTTP: request_end(hub_of(wsi), slot); return 0;
    case LWS_CALLBACK_HTTP_CONFIRM_UPGRADE: return strcasecmp(in, "websocket") == 0 ? stream_check_upgrade(hub_of(wsi), wsi) : -1;
    case LWS_CALLBACK_ESTABLISHED: { /* a WebSocket without a subprotocol lands here */
        static unsigned char text[] = "the subprotocol is " WIRE_SUBPROTOCOL;
        lws_close_reason(wsi, LWS_CLOSE_STATUS_PROTOCOL_ERR, text, sizeof(text) - 1);
        return -1;
    }
    default: return 0;
    }
}
