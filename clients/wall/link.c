/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Connections that come back: after 0.5 s, then twice as long each time up to 8 s, or as the server says, give or take a quarter. */
#include "link.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"
#include "base/secret.h"

enum { TICK_US = 100000, MOST_TEXT_BYTES = 64 * 1024 * 1024, MOST_TRIES = 4, MOST_FAILURES = 5 };
static const int64_t PING_NS = NS_PER_S, SILENT_NS = 5 * NS_PER_S, CONNECT_NS = 10 * NS_PER_S;
static const int64_t AGAIN_NS[GET_COUNT] = { 2 * NS_PER_S, 2 * NS_PER_S, NS_PER_S / 2, NS_PER_S / 5, 2 * NS_PER_S }; /* by links_get */
static const double FIRST_S = 0.5, SPREAD_S = 2, DENIED_S = 10; /* wrong tokens are looked at ten times a minute */

/* --- what goes -------------------------------------------------------------------------------------------------------------------- */

static void drop_queue(struct link *link)
{
    while (link->queued > 0)
        free(link->queue[--link->queued]);
}

static void enqueue(struct link *link, json_t *message)
{
    char *text = json_dumps(message, JSON_COMPACT);
    json_decref(message);
    if (text && link->queued < LINK_MOST_QUEUED)
        link->queue[link->queued++] = text;
    else
        free(text);
    if (link->queued == LINK_MOST_QUEUED) /* it takes nothing: another connection begins with all there is to say */
        link->closing = true;
    lws_cancel_service(link->links->context);
}

void link_post(struct link *link, json_t *message)
{
    if (link->state == LINK_WELCOMED)
        enqueue(link, message);
    else
        json_decref(message);
}

void link_restart(struct link *link)
{
    link->closing = link->asked = link->wsi != NULL;
    link->tries = 0;
    link->retry_ns = 0;
    if (link->links->context)
        lws_cancel_service(link->links->context);
}

static int on_writeable(struct link *link)
{
    if (link->closing)
        return -1;
    if (link->queued == 0)
        return 0;
    char *text = link->queue[0];
    size_t count = strlen(text);
    unsigned char *buffer = mem_new(LWS_PRE + count);
    memcpy(buffer + LWS_PRE, text, count);
    int sent = lws_write(link->wsi, buffer + LWS_PRE, count, LWS_WRITE_TEXT);
    mem_free(buffer);
    free(text);
    memmove(link->queue, link->queue + 1, (size_t)--link->queued * sizeof(link->queue[0]));
    if (link->queued > 0)
        lws_callback_on_writable(link->wsi);
    return sent < (int)count ? -1 : 0;
}

/* --- what comes ------------------------------------------------------------------------------------------------------------------- */

static bool is_refusal(const char *code)
{
    return code && (!strcmp(code, "token_needed") || !strcmp(code, "bad_token") || !strcmp(code, "locked"));
}

static void refuse(struct link *link)
{
    link->denied = true;
    link->closing = true;
    link->retry_after_s = DENIED_S;
    link->events->refused(link);
}

static void on_text(struct link *link)
{
    json_t *message = json_loadb(link->in.at, link->in.length, 0, NULL);
    const char *type = json_string_value(json_object_get(message, "type"));
    if (type && !strcmp(type, "pong")) {
        link->events->pong(link, message);
    } else if (type && !strcmp(type, "error")) {
        const char *code = json_string_value(json_object_get(message, "code"));
        if (is_refusal(code))
            refuse(link);
        else if (code && !strcmp(code, "full"))
            link->retry_after_s = json_number_value(json_object_get(message, "retry_after_s"));
        else
            link->events->text(link, message);
    } else if (type) {
        if (!strcmp(type, "welcome")) {
            link->state = LINK_WELCOMED;
            link->heard_ns = link->alive_ns;
            link->tries = 0;
            link->denied = false;
            link->retry_after_s = 0;
        }
        link->events->text(link, message);
    }
    json_decref(message);
}

static void on_bytes(struct link *link)
{
    struct wire_frame frame;
    const uint8_t *bytes = (const uint8_t *)link->in.at;
    size_t count = link->in.length;
    if (wire_is_given_up(bytes, count))
        return;
    if (!wire_get_frame(bytes, count, &frame)) {
        link->closing = true;
        return;
    }
    int64_t begin_ns = clock_mono_ns();
    pthread_mutex_unlock(link->links->lock);
    bool good = link->events->frame(link, &frame, bytes + WIRE_FRAME_HEADER_BYTES);
    pthread_mutex_lock(link->links->lock);
    link->failures = good ? 0 : link->failures + 1;
    if (link->failures == MOST_FAILURES) /* what is sent is not what this machine decodes */
        link_post(link, json_pack("{s:s,s:[s]}", "type", "codecs", "codecs", "jpeg"));
    else if (!good && link->failures < MOST_FAILURES)
        link_post(link, json_pack("{s:s}", "type", "key_frame"));
    if (!(frame.flags & WIRE_FLAG_MORE))
        link_post(link, json_pack("{s:s,s:I,s:f}", "type", "ack", "seq", (json_int_t)frame.seq, "decode_ms",
                                  (double)(clock_mono_ns() - begin_ns) / 1e6));
}

