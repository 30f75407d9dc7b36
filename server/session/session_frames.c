/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decides which frames a session requests next, and what to do with frames that arrive from the render service. */
#include <math.h>

#include "base/clock.h"
#include "render/depth_grid.h"
#include "session/reply/reply.h"
#include "session/session_impl.h"

/* time in nanoseconds without camera movement after which a refined (detailed) frame is due; until then, previews are sent */
static const int64_t STILL_NS = 200 * NS_PER_MS;
/* used instead of STILL_NS while the render thread is overloaded or the network is slow: time in nanoseconds without a request
   for a preview after which a refined frame is due */
static const int64_t LOADED_STILL_NS = 1000 * NS_PER_MS;
/* age in nanoseconds of the last refined frame at which another one is requested although previews continue; applies while the
   render thread is overloaded or the network is slow */
static const int64_t LOADED_SHARE_NS = 3 * NS_PER_S;
/* maximum time in nanoseconds by which a refined (detailed) frame is postponed while the cameras of other sessions move */
static const int64_t MAX_POSTPONE_NS = 10 * NS_PER_S;
/* expected transfer time, in nanoseconds, above which a refined frame is sent twice: first as a draft of low quality, then in
   full quality */
static const int64_t SLOW_STILL_NS = 500 * NS_PER_MS;
/* delay in nanoseconds after a draft (refined frame in low quality) before the same frame is sent in full quality */
static const int64_t FULL_QUALITY_DELAY_NS = 1000 * NS_PER_MS;
/* maximum time in nanoseconds that the first frame waits for the first bandwidth measurement */
static const int64_t MAX_START_WAIT_NS = 1000 * NS_PER_MS;
/* nanoseconds. If the view changes while a refined frame is being sent, and sending the rest of the frame would take longer
   than this, the rest is not sent. */
static const int64_t GIVE_UP_NS = 100 * NS_PER_MS;
/* nanoseconds before repeating the request for a frame that failed for lack of memory */
static const int64_t RETRY_DELAY_NS = 2000 * NS_PER_MS;
/* assumed ratio of the bytes of a refined (detailed) frame to those of a preview, until a refined frame was sent */
static const double STILL_OVER_MOVING = 3;
static const struct encoder_params STILL = { .quality = 92, .full_chroma = true }, DRAFT = { .quality = 42 };
static const struct encoder_params LOSSLESS = { .quality = 100, .full_chroma = true };
/* maximum time in nanoseconds between two camera messages of one and the same movement */
static const int64_t CAMERA_INTERVAL_NS = 120 * NS_PER_MS;
/* a side of a picture that has at most this many pixels is not reduced further when the quality ladder
   (pacing/quality_ladder.h) reduces the picture */
enum { SMALL_PX = 128 };

/* Handles the answer that the requested frame could not be drawn. A session that already shows a frame keeps it. A new session
   is closed, because it would show nothing. */
static void on_failure(struct session *session, const struct frame_request *request)
{
    struct message_error error = { 0 };
    if (session->delivery.newest_number == 0) {
        session_close(session, 1013, "out of memory for another picture: try again later, or request a smaller picture");
        return;
    }
    session->demand.refined = REFINED_NOT;
    session->demand.failed_ns = request->asked_ns;
    if (session->demand.failure_said)
        return;
    session->demand.failure_said = true;
    message_refuse(&error, "no_picture", NULL, REFUSAL_MEMORY);
    session_reply_error(session, &error);
}

/* Notes whether the shown picture now has full quality. The frame that arrived need not be the newest request: it may be a preview sent
   in place of a refined frame, or a refined frame requested before a reading changed. */
static void note_refined(struct session *session, const struct frame_request *request)
{
    struct view view = session_shown(session);
    view.tier = request->view.tier;
    if (request->view.tier == TIER_REFINED && !request->draft && !session->demand.input && view_equal(&view, &request->view))
        session->demand.refined = REFINED_FULL;
}

