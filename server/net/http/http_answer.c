/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes answers to HTTP requests: headers and body, including answers that must wait for their content. */
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"
#include "net/http/http_impl.h"
#include "net/http/stuck_head.h"
#include "net/connection.h"

/* HTTP answers up to this size are exempt from an address's quota on unread bytes: memory suffices for one such answer on each
   permitted connection */
enum { SMALL_BYTES = 64 * 1024 };
/* bytes reserved for an answer's headers; suffices for the longest list of allowed origins, of 256 characters each */
enum { HEAD_BYTES = 8192 };

static const char *const security[][2] = {
    { "x-content-type-options:", "nosniff" },
    { "referrer-policy:", "no-referrer" },
    { "cache-control:", "no-cache" },
};

static bool add_header(struct lws *wsi, const char *name, const char *value, unsigned char **p, unsigned char *end)
{
    return lws_add_http_header_by_name(wsi, (const unsigned char *)name, (const unsigned char *)value, (int)strlen(value), p, end) == 0;
}

/* time in nanoseconds for which the rest of a refused request's body is discarded; 30 s as in nginx (lingering_time) */
static const int64_t DISCARD_NS = 30 * NS_PER_S;

/* Returns whether the server closes the connection after this answer. */
static bool closes(const struct http_exchange *request)
{
    return request->close || server_context_of(request->wsi)->life.goes_down;
}

/* Adds the status line and the body's headers. An answer in pieces has no Content-Length. Returns false if the headers do not fit. */
static bool add_first(struct http_exchange *request, int status, const char *type, unsigned char **p, unsigned char *end)
{
    struct lws *wsi = request->wsi;
    lws_filepos_t count = request->pieces == PIECES_TO_END ? LWS_ILLEGAL_HTTP_CONTENT_LEN : request->count;
    if (request->pieces == PIECES_CHUNKED)
        return lws_add_http_header_status(wsi, (unsigned)status, p, end) == 0 && add_header(wsi, "content-type:", type, p, end) &&
               add_header(wsi, "transfer-encoding:", "chunked", p, end);
    return lws_add_http_common_headers(wsi, (unsigned)status, type, status == HTTP_STATUS_NOT_MODIFIED ? 0 : count, p, end) == 0;
}

/* Adds the headers with security policies. A sandboxed document has an opaque origin, so even its own script counts as cross-origin.
   Returns false if the headers do not fit. */
static bool add_policies(struct http_exchange *request, const char *content_policy, unsigned char **p, unsigned char *end)
{
    const char *resource_policy = request->sandboxed ? "cross-origin" : "same-origin";
    char *sandbox = request->sandboxed ? mem_printf("%s; sandbox allow-scripts allow-top-navigation", content_policy) : NULL;
    bool added = add_header(request->wsi, "cross-origin-resource-policy:", resource_policy, p, end) &&
                 add_header(request->wsi, "content-security-policy:", sandbox ? sandbox : content_policy, p, end);
    mem_free(sandbox);
    return added;
}

/* Adds the headers that say how the body is compressed. Returns false if they do not fit. */
static bool add_encoding(struct http_exchange *request, unsigned char **p, unsigned char *end)
{
    bool added = (!request->varies || add_header(request->wsi, "vary:", "accept-encoding", p, end)) &&
                 (!request->gzip || add_header(request->wsi, "content-encoding:", "gzip", p, end));
    request->varies = request->gzip = false;
    return added;
}

/* Adds a header with the refusal's code and arguments, in ASCII because headers allow nothing else. Returns false if that fails. */
static bool add_refusal(const struct refusal *refusal, struct lws *wsi, unsigned char **p, unsigned char *end)
{
    json_t *object = refusal_json(refusal);
    char *text = json_dumps(object, JSON_COMPACT | JSON_ENSURE_ASCII);
    bool added = text && add_header(wsi, "plantcast-refusal:", text, p, end);
    free(text);
    json_decref(object);
    return added;
}

bool request_write_head(struct http_exchange *request, int status, const char *type, const char *extra_name, const char *extra)
{
    unsigned char buffer[LWS_PRE + HEAD_BYTES], *start = buffer + LWS_PRE, *p = start, *end = buffer + sizeof(buffer) - 1;
    struct lws *wsi = request->wsi;
    const struct server_context *server = server_context_of(wsi);
    if (!add_first(request, status, type, &p, end))
        return false;
    for (size_t i = 0; i < sizeof(security) / sizeof(security[0]); i++)
        if (!add_header(wsi, security[i][0], security[i][1], &p, end))
            return false;
    if (!add_policies(request, server->http.content_policy, &p, end))
        return false;
    if (server->tls && !add_header(wsi, "strict-transport-security:", "max-age=31536000", &p, end))
        return false;
    if (!add_encoding(request, &p, end))
        return false;
    if (closes(request) && !add_header(wsi, "connection:", "close", &p, end))
        return false;
    if (extra_name && !add_header(wsi, extra_name, extra, &p, end))
        return false;
    if (request->set_cookie && !add_header(wsi, "set-cookie:", request->set_cookie, &p, end))
        return false;
    mem_free(request->set_cookie);
    request->set_cookie = NULL;
    if (request->refusal.code && !add_refusal(&request->refusal, wsi, &p, end))
        return false;
    request->refusal.code = REFUSAL_NONE;
    return lws_finalize_write_http_header(wsi, start, &p, end) == 0;
}

