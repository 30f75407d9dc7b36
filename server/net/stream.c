/* SPDX-License-Identifier: GPL-3.0-or-later */
/* /stream: WebSocket bytes to a session and back. One write per writeable callback, so that lws never has to keep what a socket
   does not take. */
#include <errno.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"
#include "net/hub.h"
#include "net/reply.h"

static const int64_t MOVING_NS = 200 * NS_PER_MS; /* after an input somebody is taken to be moving */

struct stream {
    struct lws *wsi;
    struct session *session;
    struct stream *next;
    struct text in;  /* the message so far */
    size_t in_count; /* its bytes, kept or not */
    struct picture *sending;
    uint32_t seq;
    enum { SEND_MARKERS, SEND_HEADER, SEND_PAYLOAD } step;
    size_t sent; /* of the payload */
    bool throttled;
    int close_code; /* 0: stays open */
    const char *close_text;
    int64_t messages, errors, dropped; /* of the session, as counted already */
};

/* --- hand-shake ---------------------------------------------------------------------------------------------------------- */

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

static void tune_socket(struct lws *wsi)
{
    int fd = lws_get_socket_fd(wsi), on = 1, low = SLICE_BYTES;
    setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
    setsockopt(fd, IPPROTO_TCP, TCP_NOTSENT_LOWAT, &low, sizeof(low));
}

static void close_with(struct stream *stream, int code, const char *text)
{
    if (stream->close_code)
        return;
    stream->close_code = code;
    stream->close_text = text;
    lws_callback_on_writable(stream->wsi);
}

static void on_open(struct hub *hub, struct lws *wsi, struct stream **slot)
{
    struct stream *stream = mem_new(sizeof(*stream));
    *stream = (struct stream){ .wsi = wsi, .next = hub->streams };
    stream->session = session_create(&hub->world, hub->next_client++, clock_mono_ns());
    *slot = hub->streams = stream;
    hub->stream_count++;
    counter_set(hub->counters.sessions, hub->stream_count);
    counter_inc(hub->counters.sessions_all, 1);
    tune_socket(wsi);
    if (hub->stream_count > MAX_STREAMS) {
        counter_inc(hub->counters.refused, 1);
        close_with(stream, 1013, "full: try again later");
    }
    log_debug(hub->params.log, "session %llu: opened", (unsigned long long)stream->session->id);
}

static void count(struct hub *hub, struct stream *stream)
{
    const struct session *session = stream->session;
    counter_inc(hub->counters.messages, session->messages - stream->messages);
    counter_inc(hub->counters.errors, session->errors - stream->errors);
    counter_inc(hub->counters.dropped, session->dropped - stream->dropped);
    stream->messages = session->messages;
    stream->errors = session->errors;
    stream->dropped = session->dropped;
}

static void on_close(struct hub *hub, struct stream **slot)
{
    struct stream *stream = *slot, **at = &hub->streams;
    if (!stream)
        return;
    while (*at != stream)
        at = &(*at)->next;
    *at = stream->next;
    hub->stream_count--;
    counter_set(hub->counters.sessions, hub->stream_count);
    count(hub, stream);
    log_debug(hub->params.log, "session %llu: closed (%lld messages, %lld errors)", (unsigned long long)stream->session->id,
              (long long)stream->messages, (long long)stream->errors);
    painter_forget(hub->params.painter, stream->session->id);
    session_destroy(&stream->session);
    picture_destroy(&stream->sending);
    text_finish(&stream->in);
    mem_free(stream);
    *slot = NULL;
}

/* --- after anything happened to a session ---------------------------------------------------------------------------------- */

static void pump(struct hub *hub, struct stream *stream)
{
    struct session *session = stream->session;
    struct wish wish;
    int64_t now_ns = clock_mono_ns();
    if (stream->close_code)
        return;
    if (session_wish(session, now_ns, &wish)) {
        enum painter_answer answer = painter_ask(hub->params.painter, session->id, &wish);
        if (answer != PAINTER_REFUSED)
            session_asked(session, &wish, answer == PAINTER_REPLACED);
        hub->asked = true;
    }
    struct pick_order order;
    if (session_pick(session, &order))
        painter_pick(hub->params.painter, &order);
    if (session->too_fast != stream->throttled) {
        stream->throttled = session->too_fast;
        lws_rx_flow_control(stream->wsi, !stream->throttled);
    }
    if (stream->sending || session->ready || session_has_text(session, now_ns))
        lws_callback_on_writable(stream->wsi);
}

/* When every session is refined for every change of a reading, and there is one each second. */
static bool is_loaded(const struct hub *hub)
{
    int count = 0;
    for (const struct stream *stream = hub->streams; stream; stream = stream->next)
        count += stream->session->hello && !stream->session->hidden;
    return count * hub->still_ns > NS_PER_S;
}

