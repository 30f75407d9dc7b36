/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A client without a screen. */
#include "viewer.h"

#include <jansson.h>
#include <libwebsockets.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"
#include "decoder.h"
#include "protocol/wire.h"

enum { CAMERA_HZ = 60, MAX_MESSAGE_BYTES = WIRE_MAX_PAYLOAD_BYTES + WIRE_FRAME_HEADER_BYTES, SENT_RING = 4096, MAX_ACKS = 8 };
static const double TURN_DEG_PER_S = 30;
static const int64_t PATIENCE_NS = 20 * NS_PER_S; /* for the first frame, and between frames of an orbit */

struct viewer {
    struct viewer_params params;
    struct viewer_result result;
    struct lws_context *context;
    struct lws *wsi;
    lws_sorted_usec_list_t timer;
    struct decoder *decoder;
    int64_t decode_ns; /* of the parts of a picture so far */
    struct text in;
    bool greeted, welcomed, camera_due, done;
    double eye[3], target[3], fov_deg;
    uint32_t camera_seq, shown_camera_seq;
    int64_t sent_ns[SENT_RING], begin_ns;
    struct {
        uint32_t seq;
        double decode_ms;
    } acks[MAX_ACKS];
    int ack_count;
};

static void add(struct samples *samples, double ms)
{
    mem_grow(&samples->at, &samples->capacity, samples->count + 1, sizeof(*samples->at));
    samples->at[samples->count++] = ms;
}

static void fail(struct viewer *viewer, const char *why)
{
    if (!viewer->result.failure[0])
        snprintf(viewer->result.failure, sizeof(viewer->result.failure), "%s", why);
    viewer->done = true;
}

/* --- what comes --------------------------------------------------------------------------------------------------------------- */

static void read_vector(const json_t *o, const char *name, double v[3])
{
    for (size_t i = 0; i < 3; i++)
        v[i] = json_number_value(json_array_get(json_object_get(o, name), i));
}

static void on_text(struct viewer *viewer)
{
    json_t *o = json_loadb(viewer->in.at, viewer->in.length, 0, NULL);
    const char *type = json_string_value(json_object_get(o, "type"));
    if (type && !strcmp(type, "welcome")) {
        const json_t *home = json_object_get(json_object_get(o, "plant"), "home");
        read_vector(home, "eye", viewer->eye);
        read_vector(home, "target", viewer->target);
        viewer->fov_deg = json_number_value(json_object_get(home, "fov"));
        viewer->welcomed = true;
    } else if (type && !strcmp(type, "error")) {
        viewer->result.errors++;
        const char *text = json_string_value(json_object_get(o, "text"));
        if (!viewer->welcomed)
            fail(viewer, text ? text : "an error without a text");
    }
    json_decref(o);
}

/* Every camera that was sent counts, those too that were overtaken before they were drawn: their sender has waited until now. */
static void record_input(struct viewer *viewer, uint32_t camera_seq, int64_t now_ns)
{
    if (camera_seq > viewer->camera_seq) /* never sent */
        return;
    for (; viewer->shown_camera_seq < camera_seq; viewer->shown_camera_seq++)
        if (viewer->camera_seq - viewer->shown_camera_seq <= SENT_RING)
            add(&viewer->result.input, (double)(now_ns - viewer->sent_ns[(viewer->shown_camera_seq + 1) % SENT_RING]) / 1e6);
}

static void record(struct viewer *viewer, const struct wire_frame *frame, int64_t now_ns)
{
    struct viewer_result *result = &viewer->result;
    const uint32_t stages_us[] = { frame->wait_us, frame->field_us, frame->render_us, frame->encode_us };
    for (int i = 0; i < STAGE_DECODE; i++)
        add(&result->stages[i], stages_us[i] / 1000.0);
    add(&result->stages[STAGE_DECODE], (double)viewer->decode_ns / 1e6);
    if (!result->frames) {
        result->first_ns = now_ns;
        add(&result->first, (double)(now_ns - viewer->begin_ns) / 1e6);
    }
    result->frames++;
    result->still_frames += (frame->flags & WIRE_FLAG_STILL) != 0;
    result->last_ns = now_ns;
    record_input(viewer, frame->camera_seq, now_ns);
}

/* Shorter than its header says. */
static bool is_given_up(const uint8_t *bytes, size_t count)
{
    uint32_t payload = 0;
    for (int i = 3; count >= WIRE_FRAME_HEADER_BYTES && i >= 0; i--)
        payload = payload << 8 | bytes[4 + i];
    return payload > count - WIRE_FRAME_HEADER_BYTES && payload <= WIRE_MAX_PAYLOAD_BYTES;
}