/* Returns whether the render service's answer "nothing new" must be ignored, because the client wants the refined frame but the
   newest frame that came is a preview. Otherwise that preview would stay until the view or a reading changes. */
static bool is_lost(const struct session *session, const struct encoded_frame *encoded, bool late)
{
    const struct frame_demand *demand = &session->demand;
    return !encoded->packet && encoded->absence != FRAME_FAILED && !late && encoded->request.view.tier == TIER_REFINED &&
           demand->refined == REFINED_FULL && !demand->input && session->delivery.pacer.asked == 1 && session->delivery.newest_number > 0 &&
           !session->delivery.newest_refined;
}

void session_on_frame(struct session *session, struct encoded_frame *encoded)
{
    session->demand.refining &= encoded->request.urgency != URGENCY_REFINE && session->delivery.pacer.asked > 1;
    if (!encoded->packet && encoded->absence == FRAME_FAILED)
        on_failure(session, &encoded->request);
    bool late = encoded->number < session->delivery.newest_number;
    /* The client now shows a preview, so the refined frame is wanted again. That also holds if a refined frame arrived while
       the preview was being drawn, and if the answer has no packet because the preview equals the picture that the client
       shows. */
    if (encoded->request.view.tier == TIER_PREVIEW && !late)
        session->demand.refined = REFINED_NOT;
    if (is_lost(session, encoded, late)) {
        session->demand.refined = REFINED_NOT;
        session->demand.lost = true;
        session->demand.failed_ns = encoded->request.asked_ns;
    }
    if (!encoded->packet || late) {
        session->stats.dropped += late;
        if (session_is_tile(session) && !encoded->packet && encoded->absence == FRAME_UNCHANGED && !late)
            session_tile_unchanged(session, encoded->request.picture);
        pacer_dropped(&session->delivery.pacer, session_times(&encoded->request));
        encoded_frame_destroy(&encoded);
        return;
    }
    session->delivery.newest_number = encoded->number;
    session->delivery.newest_refined = encoded->packet->frame->view.tier == TIER_REFINED;
    if (encoded->request.view.tier == TIER_PREVIEW)
        session->demand.preview_ns = encoded->request.asked_ns;
    note_refined(session, &encoded->request);
    if (session_is_tile(session))
        session_tile_came(session, &encoded->request, encoded->made_ns);
    /* drops the frames that are ready but not sent yet, because the new frame decodes without them and replaces them */
    if (encoded_frame_stands_alone(encoded))
        session_drop_ready(session);
    struct encoded_frame **last = &session->delivery.ready;
    while (*last)
        last = &(*last)->next;
    *last = encoded;
}

void session_on_data(struct session *session, int64_t data_ns)
{
    if (!session->demand.data)
        session->demand.data_ns = data_ns;
    session->demand.data = session->owed.tags = true;
}

/* --- requests --------------------------------------------------------------------------------------------------------- */

/* Returns whether the network would take longer than SLOW_STILL_NS to carry a refined (detailed) frame. */
static bool is_slow(const struct session *session)
{
    double bytes =
        session->demand.refined_bytes > 0 ? session->demand.refined_bytes : STILL_OVER_MOVING * session->delivery.pacer.ladder.unit_bytes;
    return pacer_is_slower(&session->delivery.pacer, bytes, SLOW_STILL_NS);
}

static bool is_calm(const struct session *session, int64_t now_ns)
{
    int64_t last_ns = session->demand.preview_ns > session->demand.refined_ns ? session->demand.preview_ns : session->demand.refined_ns;
    return session->delivery.pacer.flight_count == 0 && !session->demand.data && now_ns - last_ns >= FULL_QUALITY_DELAY_NS;
}