void streams_on_tick(struct hub *hub, bool data_changed, bool links_changed)
{
    int64_t now_ns = clock_mono_ns();
    hub->world.loaded = is_loaded(hub);
    for (struct stream *stream = hub->streams; stream; stream = stream->next) {
        session_on_tick(stream->session, now_ns);
        if (data_changed)
            session_on_data(stream->session, now_ns);
        stream->session->owes_status |= links_changed;
        count(hub, stream);
        pump(hub, stream);
    }
}

void streams_close(struct hub *hub)
{
    for (struct stream *stream = hub->streams; stream; stream = stream->next)
        close_with(stream, LWS_CLOSE_STATUS_GOINGAWAY, "the server goes down");
}

static struct stream *find(const struct hub *hub, uint64_t client)
{
    struct stream *stream = hub->streams;
    while (stream && stream->session->id != client)
        stream = stream->next;
    return stream;
}

bool stream_owns(const struct hub *hub, uint64_t client)
{
    return find(hub, client) != NULL;
}

void stream_on_picture(struct hub *hub, struct picture *picture)
{
    struct stream *stream = find(hub, picture->client);
    const struct frame *frame = picture->packet ? picture->packet->frame : NULL;
    if (frame && frame->view.tier == TIER_STILL)
        hub->still_ns = frame->render_ns + frame->readback_ns;
    session_on_picture(stream->session, picture);
    if (stream->session->refused && !stream->close_code) {
        counter_inc(hub->counters.refused, 1);
        close_with(stream, 1013, "no memory for another picture: try later, or a smaller one");
    }
    pump(hub, stream);
}

void stream_on_pick(struct hub *hub, const struct pick_answer *answer)
{
    struct stream *stream = find(hub, answer->order.client);
    session_on_pick(stream->session, answer);
    pump(hub, stream);
}

/* --- input ------------------------------------------------------------------------------------------------------------------ */

static void on_message(struct hub *hub, struct stream *stream)
{
    struct session *session = stream->session;
    int64_t now_ns = clock_mono_ns();
    if (stream->in_count > WIRE_MAX_MESSAGE_BYTES)
        session_on_oversize(session, stream->in_count, now_ns);
    else
        session_on_message(session, stream->in.at ? stream->in.at : "", stream->in.length, now_ns, clock_utc_ns());
    if (session->input_pending)
        hub->world.moving_until_ns = now_ns + MOVING_NS;
    stream->in.length = 0;
    stream->in_count = 0;
    if (stream->in.capacity > 4096)
        text_finish(&stream->in);
}

static void on_receive(struct hub *hub, struct stream *stream, const void *bytes, size_t len)
{
    stream->in_count += len;
    if (stream->in_count > SESSION_MAX_INPUT_BYTES) {
        close_with(stream, LWS_CLOSE_STATUS_MESSAGE_TOO_LARGE, "a message is larger than 1 MiB");
        lws_rx_flow_control(stream->wsi, 0);
        return;
    }
    if (stream->in_count <= WIRE_MAX_MESSAGE_BYTES)
        text_add_bytes(&stream->in, bytes, len);
    if (lws_remaining_packet_payload(stream->wsi) == 0 && lws_is_final_fragment(stream->wsi))
        on_message(hub, stream);
    pump(hub, stream);
}

/* --- output ----------------------------------------------------------------------------------------------------------------- */

static bool write_text(struct stream *stream, char *at, size_t length)
{
    return lws_write(stream->wsi, (unsigned char *)at, length, LWS_WRITE_TEXT) >= (int)length;
}

static const struct text *padded(struct text *text)
{
    static const char pre[LWS_PRE];
    text_add_bytes(text, pre, sizeof(pre));
    return text;
}

static bool write_markers(struct stream *stream)
{
    struct text text = { 0 };
    char *markers = reply_markers_text(stream->sending->packet->frame, stream->seq);
    padded(&text);
    text_add(&text, "%s", markers);
    bool good = write_text(stream, text.at + LWS_PRE, text.length - LWS_PRE);
    text_finish(&text);
    mem_free(markers);
    return good;
}

static uint32_t us_of(int64_t ns)
{
    return ns <= 0 ? 0 : ns / 1000 > UINT32_MAX ? UINT32_MAX : (uint32_t)(ns / 1000);
}

static void camera_to_wire(const struct camera *camera, struct wire_frame *header_out)
{
    for (int i = 0; i < 3; i++) {
        header_out->eye_m[i] = (float)camera->eye_m[i];
        header_out->target_m[i] = (float)camera->target_m[i];
        header_out->up[i] = (float)camera->up[i];
    }
    header_out->fov_deg = camera->height_m > 0 ? 0 : (float)camera->fov_deg;
    header_out->height_m = (float)camera->height_m;
}

