/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Receiving half of a probe's viewer (viewer_impl.h): handles the daemon's messages and records measurements. */
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"
#include "protocol/wire.h"
#include "viewer_impl.h"

enum { MAX_MESSAGE_BYTES = WIRE_MAX_PAYLOAD_BYTES + WIRE_FRAME_HEADER_BYTES };
/* longest wait for the first frame and, while the camera orbits, for each further frame; then the viewer fails */
static const int64_t FRAME_TIMEOUT_NS = 20 * NS_PER_S;

static void add_sample(struct latency_samples *samples, double ms)
{
    mem_grow(&samples->at, &samples->capacity, samples->count + 1, sizeof(*samples->at));
    samples->at[samples->count++] = ms;
}

void viewer_fail(struct viewer *viewer, const char *why)
{
    if (!viewer->result.failure[0])
        snprintf(viewer->result.failure, sizeof(viewer->result.failure), "%s", why);
    viewer->done = true;
}

/* --- receiving ---------------------------------------------------------------------------------------------------------------- */

static void read_vector(const json_t *o, const char *name, double v[3])
{
    for (size_t i = 0; i < 3; i++)
        v[i] = json_number_value(json_array_get(json_object_get(o, name), i));
}

static void lead_begin(struct viewer *viewer)
{
    struct leader *lead = viewer->params.lead;
    if (!lead || viewer->params.follows)
        return;
    pthread_mutex_lock(&lead->lock);
    lead->session = viewer->session;
    pthread_mutex_unlock(&lead->lock);
}

static void on_pong(struct viewer *viewer, int64_t server_us)
{
    int64_t rtt_ns = clock_mono_ns() - viewer->ping_ns;
    if (rtt_ns > viewer->rtt_ns)
        return;
    viewer->rtt_ns = rtt_ns;
    viewer->offset_us = server_us - (clock_utc_ns() - rtt_ns / 2) / 1000;
}

/* Returns true for a text message of a type that the measurement does not need; such messages are not parsed. */
static bool is_passed_over(const struct text *text)
{
    static const char *const types[] = { "tags", "markers" };
    for (size_t i = 0; i < sizeof(types) / sizeof(types[0]); i++) {
        char begin[32];
        int count = snprintf(begin, sizeof(begin), "{\"type\":\"%s\"", types[i]);
        if (text->length > (size_t)count && !memcmp(text->at, begin, (size_t)count))
            return true;
    }
    return false;
}

static void on_text(struct viewer *viewer)
{
    if (is_passed_over(&viewer->in))
        return;
    json_t *o = json_loadb(viewer->in.at, viewer->in.length, 0, NULL);
    const char *type = json_string_value(json_object_get(o, "type"));
    if (type && !strcmp(type, "welcome")) {
        const json_t *home = json_object_get(json_object_get(o, "plant"), "home");
        read_vector(home, "eye", viewer->eye);
        read_vector(home, "target", viewer->target);
        viewer->fov_deg = json_number_value(json_object_get(home, "fov"));
        viewer->session = (uint64_t)json_integer_value(json_object_get(o, "session"));
        viewer->welcomed = true;
        lead_begin(viewer);
    } else if (type && !strcmp(type, "pong")) {
        on_pong(viewer, json_integer_value(json_object_get(o, "time_us")));
    } else if (type && !strcmp(type, "error")) {
        viewer->result.errors++;
        const char *text = json_string_value(json_object_get(o, "text"));
        if (!viewer->welcomed)
            viewer_fail(viewer, text ? text : "the daemon sent an error message without text");
    }
    json_decref(o);
}

/* Records the latency of every camera sent up to camera_seq. If a newer camera replaced one before the server drew its picture,
   this frame counts as showing the older one, too. */
static void record_input(struct viewer *viewer, uint32_t camera_seq, int64_t now_ns)
{
    if (camera_seq > viewer->camera_seq) /* this camera was never sent */
        return;
    for (; viewer->shown_camera_seq < camera_seq; viewer->shown_camera_seq++)
        if (viewer->camera_seq - viewer->shown_camera_seq <= SENT_RING)
            add_sample(&viewer->result.input, (double)(now_ns - viewer->sent_ns[(viewer->shown_camera_seq + 1) % SENT_RING]) / 1e6);
}