static bool refine_due(const struct session *session, int64_t now_ns)
{
    const struct session_context *context = session->context;
    bool others_move = now_ns < context->load.moving_until_ns && now_ns - session->demand.input_ns < MAX_POSTPONE_NS;
    bool short_of = context->load.overloaded || is_slow(session);
    bool data_moves =
        short_of && now_ns - session->demand.preview_ns < LOADED_STILL_NS && now_ns - session->demand.refined_ns < LOADED_SHARE_NS;
    bool failed = session->demand.failed_ns && now_ns - session->demand.failed_ns < RETRY_DELAY_NS;
    if (session->demand.refined == REFINED_FULL || session->delivery.pacer.asked > 0 || others_move || data_moves || failed)
        return false;
    return session->demand.refined == REFINED_DRAFT ? is_calm(session, now_ns) : now_ns - session->demand.input_ns >= STILL_NS;
}

/* Returns whether the render thread has time for a refined frame of every session after each change of readings: no camera
   moves, and the thread is not overloaded. */
static bool all_can_be_refined(const struct session *session, int64_t now_ns)
{
    return !session->context->load.overloaded && now_ns >= session->context->load.moving_until_ns;
}

/* Returns a side of a reduced frame. Rounds to the nearest even number, so that the frame keeps the shape of the view. */
static int scaled(int px, double scale)
{
    int less = 2 * (int)lround(px * scale / 2);
    return scale < 1 && px > SMALL_PX && less < px ? less : px;
}

static void make_moving(const struct session *session, struct frame_request *request)
{
    const struct quality_ladder *ladder = &session->delivery.pacer.ladder;
    int step = quality_ladder_step(ladder, session->delivery.common_step);
    struct rung rung = quality_ladder_rung(ladder, step);
    request->view.tier = TIER_PREVIEW;
    request->view.width_px = scaled(request->view.width_px, rung.scale);
    request->view.height_px = scaled(request->view.height_px, rung.scale);
    request->quality = (struct encoder_params){ .quality = rung.quality };
    request->step = step;
    request->scale = rung.scale;
}

static void make_still(const struct session *session, struct frame_request *request)
{
    request->view.tier = TIER_REFINED;
    request->urgency = URGENCY_REFINE;
    request->draft = session->demand.refined == REFINED_NOT && is_slow(session) && !session->codec.signed_frames;
    request->quality = request->draft ? DRAFT : STILL;
}

/* Fills in a request for a refined frame that shows changed readings. request->or_moving permits the render service to draw a
   preview instead, unless refining is as quick. It is set while the render thread is too slow to refine the frames of all
   sessions, or another request of this session is open. A refined frame can take a minute, for example while lighting is baked;
   render_thread_next.c then shows a preview once readings have waited too long. */
static void make_refreshed(const struct session *session, int64_t now_ns, struct frame_request *request)
{
    const struct quality_ladder *ladder = &session->delivery.pacer.ladder;
    request->view.tier = TIER_REFINED;
    request->quality = STILL;
    request->or_moving = !all_can_be_refined(session, now_ns) || session->delivery.pacer.asked > 0;
    request->step = quality_ladder_step(ladder, session->delivery.common_step);
    request->scale = 1; /* choose_other() in render_thread.c draws the preview in the view's full size, whatever the step */
    request->moving_quality.quality = quality_ladder_rung(ladder, request->step).quality;
}

/* Returns whether the camera moves, so that a frame is needed soon in any case. That frame will also show the new readings,
   which then need no frame of their own. */
static bool next_camera_brings(const struct session *session, int64_t now_ns)
{
    return session->demand.refined == REFINED_NOT && now_ns - session->demand.input_ns < CAMERA_INTERVAL_NS;
}

static bool wants(const struct session *session, int64_t now_ns, struct frame_request *request)
{
    if (session->demand.input || session->demand.any) {
        request->urgency = URGENCY_INPUT;
        request->always = request->alone = session->demand.any;
        request->view.input_ns = session->demand.input_ns;
        make_moving(session, request);
    } else if (refine_due(session, now_ns)) {
        request->view.input_ns = now_ns;
        /* sends a refined frame after a draft even if its content equals the picture that the client shows, because its quality
           is better */
        request->always = session->demand.refined == REFINED_DRAFT || session->demand.lost;
        request->alone = session->demand.lost;
        make_still(session, request);
    } else if (session->demand.data && !next_camera_brings(session, now_ns)) {
        request->view.input_ns = session->demand.data_ns;
        request->of_data = true;
        request->urgency = URGENCY_DATA;
        if (session->demand.refined == REFINED_FULL && !is_slow(session))
            make_refreshed(session, now_ns, request);
        else
            make_moving(session, request);
    } else {
        return false;
    }
    return true;
}