static struct wire_frame frame_header(const struct picture *picture, uint32_t seq)
{
    const struct packet *packet = picture->packet;
    const struct frame *frame = packet->frame;
    bool live = frame->oldest_age_ns != INT64_MAX;
    struct wire_frame out = {
        .type = WIRE_TYPE_FRAME,
        .codec = (uint8_t)packet->codec,
        .payload_bytes = (uint32_t)packet->count,
        .seq = seq,
        .flags = (uint16_t)((packet->key ? WIRE_FLAG_KEY : 0) | (frame->view.tier == TIER_STILL ? WIRE_FLAG_STILL : 0) |
                            (live ? 0 : WIRE_FLAG_NO_LIVE_DATA)),
        .camera_seq = picture->wish.view.camera_seq,
        .params_seq = picture->wish.view.params_seq,
        .oldest_age_ms = live ? us_of(frame->oldest_age_ns / 1000) : WIRE_NO_AGE,
        .data_time_us = (uint64_t)(frame->data_utc_ns / 1000),
        .sent_time_us = (uint64_t)(clock_utc_ns() / 1000),
        .wait_us = us_of(picture->wait_ns),
        .field_us = us_of(frame->field_ns),
        .render_us = us_of(frame->render_ns + frame->readback_ns),
        .encode_us = us_of(packet->encode_ns),
        .width_px = (uint16_t)frame->width_px,
        .height_px = (uint16_t)frame->height_px,
        .full_width_px = (uint16_t)frame->width_px,
        .full_height_px = (uint16_t)frame->height_px,
    };
    camera_to_wire(&frame->view.camera, &out);
    return out;
}

static bool write_header(struct hub *hub, struct stream *stream)
{
    uint8_t bytes[WIRE_FRAME_HEADER_BYTES];
    struct wire_frame head = frame_header(stream->sending, stream->seq);
    wire_put_frame(&head, bytes);
    return hub_write(hub, stream->wsi, bytes, sizeof(bytes), LWS_WRITE_BINARY | LWS_WRITE_NO_FIN);
}

static bool write_slice(struct hub *hub, struct stream *stream)
{
    const struct packet *packet = stream->sending->packet;
    size_t left = packet->count - stream->sent, slice = left < SLICE_BYTES ? left : SLICE_BYTES;
    enum lws_write_protocol how = LWS_WRITE_CONTINUATION;
    if (slice < left)
        how |= LWS_WRITE_NO_FIN;
    bool good = hub_write(hub, stream->wsi, packet->bytes + stream->sent, slice, how);
    stream->sent += slice;
    if (stream->sent == packet->count) {
        counter_inc(hub->counters.frames, 1);
        counter_inc(hub->counters.frame_bytes, (int64_t)packet->count + WIRE_FRAME_HEADER_BYTES);
        picture_destroy(&stream->sending);
    }
    return good;
}

static bool write_picture(struct hub *hub, struct stream *stream)
{
    switch (stream->step) {
    case SEND_MARKERS: stream->step = SEND_HEADER; return write_markers(stream);
    case SEND_HEADER: stream->step = SEND_PAYLOAD; return write_header(hub, stream);
    case SEND_PAYLOAD: break;
    }
    return write_slice(hub, stream);
}

/* Texts go between pictures, never into one. */
static bool write_next(struct hub *hub, struct stream *stream)
{
    struct session *session = stream->session;
    struct text text = { 0 };
    bool good = true;
    int64_t now_ns = clock_mono_ns();
    if (stream->sending)
        return write_picture(hub, stream);
    padded(&text);
    if (session_next_text(session, now_ns, clock_utc_ns(), &text)) {
        good = write_text(stream, text.at + LWS_PRE, text.length - LWS_PRE);
    } else if ((stream->sending = session_next_picture(session, now_ns, &stream->seq))) {
        stream->step = SEND_MARKERS;
        stream->sent = 0;
        good = write_picture(hub, stream);
    }
    text_finish(&text);
    return good;
}

static int on_writeable(struct hub *hub, struct stream *stream)
{
    if (stream->close_code) {
        lws_close_reason(stream->wsi, (enum lws_close_status)stream->close_code, (unsigned char *)stream->close_text,
                         strlen(stream->close_text));
        return -1;
    }
    if (!write_next(hub, stream))
        return -1;
    pump(hub, stream);
    hub_go(hub);
    return 0;
}

int stream_callback(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in, size_t len)
{
    struct stream **slot = user;
    switch (reason) {
    case LWS_CALLBACK_ESTABLISHED: on_open(hub_of(wsi), wsi, slot); break;
    case LWS_CALLBACK_CLOSED: on_close(hub_of(wsi), slot); break;
    case LWS_CALLBACK_RECEIVE:
        on_receive(hub_of(wsi), *slot, in, len);
        hub_go(hub_of(wsi));
        break;
    case LWS_CALLBACK_SERVER_WRITEABLE: return on_writeable(hub_of(wsi), *slot);
    default: break;
    }
    return 0;
}