static void on_frame(struct viewer *viewer)
{
    struct wire_frame frame;
    const uint8_t *bytes = (const uint8_t *)viewer->in.at;
    int64_t begin_ns = clock_mono_ns();
    if (is_given_up(bytes, viewer->in.length)) {
        viewer->result.given_up++;
        viewer->decode_ns = 0;
        return;
    }
    if (!wire_get_frame(bytes, viewer->in.length, &frame)) {
        fail(viewer, "a binary message is no frame of " WIRE_SUBPROTOCOL);
        return;
    }
    if (!decoder_decode(viewer->decoder, &frame, bytes + WIRE_FRAME_HEADER_BYTES)) {
        fail(viewer, "a frame cannot be decoded");
        return;
    }
    int64_t now_ns = clock_mono_ns();
    viewer->result.bytes += frame.payload_bytes + WIRE_FRAME_HEADER_BYTES;
    viewer->decode_ns += now_ns - begin_ns;
    if (frame.flags & WIRE_FLAG_MORE)
        return;
    record(viewer, &frame, now_ns);
    if (viewer->ack_count < MAX_ACKS) {
        viewer->acks[viewer->ack_count].seq = frame.seq;
        viewer->acks[viewer->ack_count++].decode_ms = (double)viewer->decode_ns / 1e6;
    }
    viewer->decode_ns = 0;
    lws_callback_on_writable(viewer->wsi);
}

static void count_bytes(struct viewer *viewer, bool binary)
{
    struct viewer_result *result = &viewer->result;
    int64_t count = (int64_t)viewer->in.length;
    if (!binary)
        result->text_bytes += count;
    if (result->frames && clock_mono_ns() - result->first_ns >= VIEWER_SETTLES_S * NS_PER_S)
        result->steady_bytes += count;
}

static int on_receive(struct viewer *viewer, struct lws *wsi, const void *bytes, size_t count)
{
    if (viewer->in.length + count > MAX_MESSAGE_BYTES) {
        fail(viewer, "a message without end");
        return -1;
    }
    text_add_bytes(&viewer->in, bytes, count);
    if (lws_remaining_packet_payload(wsi) > 0 || !lws_is_final_fragment(wsi))
        return 0;
    if (lws_frame_is_binary(wsi))
        on_frame(viewer);
    else
        on_text(viewer);
    count_bytes(viewer, lws_frame_is_binary(wsi));
    viewer->in.length = 0;
    return viewer->done ? -1 : 0;
}

/* --- what goes ---------------------------------------------------------------------------------------------------------------- */

static int say(struct lws *wsi, const char *fmt, ...) __attribute__((format(printf, 2, 3)));
static int say(struct lws *wsi, const char *fmt, ...)
{
    unsigned char buffer[LWS_PRE + 512];
    va_list ap;
    va_start(ap, fmt);
    int count = vsnprintf((char *)buffer + LWS_PRE, sizeof(buffer) - LWS_PRE, fmt, ap);
    va_end(ap);
    return lws_write(wsi, buffer + LWS_PRE, (size_t)count, LWS_WRITE_TEXT) < count ? -1 : 0;
}

static int say_camera(struct viewer *viewer)
{
    int64_t now_ns = clock_mono_ns();
    double angle = (viewer->params.start_deg + TURN_DEG_PER_S * (double)(now_ns - viewer->begin_ns) / 1e9) * M_PI / 180;
    double dx = viewer->eye[0] - viewer->target[0], dy = viewer->eye[1] - viewer->target[1];
    viewer->camera_due = false;
    viewer->sent_ns[++viewer->camera_seq % SENT_RING] = now_ns;
    return say(viewer->wsi, "{\"type\":\"camera\",\"seq\":%u,\"eye\":[%.6f,%.6f,%.6f],\"target\":[%.6f,%.6f,%.6f],\"fov\":%.3f}",
               viewer->camera_seq, viewer->target[0] + dx * cos(angle) - dy * sin(angle),
               viewer->target[1] + dx * sin(angle) + dy * cos(angle), viewer->eye[2], viewer->target[0], viewer->target[1],
               viewer->target[2], viewer->fov_deg);
}

