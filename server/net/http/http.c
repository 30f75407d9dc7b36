/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Handles HTTP requests other than streams: checks rights, finds the handler of a path, and serves the web client's files. */
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"
#include "corelink/core_instant.h"
#include "corelink/core_tags.h"
#include "message/json_fields.h"
#include "net/http/http_impl.h"
#include "net/http/site.h"
#include "net/http/stuck_head.h"
#include "net/tls.h"
#include "net/connection.h"
#include "net/core_end.h"
#include "net/renderers.h"

static int alive(struct server_context *server, struct http_exchange *request)
{
    (void)server;
    return request_answer_text(request, HTTP_STATUS_OK, "ok\n");
}

#define NGINX_LINES "proxy_http_version 1.1; proxy_set_header Upgrade $http_upgrade; proxy_set_header Connection \"upgrade\";"

/* time in nanoseconds for which the server remembers why it refused to open a stream, so that the page can ask for the reason
   with another request */
static const int64_t REFUSED_NS = 15 * NS_PER_S;

/* Logs a request to the stream's path that lacks the header Upgrade, the sign of a misconfigured proxy. Proxies drop Upgrade
   and Connection, which apply to one connection only, and keep the other headers of a handshake. */
static void log_without_upgrade(struct server_context *server, struct lws *wsi, int64_t now_ns)
{
    char more[LOG_PACE_BYTES], via[100], shown[48];
    bool handshake = lws_hdr_total_length(wsi, WSI_TOKEN_KEY) > 0;
    server->upgrade.pace.first_ns = server->upgrade.pace.longest_ns = 60 * NS_PER_S;
    if (!log_pace_take(&server->upgrade.pace, now_ns, more))
        return;
    bool named = lws_hdr_copy(wsi, via, sizeof(via), WSI_TOKEN_HTTP_VIA) > 0;
    log_warn(server->params.log, "stream: a request from %s came without Upgrade: websocket%s%s%s%s; nginx needs: %s%s",
             connection_of(wsi)->address, handshake ? ", although it is a WebSocket handshake: a proxy in between removed the header" : "",
             named ? " (Via: " : "", named ? quoted(via, shown) : "", named ? ")" : "", NGINX_LINES, more);
}

/* Returns why a stream handshake from this address was refused in the last seconds (static text); NULL: none was. The address
   identifies the browser, which asks over another connection. */
static const char *last_refusal(const struct server_context *server, const char *address, int64_t now_ns)
{
    for (unsigned i = 1; i <= UPGRADE_REFUSALS; i++) {
        const struct upgrade_refusal *refusal = &server->upgrade.refused[(server->upgrade.count - i) % UPGRADE_REFUSALS];
        if (refusal->at_ns && now_ns - refusal->at_ns < REFUSED_NS && !strcmp(refusal->address, address))
            return refusal->why;
    }
    return NULL;
}

static int stream_without_upgrade(struct server_context *server, struct http_exchange *request)
{
    static const char text[] = "426 Upgrade Required: /stream is a WebSocket with the subprotocol " WIRE_SUBPROTOCOL
                               ", and this request came without `Upgrade: websocket`. If a browser or a program asked, a proxy on the way "
                               "removed it. nginx needs: " NGINX_LINES "\n";
    int64_t now_ns = clock_mono_ns();
    const char *refused = last_refusal(server, connection_of(request->wsi)->address, now_ns);
    /* does not log a request with ?why: the page itself sends it after a failed handshake, to learn the reason */
    if (lws_hdr_total_length(request->wsi, WSI_TOKEN_HTTP_URI_ARGS) == 0)
        log_without_upgrade(server, request->wsi, now_ns);
    char *body = refused ? mem_printf("%srefused: %s", text, refused) : mem_strdup(text);
    return request_answer(request, 426, HTTP_TEXT, body, strlen(body), "upgrade:", "websocket");
}