/* Records the delay of a follower's frame: the time since the leading viewer sent the camera of that frame. */
static void record_behind(struct viewer *viewer, const struct wire_frame *frame, int64_t now_ns)
{
    struct leader *lead = viewer->params.lead;
    if (!viewer->followed || now_ns - viewer->result.first_ns < VIEWER_SETTLES_S * NS_PER_S)
        return;
    pthread_mutex_lock(&lead->lock);
    for (uint32_t number = lead->newest; number > 0 && lead->newest - number < LEAD_CAMERAS; number--) {
        const double *eye = lead->cameras[number % LEAD_CAMERAS].eye;
        if (fabs(eye[0] - frame->eye_m[0]) > 1e-4 || fabs(eye[1] - frame->eye_m[1]) > 1e-4)
            continue;
        add_sample(&viewer->result.behind, (double)(now_ns - lead->cameras[number % LEAD_CAMERAS].sent_ns) / 1e6);
        break;
    }
    pthread_mutex_unlock(&lead->lock);
}

/* Records a frame's network time: from when the server sent it to now, both on the server's clock. */
static void record_network(struct viewer *viewer, const struct wire_frame *frame)
{
    struct viewer_result *result = &viewer->result;
    if (viewer->rtt_ns == INT64_MAX)
        return;
    double here_us = (double)(clock_utc_ns() / 1000 + viewer->offset_us) - (double)frame->sent_time_us;
    double made_us = (double)frame->wait_us + frame->field_us + frame->render_us + frame->encode_us;
    add_sample(&result->stages[STAGE_NETWORK], fmax(here_us / 1e3 - (double)viewer->decode_ns / 1e6, 0));
    if (frame->flags & WIRE_FLAG_DATA)
        add_sample(&result->sensor, (made_us + fmax(here_us, 0)) / 1e3);
}

static void record(struct viewer *viewer, const struct wire_frame *frame, int64_t now_ns)
{
    struct viewer_result *result = &viewer->result;
    const uint32_t stages_us[] = { frame->wait_us, frame->field_us, frame->render_us, frame->encode_us };
    for (int i = 0; i < STAGE_NETWORK; i++)
        add_sample(&result->stages[i], stages_us[i] / 1000.0);
    add_sample(&result->stages[STAGE_DECODE], (double)viewer->decode_ns / 1e6);
    if (!result->frames) {
        result->first_ns = now_ns;
        add_sample(&result->first, (double)(now_ns - viewer->begin_ns) / 1e6);
    }
    result->frames++;
    result->still_frames += (frame->flags & WIRE_FLAG_STILL) != 0;
    result->last_ns = now_ns;
    record_input(viewer, frame->camera_seq, now_ns);
    record_network(viewer, frame);
    record_behind(viewer, frame, now_ns);
}

/* Saves a signed frame as FOLDER/SESSION-FRAME.png. Not possible in the load generator, which does not keep whole messages. */
static void save_signed(struct viewer *viewer, const struct wire_frame *frame, const uint8_t *png)
{
    char *path = mem_printf("%s/%03d-%06u.png", viewer->params.folder, viewer->params.number, frame->seq);
    FILE *file = fopen(path, "wb");
    bool good = file && fwrite(png, 1, frame->payload_bytes, file) == frame->payload_bytes;
    good = file && fclose(file) == 0 && good;
    if (!good)
        viewer_fail(viewer, "a signed frame cannot be written to the folder of --save-signed");
    mem_free(path);
}