static bool has_codec(const struct session *session, enum wire_codec codec)
{
    unsigned all = session->context->codecs ? session->context->codecs : 1u << WIRE_CODEC_JPEG | 1u << WIRE_CODEC_PNG;
    return (all & 1u << codec) != 0;
}

static bool decodes(const struct session *session, enum wire_codec codec)
{
    for (int i = 0; i < session->codec.list.count; i++)
        if (session->codec.list.at[i] == codec)
            return has_codec(session, codec);
    return false;
}

bool session_choose_codec(struct session *session, const struct codec_list *codecs, struct message_error *error)
{
    for (int i = 0; i < codecs->count; i++) {
        if (!has_codec(session, codecs->at[i]))
            continue;
        session->codec.list = *codecs;
        session->codec.current = codecs->at[i];
        session->demand.any = true;
        if (!decodes(session, WIRE_CODEC_PNG))
            session->codec.signed_frames = SIGNED_NONE;
        return true;
    }
    message_fail(error, "bad_field", "codecs: this server supports jpeg and png%s",
                 has_codec(session, WIRE_CODEC_H264) ? " and h264" : " only");
    return false;
}

bool session_choose_signed(struct session *session, enum signed_frames frames, struct message_error *error)
{
    const struct token_holder *holder = &session->identity.holder;
    if (frames && (holder->views[0] || holder->display || session_is_tile(session))) {
        message_refuse(error, "not_allowed", "signed", REFUSAL_SIGNED_DISPLAY);
        return false;
    }
    if (frames && !session->context->signing_key) {
        message_refuse(error, "bad_field", "signed", REFUSAL_SIGNED_KEY);
        return false;
    }
    if (frames && !decodes(session, WIRE_CODEC_PNG)) {
        message_fail(error, "bad_field", "signed: signed frames are PNG pictures: add png to codecs");
        return false;
    }
    session->demand.any |= session->codec.signed_frames != frames;
    session->codec.signed_frames = frames;
    session->codec.unsigned_said = false;
    return true;
}

void session_not_signed(struct session *session, const struct message_error *why)
{
    if (!session->codec.unsigned_said)
        session_reply_error(session, why);
    session->codec.unsigned_said = true;
}

void session_choose_again(struct session *session, int64_t now_ns)
{
    double ns_per_byte = session->delivery.pacer.channel.ns_per_byte;
    struct codec_facts facts = { .bytes_per_s = ns_per_byte > 0 ? NS_PER_S / ns_per_byte : 0,
                                 .cpu_free = 1 - session->context->load.cpu_used,
                                 .pixels = (long)session->view.width_px * session->view.height_px };
    if (!session->codec.list.choose || !decodes(session, WIRE_CODEC_H264) || !decodes(session, WIRE_CODEC_JPEG))
        return;
    codec_choice_update(&session->codec.choice, &facts, now_ns);
    session->codec.current = session->codec.choice.jpeg ? WIRE_CODEC_JPEG : WIRE_CODEC_H264;
}

bool session_begun(const struct session *session, int64_t now_ns)
{
    bool starts = session->demand.starting && now_ns - session->demand.starting_ns < MAX_START_WAIT_NS;
    return !starts && (!session->travel.first || session->following.leader);
}

/* Returns whether another frame may be requested. While a refined frame is still being drawn, it does not use the network. A
   frame that shows new readings may therefore be requested meanwhile, however slow the client is. */
static bool may_ask(const struct session *session, int64_t now_ns)
{
    const struct pacer *pacer = &session->delivery.pacer;
    bool only_refines = session->demand.refining && pacer->asked == 1 && pacer->flight_count == 0 && !pacer->cut;
    return !session->delivery.ready && (only_refines || pacer_may_ask(pacer, now_ns));
}

