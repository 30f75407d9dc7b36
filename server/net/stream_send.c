/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sends texts and frames to one client, with one write per writeable callback, so that libwebsockets never has to buffer what
   the socket does not accept. */
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"
#include "session/reply/reply.h"
#include "net/stream.h"

static const int64_t PING_NS = 2 * NS_PER_S;

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

/* Sends the message `markers` (sensor markers of the frame) before the frame. Sets *wrote if something was sent. Returns false
   if the connection is gone. */
static bool write_markers(struct server_context *server, struct stream *stream, bool *wrote)
{
    struct text text = { 0 };
    /* sends no markers to clients that may not read the sensors' values */
    bool open = session_is_open(stream->session) || stream->session->scope.tags;
    char *markers = open ? NULL : marker_text(stream->sending->packet->frame, stream->seq, &stream->known, &server->texts.markers);
    *wrote = markers != NULL;
    if (!markers)
        return true;
    padded(&text);
    text_add_bytes(&text, markers, strlen(markers));
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

/* --- the packets of a frame, and the parts of each packet ------------------------------------------------------------- */

static const struct packet *packet_now(const struct stream *stream)
{
    const struct encoded_frame *encoded = stream->sending;
    return stream->packet < encoded->earlier_count ? encoded->earlier[stream->packet] : encoded->packet;
}

static bool is_last_part(const struct stream *stream)
{
    return stream->packet == stream->sending->earlier_count && stream->part == stream->sending->packet->part_count - 1;
}

static void next_part(struct stream *stream)
{
    stream->sent = 0;
    stream->step = SEND_HEADER;
    if (++stream->part < packet_now(stream)->part_count)
        return;
    stream->packet++;
    stream->part = 0;
}

static uint16_t flags_of(const struct stream *stream)
{
    const struct packet *packet = packet_now(stream);
    bool last = is_last_part(stream), live = packet->frame->oldest_age_ns != INT64_MAX;
    bool still = last && packet->frame->view.tier == TIER_REFINED && !stream->sending->request.draft;
    int seen = (packet->frame->view.at_us ? WIRE_FLAG_PAST : 0) | (packet->is_signed ? WIRE_FLAG_SIGNED : 0) |
               (stream->depth ? WIRE_FLAG_DEPTH : 0);
    return (uint16_t)((packet->key ? WIRE_FLAG_KEY : 0) | (still ? WIRE_FLAG_STILL : 0) | (live ? 0 : WIRE_FLAG_NO_LIVE_DATA) |
                      (last ? 0 : WIRE_FLAG_MORE) | (stream->sending->request.of_data ? WIRE_FLAG_DATA : 0) | seen);
}

static struct wire_frame frame_header(const struct server_context *server, const struct stream *stream)
{
    const struct encoded_frame *encoded = stream->sending;
    const struct packet *packet = packet_now(stream);
    const struct packet_part *part = &packet->parts[stream->part];
    const struct frame *frame = packet->frame;
    struct wire_frame out = {
        .type = WIRE_TYPE_FRAME,
        .codec = (uint8_t)packet->codec,
        .payload_bytes = (uint32_t)part->count,
        .seq = stream->seq,
        .flags = flags_of(stream),
        .camera_seq = encoded->request.view.camera_seq,
        .params_seq = encoded->request.view.params_seq,
        .oldest_age_ms = frame->oldest_age_ns == INT64_MAX ? WIRE_NO_AGE : us_of(frame->oldest_age_ns / 1000),
        .data_time_us = (uint64_t)(frame->data_utc_ns / 1000),
        .sent_time_us = (uint64_t)(clock_plant_ns(server->params.plant.clock) / 1000),
        .wait_us = us_of(encoded->wait_ns),
        .field_us = us_of(frame->field_ns),
        .render_us = us_of(frame->render_ns + frame->readback_ns),
        .encode_us = us_of(packet->encode_ns),
        .x_px = (uint16_t)part->x_px,
        .y_px = (uint16_t)part->y_px,
        .width_px = (uint16_t)part->width_px,
        .height_px = (uint16_t)part->height_px,
        .full_width_px = (uint16_t)frame->width_px,
        .full_height_px = (uint16_t)frame->height_px,
    };
    camera_to_wire(&frame->view.camera, &out);
    return out;
}

/* --- depth grids ------------------------------------------------------------------------------------------------------ */

static const struct depth_grid *grid_now(const struct stream *stream)
{
    const struct frame *frame = stream->sending->packet->frame;
    return stream->depth == SESSION_DEPTH_NEW && stream->half < 2 ? frame->depth[stream->half] : NULL;
}

static struct wire_depth depth_header(const struct stream *stream)
{
    const struct frame *frame = stream->sending->packet->frame;
    struct wire_depth out = grid_now(stream)->wire;
    out.seq = stream->seq;
    out.flags |= stream->half == 0 && frame->depth[1] ? WIRE_DEPTH_MORE : 0;
    out.x_px = stream->half == 0 ? 0 : (uint16_t)view_left_px(&frame->view);
    out.full_width_px = (uint16_t)frame->width_px;
    out.full_height_px = (uint16_t)frame->height_px;
    return out;
}

static bool write_depth(struct server_context *server, struct stream *stream)
{
    const struct depth_grid *grid = grid_now(stream);
    uint8_t *out = server->out + LWS_PRE;
    size_t head = 0, left = grid->wire.payload_bytes - stream->sent;
    enum lws_write_protocol how = stream->sent ? LWS_WRITE_CONTINUATION : LWS_WRITE_BINARY;
    if (stream->sent == 0) {
        struct wire_depth header = depth_header(stream);
        wire_put_depth(&header, out);
        head = WIRE_DEPTH_HEADER_BYTES;
    }
    size_t slice = left < SLICE_BYTES - head ? left : SLICE_BYTES - head;
    if (slice < left)
        how |= LWS_WRITE_NO_FIN;
    memcpy(out + head, grid->payload + stream->sent, slice);
    bool good = lws_write(stream->wsi, out, head + slice, how) >= (int)(head + slice);
    counter_inc(server->counters.depth_bytes, (int64_t)(head + slice));
    session_wrote(stream->session, false, clock_mono_ns());
    stream->sent += slice;
    if (slice == left) {
        stream->sent = 0;
        stream->half++;
    }
    return good;
}

/* --- frames ----------------------------------------------------------------------------------------------------------- */

static void part_sent(struct server_context *server, struct stream *stream)
{
    if (!is_last_part(stream)) {
        next_part(stream);
        return;
    }
    counter_inc(server->counters.frames, 1);
    encoded_frame_destroy(&stream->sending);
}

/* Puts the frame's header in front of the first payload bytes, so that one write sends both: a separate write would cost a
   system call and a network packet. */
static size_t put_header(const struct server_context *server, struct stream *stream, uint8_t *bytes)
{
    struct wire_frame head = frame_header(server, stream);
    wire_put_frame(&head, bytes);
    stream->step = SEND_PAYLOAD;
    return WIRE_FRAME_HEADER_BYTES;
}

static bool write_slice(struct server_context *server, struct stream *stream)
{
    const struct packet *packet = packet_now(stream);
    const struct packet_part *part = &packet->parts[stream->part];
    uint8_t *out = server->out + LWS_PRE;
    enum lws_write_protocol how = stream->step == SEND_HEADER ? LWS_WRITE_BINARY : LWS_WRITE_CONTINUATION;
    size_t head = stream->step == SEND_HEADER ? put_header(server, stream, out) : 0;
    size_t left = part->count - stream->sent, slice = left < SLICE_BYTES - head ? left : SLICE_BYTES - head;
    if (slice < left)
        how |= LWS_WRITE_NO_FIN;
    memcpy(out + head, packet->bytes + part->begin + stream->sent, slice);
    bool good = lws_write(stream->wsi, out, head + slice, how) >= (int)(head + slice);
    stream->sent += slice;
    stream->sent_all += slice;
    session_wrote(stream->session, slice == left && is_last_part(stream), clock_mono_ns());
    counter_inc(server->counters.frame_bytes, (int64_t)(head + slice));
    if (slice == left)
        part_sent(server, stream);
    return good;
}

static bool write_frame(struct server_context *server, struct stream *stream)
{
    if (stream->step == SEND_MARKERS) {
        bool wrote, good = write_markers(server, stream, &wrote);
        stream->step = SEND_DEPTH;
        if (wrote)
            return good;
    }
    if (stream->step == SEND_DEPTH && grid_now(stream))
        return write_depth(server, stream);
    if (stream->step == SEND_DEPTH)
        stream->step = SEND_HEADER;
    return write_slice(server, stream);
}

/* --- frames whose remaining bytes are not sent ------------------------------------------------------------------------ */

void stream_give_up(struct server_context *server, struct stream *stream, int64_t now_ns)
{
    if (!stream->sending || stream->step != SEND_PAYLOAD ||
        !session_gives_up(stream->session, stream->sending, encoded_frame_bytes(stream->sending) - stream->sent_all, now_ns))
        return;
    session_gave_up(stream->session);
    counter_inc(server->counters.given_up, 1);
    stream->cut = true;
    encoded_frame_destroy(&stream->sending);
}

/* Ends the WebSocket message of a frame that was cut short; the message then has fewer bytes than the frame's header announces.
   Returns false if the connection is gone. */
static bool write_end(struct server_context *server, struct stream *stream)
{
    stream->cut = false;
    session_wrote(stream->session, true, clock_mono_ns());
    return net_write(server, stream->wsi, "", 0, LWS_WRITE_CONTINUATION);
}

/* --- round trips ------------------------------------------------------------------------------------------------------ */

/* Returns whether a WebSocket ping is due. Pings are sent only between frames: a pong behind a frame would measure the frame's
   transfer, not the round trip. */
static bool ping_due(const struct stream *stream, int64_t now_ns)
{
    const struct pacer *pacer = &stream->session->delivery.pacer;
    bool first = stream->first == FIRST_TEXTS && stream->first_bytes > 0 && !session_has_text(stream->session, now_ns);
    if (stream->sending || stream->ping != stream->pong || pacer->flight_count > 0)
        return false;
    return stream->ping == 0 || first || (pacer->acked.sent_ns > stream->ping_ns && now_ns - stream->ping_ns >= PING_NS);
}

static bool write_ping(struct server_context *server, struct stream *stream, int64_t now_ns)
{
    stream->ping++;
    if (stream->first == FIRST_TEXTS && stream->first_bytes > 0)
        stream->first = FIRST_PING;
    stream->ping_ns = now_ns;
    return net_write(server, stream->wsi, &stream->ping, sizeof(stream->ping), LWS_WRITE_PING);
}

void stream_on_pong(struct stream *stream, const void *bytes, size_t count)
{
    uint64_t number;
    int64_t now_ns = clock_mono_ns();
    if (count != sizeof(number))
        return;
    memcpy(&number, bytes, sizeof(number));
    if (number != stream->ping || stream->pong == stream->ping)
        return;
    stream->pong = stream->ping;
    if (stream->first == FIRST_PING) {
        session_begin(stream->session, stream->first_bytes, now_ns - stream->first_ns);
        stream->first = FIRST_DONE;
    } else {
        session_on_pong(stream->session, now_ns - stream->ping_ns, now_ns);
    }
}

/* --- one write at a time ---------------------------------------------------------------------------------------------- */

bool stream_has_output(const struct stream *stream, int64_t now_ns)
{
    return stream->sending || stream->cut || session_has_frame(stream->session) || session_has_text(stream->session, now_ns) ||
           ping_due(stream, now_ns);
}

static void note_first(struct stream *stream, size_t bytes, int64_t now_ns)
{
    if (!stream->first_bytes)
        stream->first_ns = now_ns;
    if (stream->first == FIRST_TEXTS)
        stream->first_bytes += bytes;
}

/* Texts are sent only between two frames, never between the parts of one frame. */
bool stream_send(struct server_context *server, struct stream *stream)
{
    struct session *session = stream->session;
    struct text text = { 0 };
    bool good = true;
    int64_t now_ns = clock_mono_ns();
    stream_give_up(server, stream, now_ns);
    if (stream->cut)
        return write_end(server, stream);
    if (stream->sending)
        return write_frame(server, stream);
    if (ping_due(stream, now_ns))
        return write_ping(server, stream, now_ns);
    padded(&text);
    if (session_tags_due(session, now_ns))
        net_refresh_readings(server);
    if (session_next_text(session, now_ns, clock_plant_ns(server->params.plant.clock), &text)) {
        note_first(stream, text.length, now_ns);
        good = write_text(stream, text.at + LWS_PRE, text.length - LWS_PRE);
    } else if ((stream->sending = session_next_frame(session, now_ns, &stream->seq, &stream->depth))) {
        latency_stages_sent(&server->latency, stream->sending, now_ns);
        stream->step = SEND_MARKERS;
        stream->sent = stream->sent_all = 0;
        stream->packet = stream->part = stream->half = 0;
        good = write_frame(server, stream);
    }
    text_finish(&text);
    return good;
}