static void on_frame(struct viewer *viewer)
{
    struct wire_frame frame;
    const uint8_t *bytes = (const uint8_t *)viewer->in.at;
    int64_t begin_ns = clock_mono_ns();
    if (viewer->in.length >= WIRE_FRAME_HEADER_BYTES && wire_is_given_up(bytes, viewer->in_count)) {
        viewer->result.given_up++;
        viewer->decode_ns = 0;
        return;
    }
    if (viewer->in.length < WIRE_FRAME_HEADER_BYTES || !wire_get_frame(bytes, viewer->in_count, &frame)) {
        viewer_fail(viewer, "the daemon sent a binary message that is not a frame of protocol " WIRE_SUBPROTOCOL);
        return;
    }
    if (!viewer->params.blind && !decoder_decode(viewer->decoder, &frame, bytes + WIRE_FRAME_HEADER_BYTES)) {
        viewer_fail(viewer, "a frame from the daemon cannot be decoded");
        return;
    }
    int64_t now_ns = clock_mono_ns();
    viewer->result.bytes += frame.payload_bytes + WIRE_FRAME_HEADER_BYTES;
    viewer->decode_ns += now_ns - begin_ns;
    if (frame.flags & WIRE_FLAG_MORE)
        return;
    record(viewer, &frame, now_ns);
    if (frame.flags & WIRE_FLAG_SIGNED) {
        viewer->result.signed_frames++;
        if (viewer->params.folder)
            save_signed(viewer, &frame, bytes + WIRE_FRAME_HEADER_BYTES);
    }
    if (viewer->ack_count < MAX_ACKS && !viewer->params.stalls) {
        viewer->acks[viewer->ack_count].seq = frame.seq;
        viewer->acks[viewer->ack_count++].decode_ms = (double)viewer->decode_ns / 1e6;
    }
    viewer->decode_ns = 0;
}

static void count_bytes(struct viewer *viewer, bool binary)
{
    struct viewer_result *result = &viewer->result;
    int64_t count = (int64_t)viewer->in_count;
    if (!binary)
        result->text_bytes += count;
    static const char pong[] = "{\"type\":\"pong\"";
    bool asked_for = !binary && viewer->in.length >= sizeof(pong) && !memcmp(viewer->in.at, pong, sizeof(pong) - 1);
    if (result->frames && !asked_for && clock_mono_ns() - result->first_ns >= VIEWER_SETTLES_S * NS_PER_S)
        result->steady_bytes += count;
}

void viewer_on_message(struct viewer *viewer, bool binary)
{
    if (binary)
        on_frame(viewer);
    else
        on_text(viewer);
    count_bytes(viewer, binary);
}

static int on_receive(struct viewer *viewer, struct lws *wsi, const void *bytes, size_t count)
{
    if (viewer->in.length + count > MAX_MESSAGE_BYTES) {
        viewer_fail(viewer, "the daemon sent a message of more than 64 MiB, the most that this program accepts");
        return -1;
    }
    text_add_bytes(&viewer->in, bytes, count);
    if (lws_remaining_packet_payload(wsi) > 0 || !lws_is_final_fragment(wsi))
        return 0;
    viewer->in_count = viewer->in.length;
    viewer_on_message(viewer, lws_frame_is_binary(wsi));
    viewer->in.length = 0;
    if (viewer->params.stalls && viewer->result.frames > 0)
        lws_rx_flow_control(wsi, 0);
    if (viewer_has_output(viewer))
        lws_callback_on_writable(wsi);
    return viewer->done ? -1 : 0;
}

/* --- the viewer's timer --------------------------------------------------------------------------------------------------------- */

static bool expects_frames(const struct viewer *viewer)
{
    return !viewer->result.frames || (viewer->params.motion == MOTION_ORBIT && !viewer->params.stalls);
}

void viewer_on_time(struct viewer *viewer, int64_t now_ns)
{
    int64_t since_ns = viewer->result.frames ? viewer->result.last_ns : viewer->begin_ns;
    if (viewer->result.frames && (double)(now_ns - viewer->result.first_ns) >= viewer->params.seconds * 1e9)
        viewer->done = true;
    else if (now_ns - since_ns > FRAME_TIMEOUT_NS && expects_frames(viewer))
        viewer_fail(viewer, "the daemon sent no frame for 20 s");
    else
        viewer_schedule(viewer, now_ns);
}