static int on_receive(struct link *link, struct lws *wsi, const void *bytes, size_t count)
{
    if (link->in.length + count > MOST_TEXT_BYTES + WIRE_FRAME_HEADER_BYTES)
        return -1;
    text_add_bytes(&link->in, bytes, count);
    link->alive_ns = clock_mono_ns();
    if (link->state == LINK_WELCOMED) /* a server that is full speaks, but shows nothing */
        link->heard_ns = link->alive_ns;
    if (lws_remaining_packet_payload(wsi) > 0 || !lws_is_final_fragment(wsi))
        return 0;
    if (lws_frame_is_binary(wsi))
        on_bytes(link);
    else
        on_text(link);
    link->in.length = 0;
    return link->closing ? -1 : 0;
}

/* --- coming and going ------------------------------------------------------------------------------------------------------------- */

double link_wait_s(int tries, double told_s)
{
    double usual_s = told_s > 0 ? told_s : FIRST_S * (1 << tries);
    double spread_s = tries == 0 ? SPREAD_S * rand() / RAND_MAX : 0; /* displays lose a server all at once */
    return usual_s * (0.75 + 0.5 * rand() / RAND_MAX) + spread_s;
}

static void on_gone(struct link *link)
{
    double wait_s = link_wait_s(link->tries, link->retry_after_s);
    bool asked = link->asked;
    link->wsi = NULL;
    link->closing = link->asked = false;
    link->state = link->wanted ? LINK_WAITING : LINK_IDLE;
    link->retry_ns = clock_mono_ns() + (asked ? 0 : (int64_t)(wait_s * 1e9));
    link->retry_after_s = 0;
    link->tries += link->tries < MOST_TRIES;
    drop_queue(link);
    text_finish(&link->in);
}

static void connect_link(struct link *link)
{
    char path[sizeof(link->links->url->base) + 16];
    struct lws_client_connect_info info = { .context = link->links->context, .path = path, .protocol = WIRE_SUBPROTOCOL, .userdata = link };
    snprintf(path, sizeof(path), "%s/stream", link->links->url->base);
    daemon_prepare_connection(link->links->url, &info);
    if (link->index == 0 && link->links->choose_token)
        link->links->choose_token(link->links->arg);
    else if (link->index == 0)
        daemon_read_token();
    link->state = LINK_CONNECTING;
    link->begun_ns = clock_mono_ns();
    info.pwsi = &link->wsi;
    pthread_mutex_unlock(link->links->lock); /* looking a name up may take seconds */
    bool begun = lws_client_connect_via_info(&info) != NULL;
    pthread_mutex_lock(link->links->lock);
    if (!begun && link->state == LINK_CONNECTING)
        on_gone(link);
}

static void end_request(struct links_request *request)
{
    struct links *links = request->links;
    json_t *answer = request->under_way && request->body.at ? json_loadb(request->body.at, request->body.length, 0, NULL) : NULL;
    request->under_way = false;
    if (!request->wanted) /* else it was asked for something else meanwhile, and this is of what was before */
        links->got(links->arg, (enum links_get)(request - links->requests), answer, &request->body);
    text_finish(&request->body);
    json_decref(answer);
}

static void begin_request(struct links_request *request)
{
    struct links *links = request->links;
    char *path = mem_printf("%s%s", links->url->base, request->path);
    struct lws_client_connect_info info = {
        .context = links->context, .path = path, .method = "GET", .protocol = "http", .userdata = request
    };
    daemon_prepare_connection(links->url, &info);
    request->wanted = false;
    request->under_way = true;
    request->status = 0;
    request->begun_ns = clock_mono_ns();
    pthread_mutex_unlock(links->lock);
    bool begun = lws_client_connect_via_info(&info) != NULL;
    pthread_mutex_lock(links->lock);
    mem_free(path);
    if (!begun)
        end_request(request);
}