static int file(struct server_context *server, struct http_exchange *request, const char *path)
{
    struct site_file *found = site_find(server->http.site, path);
    char seen[64] = "", accepted[128] = "";
    request->sandboxed = !strncmp(path, "/keeper/", 8);
    if (!found)
        return request_answer_text(request, HTTP_STATUS_NOT_FOUND, "not found\n");
    lws_hdr_copy(request->wsi, accepted, sizeof(accepted), WSI_TOKEN_HTTP_ACCEPT_ENCODING);
    const struct site_form *form = site_form_for(found, accepted);
    request->varies = true;
    if (lws_hdr_copy(request->wsi, seen, sizeof(seen), WSI_TOKEN_HTTP_IF_NONE_MATCH) > 0 && !strcmp(seen, form->etag))
        return request_answer(request, HTTP_STATUS_NOT_MODIFIED, found->type, NULL, 0, "etag:", form->etag);
    request->gzip = form == &found->gzip;
    /* copies the file, because the request frees the bytes of its answer and the site keeps its own */
    char *bytes = mem_array(form->count + 1, 1);
    memcpy(bytes, form->bytes, form->count);
    return request_answer(request, HTTP_STATUS_OK, found->type, bytes, form->count, "etag:", form->etag);
}

/* Redirects the browser from a short link to the page, which then requests the link's view with the user's own rights. The redirect is
   relative, because a proxy may serve the page below another path. */
static int open_link(struct http_exchange *request, const char *id)
{
    char to[sizeof("../#v=") + SHORT_LINK_ID_BYTES];
    bool plain = id[strspn(id, "abcdefghijklmnopqrstuvwxyz0123456789")] == 0 && strlen(id) < SHORT_LINK_ID_BYTES;
    snprintf(to, sizeof(to), "%s#v=%s", strchr(id, '/') ? "/" : "../", plain && *id ? id : "unknown");
    return request_answer(request, HTTP_STATUS_SEE_OTHER, HTTP_TEXT, NULL, 0, "location:", to);
}

enum { VIEWS = 1, DISPLAY = 2, NODE = 4 };

static const struct {
    const char *path;
    int (*serve)(struct server_context *server, struct http_exchange *request);
    enum role least;
    /* bit mask (VIEWS, DISPLAY, NODE) of the kinds of limited tokens that may use this path: tokens for some views, for one
       display, or for other daemons */
    unsigned narrowed;
} routes[] = {
    { "/healthz", alive, ROLE_NOBODY, 0 },
    /* /readyz needs no check of its own: the event loop serves requests only after models and GL are loaded */
    { "/readyz", answer_ready, ROLE_NOBODY, 0 },
    { "/stream", stream_without_upgrade, ROLE_NOBODY, 0 },
    { "/login", ask_login, ROLE_NOBODY, 0 },
    { "/login/callback", ask_login_callback, ROLE_NOBODY, 0 },
    { "/api/v1/me", api_me, ROLE_NOBODY, 0 },
    { "/api/v1/pair", api_pair, ROLE_NOBODY, 0 },
    { "/snapshot.png", ask_snapshot, ROLE_OPEN, VIEWS },
    { "/metrics", metrics, ROLE_VIEWER, 0 },
    { "/api/v1/plant", api_plant, ROLE_VIEWER, 0 },
    { "/api/v1/tags", api_tags, ROLE_VIEWER, 0 },
    { "/api/v1/neighbours", api_neighbours, ROLE_VIEWER, 0 },
    { "/api/v1/proofs", api_loop_checks, ROLE_VIEWER, 0 },
    { "/api/v1/views", api_views, ROLE_VIEWER, 0 },
    { "/api/v1/link", api_link, ROLE_OPEN, 0 },
    { "/api/v1/walls", api_walls, ROLE_VIEWER, VIEWS | DISPLAY },
    { "/api/v1/other_plants", api_other_plants, ROLE_VIEWER, DISPLAY },
    { "/api/v1/other_plants/picture", ask_other_picture, ROLE_VIEWER, DISPLAY },
    { "/api/v1/notes", api_notes, ROLE_VIEWER, 0 },
    { "/api/v1/pick", ask_pick, ROLE_VIEWER, 0 },
    { "/api/v1/history", ask_history, ROLE_VIEWER, DISPLAY | NODE },
    { "/api/v1/history/gaps", ask_gaps, ROLE_VIEWER, DISPLAY | NODE },
    { "/api/v1/drift", ask_drift, ROLE_VIEWER, NODE },
    { "/api/v1/alarms", api_alarms, ROLE_VIEWER, 0 },
    { "/api/v1/alarms/journal", ask_journal, ROLE_VIEWER, NODE },
    { CORE_INSTANT_PATH, ask_instant, ROLE_ENGINEER, NODE },
    { CORE_TAGS_PATH, ask_core_tags, ROLE_ENGINEER, NODE },
    { "/api/v1/devices", api_devices, ROLE_ENGINEER, 0 },
    { "/api/v1/import", api_import, ROLE_ENGINEER, 0 },
    { "/api/v1/import/report", api_import_report, ROLE_ENGINEER, 0 },
    { "/api/v1/import/matches", api_import_matches, ROLE_ENGINEER, 0 },
};