static int on_writable(struct viewer *viewer)
{
    int status = 0;
    if (!viewer->greeted) {
        viewer->greeted = true;
        status = say(viewer->wsi, "{\"type\":\"hello\",\"width\":%d,\"height\":%d,\"codecs\":[\"%s\"]}", viewer->params.width_px,
                     viewer->params.height_px, viewer->params.codec);
    } else if (viewer->ack_count > 0) {
        status = say(viewer->wsi, "{\"type\":\"ack\",\"seq\":%u,\"decode_ms\":%.3f}", viewer->acks[0].seq, viewer->acks[0].decode_ms);
        viewer->ack_count--;
        memmove(viewer->acks, viewer->acks + 1, (size_t)viewer->ack_count * sizeof(viewer->acks[0]));
    } else if (viewer->camera_due) {
        status = say_camera(viewer);
    }
    if (viewer->ack_count > 0 || viewer->camera_due)
        lws_callback_on_writable(viewer->wsi);
    return status;
}

static void on_timer(lws_sorted_usec_list_t *sul)
{
    struct viewer *viewer = lws_container_of(sul, struct viewer, timer);
    int64_t now_ns = clock_mono_ns(), since_ns = viewer->result.frames ? viewer->result.last_ns : viewer->begin_ns;
    if (viewer->result.frames && (double)(now_ns - viewer->result.first_ns) >= viewer->params.seconds * 1e9)
        viewer->done = true;
    else if (now_ns - since_ns > PATIENCE_NS && (!viewer->result.frames || viewer->params.motion == MOTION_ORBIT))
        fail(viewer, "no frame for 20 s");
    if (viewer->wsi && viewer->welcomed && viewer->params.motion == MOTION_ORBIT) {
        viewer->camera_due = true;
        lws_callback_on_writable(viewer->wsi);
    }
    lws_sul_schedule(viewer->context, 0, sul, on_timer, LWS_US_PER_SEC / CAMERA_HZ);
}

static int on_event(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in, size_t len)
{
    struct viewer *viewer = user;
    switch (reason) {
    case LWS_CALLBACK_CLIENT_CONNECTION_ERROR: fail(viewer, in ? (const char *)in : "no connection"); break;
    case LWS_CALLBACK_CLIENT_ESTABLISHED:
        viewer->wsi = wsi;
        lws_callback_on_writable(wsi);
        break;
    case LWS_CALLBACK_CLIENT_RECEIVE: return on_receive(viewer, wsi, in, len);
    case LWS_CALLBACK_CLIENT_WRITEABLE: return viewer->done ? -1 : on_writable(viewer);
    case LWS_CALLBACK_CLIENT_CLOSED:
        viewer->wsi = NULL;
        if (!viewer->done)
            fail(viewer, "the daemon closed the connection");
        break;
    default: break;
    }
    return 0;
}

/* --- life --------------------------------------------------------------------------------------------------------------------- */

struct viewer *viewer_create(const struct viewer_params *params)
{
    static const struct lws_protocols protocols[] = {
        { .name = WIRE_SUBPROTOCOL, .callback = on_event, .rx_buffer_size = 64 * 1024 },
        { 0 },
    };
    struct lws_context_creation_info info = {
        .port = CONTEXT_PORT_NO_LISTEN,
        .protocols = protocols,
        .gid = -1,
        .uid = -1,
        .pt_serv_buf_size = 64 * 1024,
    };
    struct viewer *viewer = mem_new(sizeof(*viewer));
    viewer->params = *params;
    viewer->decoder = decoder_create();
    lws_set_log_level(0, NULL);
    viewer->context = lws_create_context(&info);
    if (!viewer->context || !viewer->decoder)
        viewer_destroy(&viewer);
    return viewer;
}

void viewer_run(struct viewer *viewer)
{
    const struct daemon_url *url = viewer->params.url;
    struct lws_client_connect_info connect = {
        .context = viewer->context,
        .address = url->host,
        .host = url->host,
        .port = url->port,
        .path = "/stream",
        .protocol = WIRE_SUBPROTOCOL,
        .userdata = viewer,
    };
    viewer->begin_ns = clock_mono_ns();
    if (!lws_client_connect_via_info(&connect))
        fail(viewer, "no connection");
    on_timer(&viewer->timer);
    while (!viewer->done)
        lws_service(viewer->context, 0);
}

const struct viewer_result *viewer_result(const struct viewer *viewer)
{
    return &viewer->result;
}

void viewer_destroy(struct viewer **viewer_ptr)
{
    struct viewer *viewer = *viewer_ptr;
    if (!viewer)
        return;
    viewer->done = true;
    lws_sul_cancel(&viewer->timer);
    if (viewer->context)
        lws_context_destroy(viewer->context);
    decoder_destroy(&viewer->decoder);
    mem_free(viewer->result.input.at);
    mem_free(viewer->result.first.at);
    for (int i = 0; i < STAGE_COUNT; i++)
        mem_free(viewer->result.stages[i].at);
    text_finish(&viewer->in);
    mem_free(viewer);
    *viewer_ptr = NULL;
}