static void tick_link(struct link *link, int64_t now_ns)
{
    bool silent = link->state >= LINK_OPEN && now_ns - link->alive_ns > SILENT_NS;
    bool stuck = link->state == LINK_CONNECTING && now_ns - link->begun_ns > CONNECT_NS;
    if (link->wsi && (silent || stuck || !link->wanted))
        link->closing = true;
    if (link->wsi && link->closing) {
        lws_set_timeout(link->wsi, PENDING_TIMEOUT_USER_OK, LWS_TO_KILL_ASYNC);
        link->closing = false;
    } else if (link->wanted && !link->wsi && link->state <= LINK_WAITING && now_ns >= link->retry_ns) {
        connect_link(link);
    } else if (link->state == LINK_WELCOMED && now_ns - link->ping_ns >= PING_NS) {
        link->ping_ns = now_ns;
        enqueue(link, json_pack("{s:s,s:I}", "type", "ping", "t", (json_int_t)now_ns));
    }
    if (link->wsi && link->state >= LINK_OPEN && link->queued > 0)
        lws_callback_on_writable(link->wsi);
}

static void tick(struct links *links)
{
    int64_t now_ns = clock_mono_ns();
    links->alive_ns = now_ns;
    for (int i = 0; i < LINKS_MOST && !links->ends; i++)
        if (links->at[i].events)
            tick_link(&links->at[i], now_ns);
    for (int i = 0; i < GET_COUNT && !links->ends; i++) {
        struct links_request *request = &links->requests[i];
        if (request->wanted && !request->under_way && now_ns - request->begun_ns >= AGAIN_NS[i])
            begin_request(request);
    }
}

static void on_timer(lws_sorted_usec_list_t *sul)
{
    struct links *links = lws_container_of(sul, struct links, timer);
    pthread_mutex_lock(links->lock);
    tick(links);
    pthread_mutex_unlock(links->lock);
    lws_sul_schedule(links->context, 0, sul, on_timer, TICK_US);
}

/* "... retry after 12 s": how long a start takes. */
static double retry_after(const char *text, size_t count)
{
    static const char words[] = "retry after ";
    const char *at = memmem(text, count, words, sizeof(words) - 1);
    double seconds = 0;
    for (at = at ? at + sizeof(words) - 1 : text + count; at < text + count && *at >= '0' && *at <= '9' && seconds < 3600; at++)
        seconds = 10 * seconds + (*at - '0');
    return seconds;
}

/* Once for each reason. */
static void tell_why(struct links *links, const char *why)
{
    const struct daemon_url *url = links->url;
    if (!strcmp(links->why, why))
        return;
    snprintf(links->why, sizeof(links->why), "%s", why);
    fprintf(stderr, "plantcast-wall: http%s://%s:%d%s/: %s%s\n", url->tls ? "s" : "", url->host, url->port, url->base, why,
            strstr(why, "SSL") ? "; is its certificate trusted here? --ca FILE names one that is" : "");
}

static int on_link(struct link *link, struct lws *wsi, enum lws_callback_reasons reason, void *in, size_t len)
{
    switch (reason) {
    case LWS_CALLBACK_CLIENT_APPEND_HANDSHAKE_HEADER: return daemon_add_token(wsi, in, len);
    case LWS_CALLBACK_CLIENT_CONNECTION_ERROR:
        if (in && strstr(in, "unauthorized"))
            refuse(link);
        else if (link->index == 0)
            tell_why(link->links, in ? in : "no connection");
        on_gone(link);
        break;
    case LWS_CALLBACK_CLIENT_ESTABLISHED:
        link->links->why[0] = 0;
        link->wsi = wsi;
        link->state = LINK_OPEN;
        link->alive_ns = clock_mono_ns();
        enqueue(link, link->events->hello(link));
        lws_callback_on_writable(wsi);
        break;
    case LWS_CALLBACK_CLIENT_RECEIVE: return on_receive(link, wsi, in, len);
    case LWS_CALLBACK_CLIENT_WRITEABLE: return on_writeable(link);
    case LWS_CALLBACK_WS_PEER_INITIATED_CLOSE:
        if (len >= 2 && ((const uint8_t *)in)[0] == (1008 >> 8) && ((const uint8_t *)in)[1] == (1008 & 255))
            refuse(link);
        else if (len > 2)
            link->retry_after_s = retry_after((const char *)in + 2, len - 2);
        break;
    case LWS_CALLBACK_CLOSED_CLIENT_HTTP: /* before the upgrade: it took the connection, and nothing came */
        if (link->index == 0 && !link->asked)
            tell_why(link->links, "it does not answer");
        on_gone(link);
        break;
    case LWS_CALLBACK_CLIENT_CLOSED: on_gone(link); break;
    default: break;
    }
    return 0;
}

static int on_stream(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in, size_t len)
{
    struct links *links = lws_context_user(lws_get_context(wsi));
    struct link *link = user;
    int status = 0;
    pthread_mutex_lock(links->lock);
    if (reason == LWS_CALLBACK_EVENT_WAIT_CANCELLED)
        tick(links);
    else if (link)
        status = on_link(link, wsi, reason, in, len);
    pthread_mutex_unlock(links->lock);
    return status;
}