static int refuse(struct http_exchange *request, const struct http_refusal *refusal)
{
    bool whose = refusal->status == HTTP_STATUS_UNAUTHORIZED, held = refusal->status == 429 || refusal->status == 503;
    request->close |= refusal->status == HTTP_STATUS_SERVICE_UNAVAILABLE;
    request->refusal = (struct refusal){ .code = refusal->code };
    char *text = refusal->text ? mem_strdup(refusal->text) : mem_printf("%s\n", refusal_words(refusal->code));
    return request_answer(request, refusal->status, HTTP_TEXT, text, strlen(text),
                          whose  ? "www-authenticate:"
                          : held ? "retry-after:"
                                 : NULL,
                          whose ? "Bearer realm=\"plantcast\"" : "5");
}

/* Returns whether another site's page sent the request. Other sites may link here, but may not embed this server's pictures. */
static bool is_foreign_page(struct lws *wsi)
{
    char site[32];
    return lws_hdr_custom_copy(wsi, site, sizeof(site), "sec-fetch-site:", 15) > 0 && !strcmp(site, "cross-site");
}

static const struct http_refusal NEED_TOKEN = { HTTP_STATUS_UNAUTHORIZED, .code = REFUSAL_TOKEN_NEEDED };
static const struct http_refusal NOT_FOR_YOU = { HTTP_STATUS_FORBIDDEN, .code = REFUSAL_PICTURES_ONLY };
static const struct http_refusal NOT_IN_VIEWS = { HTTP_STATUS_FORBIDDEN, .code = REFUSAL_VIEWS_ONLY };
static const struct http_refusal NOT_ON_DISPLAY = { HTTP_STATUS_FORBIDDEN, .code = REFUSAL_DISPLAY_ONLY };

/* Answers a user who lacks the role engineer: 401 without a token, 403 with one. Returns the result for the libwebsockets callback. */
static int refuse_others(struct http_exchange *request, enum role role)
{
    return role == ROLE_NOBODY ? refuse(request, &NEED_TOKEN) : request_refuse(request, HTTP_STATUS_FORBIDDEN, REFUSAL_ROLE_ENGINEER);
}

static int serve_route(struct server_context *server, struct http_exchange *request, size_t i)
{
    enum role role = connection_of(request->wsi)->role;
    const struct token_holder *holder = &connection_of(request->wsi)->holder;
    unsigned scope = holder->views[0] ? VIEWS : holder->display ? DISPLAY : 0;
    if (scope && routes[i].least > ROLE_NOBODY) {
        if (!(routes[i].narrowed & scope)) {
            connection_record_refusal(server, request->wsi, routes[i].path, "the token does not allow this request");
            return refuse(request, scope == VIEWS ? &NOT_IN_VIEWS : &NOT_ON_DISPLAY);
        }
    } else if (role < routes[i].least && !(role_is_node(role) && (routes[i].narrowed & NODE))) {
        bool engineer = routes[i].least == ROLE_ENGINEER;
        connection_record_refusal(server, request->wsi, routes[i].path, engineer ? "the request needs the role engineer" : "pictures only");
        return engineer ? refuse_others(request, role) : refuse(request, role == ROLE_NOBODY ? &NEED_TOKEN : &NOT_FOR_YOU);
    }
    if (routes[i].least > ROLE_NOBODY && is_foreign_page(request->wsi))
        return request_refuse_foreign(server, request, routes[i].path);
    return routes[i].serve(server, request);
}

static int serve_post(struct server_context *server, struct http_exchange *request, const char *path)
{
    enum role role = connection_of(request->wsi)->role;
    request->close = true; /* closes the connection after the answer, because the client may send a body that nobody will read */
    if (role < ROLE_ENGINEER) {
        connection_record_refusal(server, request->wsi, path, "the request needs the role engineer");
        return refuse_others(request, role);
    }
    if (is_foreign_page(request->wsi))
        return request_refuse_foreign(server, request, path);
    if (!strcmp(path, RELOAD_PATH))
        return ask_reload(server, request);
    return import_post(server, request, path);
}