/* Timer callback. The timer fires on a fixed time grid, so that a late callback does not delay later ones. */
static void on_timer(lws_sorted_usec_list_t *sul)
{
    struct viewer *viewer = lws_container_of(sul, struct viewer, timer);
    int64_t now_ns = clock_mono_ns();
    viewer_on_time(viewer, now_ns);
    if (viewer->wsi && (viewer->done || viewer_has_output(viewer)))
        /* makes libwebsockets call the writable callback, which sends the due messages, or closes the connection if the viewer is done */
        lws_callback_on_writable(viewer->wsi);
    viewer->next_ns += (int64_t)(1e9 / viewer->params.hz);
    if (viewer->next_ns < now_ns)
        viewer->next_ns = now_ns;
    if (!viewer->done)
        lws_sul_schedule(viewer->context, 0, sul, on_timer, (viewer->next_ns - now_ns) / 1000 + 1);
}

static int on_writeable(struct viewer *viewer)
{
    if (viewer->done)
        return -1;
    int status = viewer_send(viewer);
    if (viewer_has_output(viewer))
        lws_callback_on_writable(viewer->wsi);
    return status;
}

static int on_event(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in, size_t len)
{
    struct viewer *viewer = user;
    switch (reason) {
    case LWS_CALLBACK_CLIENT_APPEND_HANDSHAKE_HEADER: return daemon_add_token(viewer->params.url->access, wsi, in, len);
    case LWS_CALLBACK_CLIENT_CONNECTION_ERROR: viewer_fail(viewer, in ? (const char *)in : "no connection"); break;
    case LWS_CALLBACK_CLIENT_ESTABLISHED:
        viewer->wsi = wsi;
        lws_callback_on_writable(wsi);
        break;
    case LWS_CALLBACK_CLIENT_RECEIVE: return on_receive(viewer, wsi, in, len);
    case LWS_CALLBACK_CLIENT_WRITEABLE: return on_writeable(viewer);
    case LWS_CALLBACK_CLIENT_CLOSED:
        viewer->wsi = NULL;
        if (!viewer->done && !viewer->params.stalls)
            viewer_fail(viewer, "the daemon closed the connection");
        break;
    default: break;
    }
    return 0;
}

/* --- creating and destroying -------------------------------------------------------------------------------------------------- */

const struct lws_protocols viewer_protocols[] = {
    { .name = WIRE_SUBPROTOCOL, .callback = on_event, .rx_buffer_size = 64 * 1024 },
    { 0 },
};

struct viewer *viewer_create(const struct viewer_params *params)
{
    struct viewer *viewer = mem_new(sizeof(*viewer));
    viewer->params = *params;
    viewer->rtt_ns = INT64_MAX;
    if (!params->blind && !(viewer->decoder = decoder_create()))
        viewer_destroy(&viewer);
    return viewer;
}

void viewer_prepare_context(const struct viewer *viewer, struct lws_context_creation_info *info)
{
    daemon_prepare_context(viewer->params.url, info);
}

void viewer_connect(struct viewer *viewer, struct lws_context *context)
{
    char path[sizeof(viewer->params.url->base) + 16];
    snprintf(path, sizeof(path), "%s/stream", viewer->params.url->base);
    struct lws_client_connect_info connect = {
        .context = context,
        .path = path,
        .protocol = WIRE_SUBPROTOCOL,
        .userdata = viewer,
    };
    viewer->context = context;
    viewer->begin_ns = viewer->next_ns = clock_mono_ns();
    daemon_prepare_connection(viewer->params.url, &connect);
    if (!lws_client_connect_via_info(&connect))
        viewer_fail(viewer, "no connection");
    on_timer(&viewer->timer);
}

bool viewer_done(const struct viewer *viewer)
{
    return viewer->done;
}

int64_t viewer_rests_until_ns(const struct viewer *viewer, int *fd)
{
    bool reads = !viewer->params.stalls || !viewer->result.frames;
    *fd = viewer->wsi && reads ? lws_get_socket_fd(viewer->wsi) : -1;
    return viewer->wsi && !viewer->done && !viewer_has_output(viewer) ? viewer->next_ns : 0;
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
    decoder_destroy(&viewer->decoder);
    mem_free(viewer->result.input.at);
    mem_free(viewer->result.sensor.at);
    mem_free(viewer->result.behind.at);
    mem_free(viewer->result.first.at);
    for (int i = 0; i < STAGE_COUNT; i++)
        mem_free(viewer->result.stages[i].at);
    text_finish(&viewer->in);
    mem_free(viewer);
    *viewer_ptr = NULL;
}