void request_hold(struct http_exchange *request, char *body, size_t count)
{
    struct server_context *server = server_context_of(request->wsi);
    if (request->holder) {
        request->holder->answer_bytes -= (int64_t)request->count;
        server->http.answer_bytes -= (int64_t)request->count;
    }
    mem_free(request->body);
    request->holder = body ? connection_of(request->wsi)->client : NULL;
    request->body = body;
    request->count = count;
    request->sent = 0;
    if (!request->holder)
        return;
    request->holder->answer_bytes += (int64_t)count;
    server->http.answer_bytes += (int64_t)count;
}

/* Returns whether an answer of `count` bytes is within the quotas on unread bytes. A large answer occupies memory until the client has read
   it, however slowly. */
static bool may_hold(const struct http_exchange *request, size_t count)
{
    const struct server_context *server = server_context_of(request->wsi);
    const struct connection *connection = connection_of(request->wsi);
    bool room = server->http.answer_bytes + (int64_t)count < server->room.quotas->at[QUOTA_ANSWER_BYTES];
    return count <= SMALL_BYTES || !connection->client ||
           (room && address_limits_may_hold(server->room.addresses, connection->client, count));
}

int request_done(struct http_exchange *request)
{
    request_hold(request, NULL, 0);
    request->pieces = PIECES_NONE;
    connection_set_answered(server_context_of(request->wsi), request->wsi, true);
    /* A connection that is closed while the client still sends is reset, and the client then loses the answer. */
    if (request->body_left > 0) {
        request->discards_until_ns = clock_mono_ns() + DISCARD_NS;
        return 0;
    }
    stuck_head_await(request->wsi, false);
    return closes(request) || lws_http_transaction_completed(request->wsi) ? -1 : 0;
}

/* Writes the answer; takes ownership of body. Bytes that the socket does not accept now are written once it does. */
int request_answer(struct http_exchange *request, int status, const char *type, char *body, size_t count, const char *extra_name,
                   const char *extra)
{
    if (!may_hold(request, count)) {
        mem_free(body);
        return request_answer_later(request, "too many unread answers: read them, or try again later\n");
    }
    request_hold(request, body, count);
    if (!request_write_head(request, status, type, extra_name, extra))
        return -1;
    if (request->head || count == 0)
        return request_done(request);
    lws_callback_on_writable(request->wsi);
    return 0;
}

int request_answer_text(struct http_exchange *request, int status, const char *text)
{
    return request_answer(request, status, HTTP_TEXT, mem_strdup(text), strlen(text), NULL, NULL);
}

int request_answer_later(struct http_exchange *request, const char *why)
{
    return request_answer(request, HTTP_STATUS_SERVICE_UNAVAILABLE, HTTP_TEXT, mem_strdup(why), strlen(why), "retry-after:", "2");
}

int request_refuse_for(struct http_exchange *request, int status, const struct refusal *refusal)
{
    char words[REFUSAL_TEXT_BYTES], *text;
    bool later = status == HTTP_STATUS_SERVICE_UNAVAILABLE;
    refusal_text(refusal, words);
    text = mem_printf("%s\n", words);
    request->refusal = *refusal;
    return request_answer(request, status, HTTP_TEXT, text, strlen(text), later ? "retry-after:" : NULL, later ? "2" : NULL);
}

int request_refuse(struct http_exchange *request, int status, enum refusal_code code)
{
    return request_refuse_for(request, status, &(struct refusal){ .code = code });
}

int request_refuse_foreign(struct server_context *server, struct http_exchange *request, const char *path)
{
    connection_record_refusal(server, request->wsi, path, refusal_words(REFUSAL_FOREIGN));
    return request_refuse(request, HTTP_STATUS_FORBIDDEN, REFUSAL_FOREIGN);
}

int request_answer_unreadable(const struct server_context *server, struct http_exchange *request)
{
    if (server->params.plant.core_link && !server->params.plant.history_folder)
        return request_refuse(request, HTTP_STATUS_SERVICE_UNAVAILABLE, REFUSAL_CORELESS);
    return request_refuse(request, HTTP_STATUS_INTERNAL_SERVER_ERROR, REFUSAL_UNREADABLE);
}

int request_answer_json(struct http_exchange *request, char *text)
{
    return request_answer(request, HTTP_STATUS_OK, "application/json", text, strlen(text), NULL, NULL);
}

int request_answer_error(struct http_exchange *request, const struct message_error *error)
{
    char *text = mem_printf("%s\n", error->text);
    request->refusal = error->refusal;
    int status = strcmp(error->code, "not_allowed") == 0 ? HTTP_STATUS_FORBIDDEN : HTTP_STATUS_BAD_REQUEST;
    return request_answer(request, status, HTTP_TEXT, text, strlen(text), NULL, NULL);
}