bool session_next_request(const struct session *session, int64_t now_ns, struct frame_request *request)
{
    bool may_add = may_ask(session, now_ns);
    if (!session_begun(session, now_ns) || !session->hello || session->hidden || !session_has_pixels(session) ||
        (!may_add && session->delivery.pacer.asked == 0) || !session_wants(session, now_ns, request))
        return false;
    request->only_replace = !may_add;
    return true;
}

/* If the client wants signed frames, makes this frame lossless and requests the record of what it was drawn from
   (render/frame_record.h). */
static void make_signed(const struct session *session, struct frame_request *request)
{
    enum signed_frames frames = session->codec.signed_frames;
    if (frames == SIGNED_NONE || (frames == SIGNED_REFINED && request->view.tier == TIER_PREVIEW))
        return;
    if (request->or_moving && frames == SIGNED_REFINED)
        request->moving_codec = request->codec;
    else if (request->or_moving)
        request->moving_quality = LOSSLESS;
    request->codec = WIRE_CODEC_PNG;
    request->quality = LOSSLESS;
    request->record = true;
}

bool session_wants(const struct session *session, int64_t now_ns, struct frame_request *request)
{
    *request = (struct frame_request){ .view = session_shown(session), .codec = session->codec.current, .asked_ns = now_ns };
    request->account = session->room.share ? session->room.share->account : 0;
    /* sets read_ns to 0: readings of a past instant never change, so no later change can require another request */
    request->read_ns = request->view.at_us ? 0 : session->context->readings.changed_ns;
    request->view.camera_seq = session->view.camera_seq;
    bool wanted = wants(session, now_ns, request);
    make_signed(session, request);
    request->depth = session_gets_depth(session) && !session->following.leader && !request->record;
    return wanted;
}

void session_requested(struct session *session, const struct frame_request *request, bool replaced)
{
    if (replaced)
        pacer_replaced(&session->delivery.pacer, session_times(request), request->asked_ns);
    else
        pacer_asked(&session->delivery.pacer, session_times(request), request->asked_ns);
    session->demand.refining = request->urgency == URGENCY_REFINE || (session->demand.refining && session->delivery.pacer.asked > 1);
    session->delivery.pacer.ladder.reprojects = request->depth;
    session->demand.input = session->demand.any = session->demand.data = session->tile.moved = false;
    session->demand.refined = request->view.tier != TIER_REFINED ? REFINED_NOT : request->draft ? REFINED_DRAFT : REFINED_FULL;
    if (session->demand.refined)
        session->demand.refined_ns = request->asked_ns;
    session->demand.lost &= session->demand.refined != REFINED_FULL;
}

/* --- frames in flight --------------------------------------------------------------------------------------------------- */

/* A tile (one display's part of a wall's picture) sends one frame at a time. Otherwise the message that says when to show a
   frame would wait behind the next frame. */
bool session_has_frame(const struct session *session)
{
    return session->delivery.ready && (!session_is_tile(session) || session->delivery.pacer.flight_count == 0);
}

bool session_gets_depth(const struct session *session)
{
    return session->asks_depth && !session->context->plant->display.no_reprojection && !session_is_tile(session);
}

/* Notes that the client will have this frame's depth grid. Returns false if it was sent before. */
static bool take_depth(struct session *session, const struct frame *frame)
{
    struct depth_grid **sent = session->delivery.depth;
    if (depth_grid_equal(sent[0], frame->depth[0]) && depth_grid_equal(sent[1], frame->depth[1]))
        return false;
    session_forget_depth(session);
    for (int half = 0; half < 2; half++)
        sent[half] = depth_grid_ref(frame->depth[half]);
    return true;
}

static size_t depth_bytes(const struct frame *frame)
{
    size_t bytes = 0;
    for (int half = 0; half < 2 && frame->depth[half]; half++)
        bytes += WIRE_DEPTH_HEADER_BYTES + frame->depth[half]->wire.payload_bytes;
    return bytes;
}