/* Answers with status 405 (method not allowed). posts: true: the path accepts only POST. */
static int refuse_method(const struct server_context *server, struct http_exchange *request, bool posts)
{
    struct text text = { 0 };
    request->close = true; /* closes the connection after the answer, because the client may send a body that nobody will read */
    if (posts) {
        text_add(&text, "only POST is allowed\n");
    } else {
        text_add(&text, "only GET and HEAD are allowed (POST: %s, %s", RELOAD_PATH, LOGOUT_PATH);
        import_add_posts(server, &text);
        text_add(&text, ")\n");
    }
    return request_answer(request, HTTP_STATUS_METHOD_NOT_ALLOWED, HTTP_TEXT, text.at, text.length, "allow:",
                          posts ? "POST" : "GET, HEAD");
}

/* Returns the number of bytes of the body that a request announces; INT64_MAX: not known. libwebsockets reads a body without
   Content-Length only for POST, PUT and PATCH. With other methods it reads no such body, so it never reports the body's end. */
static int64_t announced_bytes(struct lws *wsi)
{
    char length[32];
    bool reads = lws_hdr_total_length(wsi, WSI_TOKEN_POST_URI) > 0 || lws_hdr_total_length(wsi, WSI_TOKEN_PUT_URI) > 0 ||
                 lws_hdr_total_length(wsi, WSI_TOKEN_PATCH_URI) > 0;
    if (reads && lws_hdr_total_length(wsi, WSI_TOKEN_HTTP_TRANSFER_ENCODING) > 0)
        return INT64_MAX;
    return connection_header(wsi, WSI_TOKEN_HTTP_CONTENT_LENGTH, length, sizeof(length)) ? strtoll(length, NULL, 10) : 0;
}

static int serve(struct server_context *server, struct http_exchange *request, const char *path)
{
    bool posts = !strcmp(path, RELOAD_PATH) || !strcmp(path, LOGOUT_PATH) || import_takes_post(server, path);
    bool post = posts && lws_hdr_total_length(request->wsi, WSI_TOKEN_POST_URI) > 0;
    bool get = lws_hdr_total_length(request->wsi, WSI_TOKEN_GET_URI) > 0;
    struct http_refusal refusal;
    request->head = lws_hdr_total_length(request->wsi, WSI_TOKEN_HEAD_URI) > 0;
    /* clears the value that the connection's previous request left: libwebsockets reuses this struct for all requests of a
       connection */
    request->sandboxed = false;
    request->body_left = get || request->head ? 0 : announced_bytes(request->wsi);
    request->close |= request->body_left > 0; /* the answer may be sent after the body has ended, but its head says "close" */
    counter_inc(server->counters.requests, 1);
    connection_set_answered(server, request->wsi, false);
    stuck_head_arrived(request->wsi);
    if (!get && !request->head && !post)
        return refuse_method(server, request, posts);
    if (!connection_identify(server, request->wsi, &refusal)) {
        counter_inc(server->counters.refused, 1);
        return refuse(request, &refusal);
    }
    if (post && !strcmp(path, LOGOUT_PATH)) {
        request->close = true;
        return ask_logout(server, request);
    }
    if (post)
        return serve_post(server, request, path);
    for (size_t i = 0; i < sizeof(routes) / sizeof(routes[0]); i++)
        if (!strcmp(routes[i].path, path))
            return serve_route(server, request, i);
    if (!strncmp(path, SHORT_LINK_PATH, strlen(SHORT_LINK_PATH)))
        return open_link(request, path + strlen(SHORT_LINK_PATH));
    return file(server, request, path);
}

static int on_writeable(struct server_context *server, struct http_exchange *request)
{
    if (request->pieces)
        return chunked_write(server, request);
    size_t left = request->count - request->sent, slice = left < SLICE_BYTES ? left : SLICE_BYTES;
    if (!request->body)
        return 0;
    if (!net_write(server, request->wsi, request->body + request->sent, slice, slice == left ? LWS_WRITE_HTTP_FINAL : LWS_WRITE_HTTP))
        return -1;
    request->sent += slice;
    if (slice == left)
        return request_done(request);
    lws_set_timeout(request->wsi, PENDING_TIMEOUT_HTTP_CONTENT, 20);
    lws_callback_on_writable(request->wsi);
    return 0;
}