static int add_authorization(struct links_request *request, struct lws *wsi, void *in, size_t len)
{
    if (!request || !request->authorization)
        return daemon_add_token(wsi, in, len);
    pthread_mutex_lock(request->links->lock);
    unsigned char **at = in;
    const unsigned char *value = (const unsigned char *)request->authorization;
    int count = (int)strlen(request->authorization);
    int failed = lws_add_http_header_by_token(wsi, WSI_TOKEN_HTTP_AUTHORIZATION, value, count, at, *at + len);
    pthread_mutex_unlock(request->links->lock);
    return failed ? -1 : 0;
}

static int on_http(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in, size_t len)
{
    struct links_request *request = user;
    char buffer[LWS_PRE + 16 * 1024], *at = buffer + LWS_PRE;
    int room = sizeof(buffer) - LWS_PRE;
    if (reason == LWS_CALLBACK_CLIENT_APPEND_HANDSHAKE_HEADER)
        return add_authorization(request, wsi, in, len);
    if (reason == LWS_CALLBACK_RECEIVE_CLIENT_HTTP) /* it calls back with what was read */
        return lws_http_client_read(wsi, &at, &room) < 0 ? -1 : 0;
    if (!request || reason == LWS_CALLBACK_WSI_CREATE)
        return 0;
    pthread_mutex_lock(request->links->lock);
    if (reason == LWS_CALLBACK_ESTABLISHED_CLIENT_HTTP)
        request->status = (int)lws_http_client_http_response(wsi);
    else if (reason == LWS_CALLBACK_RECEIVE_CLIENT_HTTP_READ && request->body.length + len <= MOST_TEXT_BYTES)
        text_add_bytes(&request->body, in, len);
    else if (request->under_way && (reason == LWS_CALLBACK_COMPLETED_CLIENT_HTTP || reason == LWS_CALLBACK_CLOSED_CLIENT_HTTP ||
                                    reason == LWS_CALLBACK_CLIENT_CONNECTION_ERROR))
        end_request(request);
    pthread_mutex_unlock(request->links->lock);
    return 0;
}

/* --- life --------------------------------------------------------------------------------------------------------------------------- */

static void *run(void *arg)
{
    struct links *links = arg;
    bool ends = false;
    on_timer(&links->timer);
    while (!ends) {
        lws_service(links->context, 0);
        pthread_mutex_lock(links->lock);
        ends = links->ends;
        pthread_mutex_unlock(links->lock);
    }
    return NULL;
}

bool links_start(struct links *links)
{
    static const struct lws_protocols protocols[] = {
        { .name = WIRE_SUBPROTOCOL, .callback = on_stream, .rx_buffer_size = 64 * 1024 },
        { .name = "http", .callback = on_http },
        { 0 },
    };
    struct lws_context_creation_info info = {
        .port = CONTEXT_PORT_NO_LISTEN,
        .protocols = protocols,
        .gid = -1,
        .uid = -1,
        .pt_serv_buf_size = 64 * 1024,
        .timeout_secs = 10,
        .user = links,
    };
    lws_set_log_level(0, NULL);
    daemon_prepare_context(links->url, &info);
    links->context = lws_create_context(&info);
    links->alive_ns = clock_mono_ns();
    links->started = links->context && pthread_create(&links->thread, NULL, run, links) == 0;
    if (!links->started)
        fprintf(stderr, "plantcast-wall: the network cannot be used: out of memory, or of threads\n");
    return links->started;
}

void links_stop(struct links *links)
{
    if (links->started) {
        pthread_mutex_lock(links->lock);
        links->ends = true;
        pthread_mutex_unlock(links->lock);
        lws_cancel_service(links->context);
        pthread_join(links->thread, NULL);
    }
    if (links->context)
        lws_context_destroy(links->context);
    for (int i = 0; i < LINKS_MOST; i++) {
        drop_queue(&links->at[i]);
        text_finish(&links->at[i].in);
    }
    for (int i = 0; i < GET_COUNT; i++) {
        text_finish(&links->requests[i].body);
        mem_free(links->requests[i].path);
        secret_forget(links->requests[i].authorization);
    }
    links->context = NULL;
}

void links_ask(struct links *links, enum links_get what, const char *path)
{
    struct links_request *request = &links->requests[what];
    mem_free(request->path);
    request->path = mem_strdup(path);
    request->links = links;
    request->wanted = true;
    lws_cancel_service(links->context);
}

void links_ask_as(struct links *links, enum links_get what, const char *path, const char *authorization)
{
    secret_forget(links->requests[what].authorization);
    links->requests[what].authorization = mem_strdup(authorization);
    links_ask(links, what, path);
}

int64_t links_alive_ns(struct links *links)
{
    pthread_mutex_lock(links->lock);
    int64_t alive_ns = links->alive_ns;
    pthread_mutex_unlock(links->lock);
    return alive_ns;
}