int http_answer(struct lws *wsi, int status, const char *text)
{
    struct http_exchange request = { .wsi = wsi, .count = strlen(text) };
    if (!request_write_head(&request, status, HTTP_TEXT, NULL, NULL))
        return -1;
    return lws_write(wsi, (unsigned char *)text, strlen(text), LWS_WRITE_HTTP_FINAL) < 0 ? -1 : 0;
}

/* Returns whether argument i of the query is empty, like the second one in `a=1&&b=2`. libwebsockets turns an empty last
 * argument into "/". *end becomes true if there is no argument i. */
static bool is_empty_arg(struct lws *wsi, int i, bool *end)
{
    char text[2] = "";
    int length = lws_hdr_fragment_length(wsi, WSI_TOKEN_HTTP_URI_ARGS, i);
    *end = length == 0 && lws_hdr_copy_fragment(wsi, text, sizeof(text), WSI_TOKEN_HTTP_URI_ARGS, i) < 0;
    if (length == 1)
        lws_hdr_copy_fragment(wsi, text, sizeof(text), WSI_TOKEN_HTTP_URI_ARGS, i);
    return length == 0 || text[0] == '/';
}

bool request_args(struct lws *wsi, struct args *args, struct message_error *error)
{
    args->count = 0;
    for (int i = 0;; i++) {
        bool end, empty = is_empty_arg(wsi, i, &end);
        if (end)
            return true;
        if (empty)
            continue;
        if (args->count == MAX_ARGS) {
            message_fail(error, "bad_field", "the URL's query has more than %d arguments", MAX_ARGS);
            return false;
        }
        char *arg = args->bytes[args->count];
        if (lws_hdr_copy_fragment(wsi, arg, MAX_ARG_BYTES, WSI_TOKEN_HTTP_URI_ARGS, i) < 0) {
            message_fail(error, "bad_field", "argument %d of the URL's query is longer than %d bytes", i + 1, MAX_ARG_BYTES - 1);
            return false;
        }
        args->list[args->count++] = arg;
    }
}

const char *arg_of(const struct args *args, const char *name)
{
    size_t length = strlen(name);
    for (size_t i = 0; i < args->count; i++)
        if (!strncmp(args->list[i], name, length) && args->list[i][length] == '=')
            return args->list[i] + length + 1;
    return NULL;
}

void request_await(struct server_context *server, struct http_exchange *request)
{
    request->client = server->streams.next_client++;
    request->next = server->http.waiting;
    server->http.waiting = request;
    request->usage = connection_of(request->wsi)->client;
    /* seconds after which a waiting request for a picture, past readings or a reload is answered with "not ready" */
    int64_t wait_s = server->room.quotas->at[QUOTA_ANSWER_WAIT_S];
    request->until_ns = clock_mono_ns() + wait_s * NS_PER_S;
    lws_set_timeout(request->wsi, PENDING_TIMEOUT_HTTP_CONTENT, (int)wait_s + 15);
}

void http_on_tick(struct server_context *server, int64_t now_ns)
{
    for (struct http_exchange *request = server->http.waiting, *next; request; request = next) {
        next = request->next;
        if (now_ns < request->until_ns || request->pieces != PIECES_NONE || request->recorded)
            continue;
        request_forget(server, request);
        request->reload = 0;
        char *text = mem_printf("no answer within %d s (the first picture of a large plant takes longest); try again\n",
                                (int)server->room.quotas->at[QUOTA_ANSWER_WAIT_S]);
        request_answered(request, request_answer_later(request, text));
        mem_free(text);
    }
}

struct http_exchange *request_find(const struct server_context *server, uint64_t client)
{
    struct http_exchange *request = server->http.waiting;
    while (request && request->client != client)
        request = request->next;
    return request;
}

/* Frees the data about the frame or pick for which a request waits, and sets *asked to NULL; accepts a pointer to NULL. */
static void asked_free(struct asked **asked)
{
    if (!*asked)
        return;
    for (size_t i = 0; i < (*asked)->arg_count; i++)
        mem_free((*asked)->args[i]);
    mem_free((*asked)->args);
    mem_free(*asked);
    *asked = NULL;
}

void request_forget(struct server_context *server, struct http_exchange *request)
{
    struct http_exchange **at = &server->http.waiting;
    while (*at && *at != request)
        at = &(*at)->next;
    if (!*at)
        return;
    *at = request->next;
    server->http.pictures -= request->asked != NULL;
    request->usage->pictures -= request->asked != NULL;
    server->http.questions -= request->asks;
    request->usage->questions -= request->asks;
    request->asks = request->asks_instant = false;
    render_service_forget(server->params.plant.render_service, request->client);
    if (server->history_queries)
        history_queries_forget(server->history_queries, request->client);
    if (server->history_loader)
        history_loader_forget(server->history_loader, request->client);
    if (request->asked && request->asked->historical)
        snapshot_cache_give(server->params.plant.snapshot_cache, &request->asked->historical);
    asked_free(&request->asked);
}

void request_answered(struct http_exchange *request, int result)
{
    if (result < 0)
        lws_set_timeout(request->wsi, PENDING_TIMEOUT_CLOSE_SEND, LWS_TO_KILL_ASYNC);
}