/* Takes the next `count` bytes of the request's body; bytes NULL: the body has ended. */
static int take_body(struct server_context *server, struct http_exchange *request, const void *bytes, size_t count)
{
    request->body_left -= bytes ? (int64_t)count : request->body_left;
    if (!request->discards_until_ns)
        return bytes ? import_take_body(server, request, bytes, count) : import_end_body(server, request);
    return bytes && clock_mono_ns() < request->discards_until_ns ? 0 : -1;
}

static struct http_exchange *request_of(struct lws *wsi, struct http_exchange **slot)
{
    if (!*slot) {
        *slot = mem_new(sizeof(**slot));
        (*slot)->wsi = wsi;
    }
    return *slot;
}

static void request_end(struct server_context *server, struct http_exchange **slot)
{
    if (!slot || !*slot)
        return;
    request_forget(server, *slot);
    import_abandon_body(*slot);
    request_hold(*slot, NULL, 0);
    mem_free((*slot)->set_cookie);
    mem_free(*slot);
    *slot = NULL;
}

/* Handles libwebsockets events of a connection as a whole, such as its opening and closing. Returns false for other events. */
static bool on_connection(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in, int *result)
{
    *result = 0;
    switch (reason) {
    case LWS_CALLBACK_FILTER_NETWORK_CONNECTION:
        *result = connection_may_open(server_context_of(wsi), (int)(intptr_t)in) ? 0 : -1;
        return true;
    case LWS_CALLBACK_SERVER_NEW_CLIENT_INSTANTIATED:
        connection_open(server_context_of(wsi), wsi);
        stuck_head_await(wsi, true);
        return true;
    case LWS_CALLBACK_WSI_DESTROY: connection_close(server_context_of(wsi), wsi); return true;
    case LWS_CALLBACK_OPENSSL_LOAD_EXTRA_SERVER_VERIFY_CERTS: tls_serve(server_context_of(wsi)->tls, user); return true;
    default: return false;
    }
}

int http_callback(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in, size_t len)
{
    struct http_exchange **slot = user;
    int result;
    if (on_connection(wsi, reason, user, in, &result))
        return result;
    switch (reason) {
    case LWS_CALLBACK_HTTP: return serve(server_context_of(wsi), request_of(wsi, slot), in);
    case LWS_CALLBACK_HTTP_BODY: return *slot ? take_body(server_context_of(wsi), *slot, in, len) : 0;
    case LWS_CALLBACK_HTTP_BODY_COMPLETION: return *slot ? take_body(server_context_of(wsi), *slot, NULL, 0) : 0;
    case LWS_CALLBACK_HTTP_WRITEABLE: return *slot ? on_writeable(server_context_of(wsi), *slot) : 0;
    /* libwebsockets also sends this event when a connection is upgraded to a WebSocket; request_end() handles all other
       connections */
    case LWS_CALLBACK_HTTP_DROP_PROTOCOL:
    case LWS_CALLBACK_CLOSED_HTTP: request_end(server_context_of(wsi), slot); return 0;
    case LWS_CALLBACK_TIMER: return stuck_head_look(server_context_of(wsi), wsi);
    case LWS_CALLBACK_HTTP_CONFIRM_UPGRADE:
        stuck_head_arrived(wsi);
        /* counts the connection as having no open request: a stream gets a close frame of its own when the server shuts down */
        connection_set_answered(server_context_of(wsi), wsi, true);
        return strcasecmp(in, "websocket") == 0 ? stream_check_upgrade(server_context_of(wsi), wsi) : -1;
    /* refuses a WebSocket without subprotocol; all other WebSockets go to the handlers of their subprotocols */
    case LWS_CALLBACK_ESTABLISHED: {
        static unsigned char text[] = "the subprotocol is " WIRE_SUBPROTOCOL;
        lws_close_reason(wsi, LWS_CLOSE_STATUS_PROTOCOL_ERR, text, sizeof(text) - 1);
        return -1;
    }
    default: return 0;
    }
}