/* Returns whether the time for making this frame counts for the size of the session's previews. Followers have their leader's
   size, and a wall's tiles that of the wall. */
static bool counts_for_size(const struct session *session, const struct frame_request *request)
{
    return session_times(request) && !session->following.leader && !session_is_tile(session);
}

struct encoded_frame *session_next_frame(struct session *session, int64_t now_ns, uint32_t *seq, enum session_depth *depth)
{
    struct encoded_frame *encoded = session->delivery.ready;
    if (!session_has_frame(session))
        return NULL;
    const struct frame_request *request = &encoded->request;
    struct pacer_note note = { .moving = request->view.tier == TIER_PREVIEW,
                               .full = request->view.tier == TIER_REFINED && !request->draft,
                               .preview = session_times(request),
                               .counts = counts_for_size(session, request),
                               .of_data = request->of_data,
                               .step = request->step,
                               .scale = request->scale,
                               .input_ns = request->view.input_ns,
                               .made_ns = encoded->made_ns };
    const struct frame *frame = encoded->packet->frame;
    session->delivery.ready = encoded->next;
    encoded->next = NULL;
    *depth = !request->depth || !frame->depth[0] ? SESSION_DEPTH_NONE : take_depth(session, frame) ? SESSION_DEPTH_NEW : SESSION_DEPTH_SENT;
    size_t bytes = encoded_frame_bytes(encoded) + (*depth == SESSION_DEPTH_NEW ? depth_bytes(frame) : 0);
    *seq = pacer_sent(&session->delivery.pacer, bytes, &note, now_ns);
    if (session_is_tile(session))
        session_tile_sent(session, request->picture, *seq);
    return encoded;
}

void session_wrote(struct session *session, bool all, int64_t now_ns)
{
    pacer_wrote(&session->delivery.pacer, all, now_ns);
}

bool session_gives_up(const struct session *session, const struct encoded_frame *sending, size_t bytes_left, int64_t now_ns)
{
    /* never cuts an H.264 frame short: the next frame would have to be a key frame, which is larger */
    if (sending->packet->codec == WIRE_CODEC_H264)
        return false;
    if (pacer_state(&session->delivery.pacer, now_ns) != PACER_FLOWS || session->hidden)
        return true;
    bool moved = session->demand.input && sending->request.view.tier == TIER_REFINED;
    return moved && pacer_is_slower(&session->delivery.pacer, (double)bytes_left, GIVE_UP_NS);
}

/* Requests again the frame that was cut short. The render service counts that frame as shown, so the new one must be drawn even
   if its content is the same. */
void session_gave_up(struct session *session)
{
    pacer_gave_up(&session->delivery.pacer);
    session->demand.any = true;
}

void session_pause(struct session *session)
{
    if (!session->delivery.ready)
        return;
    session_drop_ready(session);
    session->demand.any = true;
}

void session_on_shown(struct session *session)
{
    const struct pacer_flight *acked = &session->delivery.pacer.acked;
    if (acked->note.full)
        session->demand.refined_bytes = (double)acked->bytes;
    session->delivery.measured = true;
}

const struct pacer *session_take_shown(struct session *session)
{
    bool measured = session->delivery.measured;
    session->delivery.measured = false;
    return measured ? &session->delivery.pacer : NULL;
}

void session_begin(struct session *session, size_t bytes, int64_t took_ns)
{
    const struct view *view = session_view(session);
    channel_on_bytes(&session->delivery.pacer.channel, bytes, took_ns);
    quality_ladder_begin(&session->delivery.pacer.ladder, &session->delivery.pacer.channel, (double)view->width_px * view->height_px);
    session->demand.starting = false;
}

void session_on_pong(struct session *session, int64_t rtt_ns, int64_t now_ns)
{
    channel_on_pong(&session->delivery.pacer.channel, rtt_ns, now_ns);
}

enum pacer_state session_state(const struct session *session, int64_t now_ns)
{
    return pacer_state(&session->delivery.pacer, now_ns);
}
