/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which pictures a session wants, and what becomes of those that come. */
#include "base/clock.h"
#include "session/reply.h"
#include "session/session_impl.h"

static const int64_t STILL_NS = 200 * NS_PER_MS;         /* nothing moved for so long: refine */
static const int64_t LOADED_STILL_NS = 1000 * NS_PER_MS; /* likewise, when not all can be refined */
static const int64_t LOADED_SHARE_NS = 3 * NS_PER_S;     /* but after so long without one, however often readings change */
static const int64_t PATIENCE_NS = 10 * NS_PER_S;        /* others may move for so long before one is refined all the same */
static const int64_t SLOW_STILL_NS = 500 * NS_PER_MS;    /* refined pictures that take the network longer come in two stages */
static const int64_t CALM_NS = 1000 * NS_PER_MS;         /* the second one after so long */
static const int64_t START_NS = 1000 * NS_PER_MS;        /* the network is not waited for any longer */
static const int64_t GIVE_UP_NS = 100 * NS_PER_MS;       /* what is left of a refined picture, when its view has changed */
static const int64_t AGAIN_NS = 2000 * NS_PER_MS;        /* what there was no memory for is tried again after so long */
static const double STILL_OVER_MOVING = 3;               /* in bytes, before one was seen */
static const struct encoder_params STILL = { .quality = 92, .full_chroma = true }, DRAFT = { .quality = 42 };
static const int64_t SOON_NS = 120 * NS_PER_MS; /* cameras of one movement follow each other so soon */
enum { SMALL_PX = 128 };                        /* sides that are not made smaller */

/* The one who already has a picture keeps it; a new one would look at nothing. */
static void on_failure(struct session *session, const struct frame_request *wish)
{
    const struct view *view = &wish->view;
    struct message_error error = { 0 };
    if (session->newest_number == 0) {
        session_close(session, 1013, "no memory for another picture: try later, or a smaller one");
        return;
    }
    session->refined = REFINED_NOT;
    session->failed_ns = wish->asked_ns;
    if (session->failure_said)
        return;
    session->failure_said = true;
    message_fail(&error, "no_picture", "%dx%d cannot be drawn: the server is out of memory; the last picture stays", view->width_px,
                 view->height_px);
    session_reply_error(session, &error);
}

/* What came may be less refined than what was asked for, or more: readings overtake a refined picture, which shows them in the end. */
static void note_refined(struct session *session, const struct frame_request *wish)
{
    struct view view = session_shown(session);
    view.tier = wish->view.tier;
    if (wish->or_moving && wish->view.tier == TIER_PREVIEW)
        session->refined = REFINED_NOT;
    else if (wish->view.tier == TIER_REFINED && !wish->draft && !session->input_pending && view_equal(&view, &wish->view))
        session->refined = REFINED_FULL;
}

void session_on_frame(struct session *session, struct encoded_frame *picture)
{
    if (picture->failed)
        on_failure(session, &picture->wish);
    bool late = picture->number < session->newest_number;
    if (!picture->packet || late) {
        session->dropped += late;
        pacer_dropped(&session->pacer);
        encoded_frame_destroy(&picture);
        return;
    }
    session->newest_number = picture->number;
    if (picture->wish.view.tier == TIER_PREVIEW)
        session->moved_ns = picture->wish.asked_ns;
    note_refined(session, &picture->wish);
    if (encoded_frame_stands_alone(picture)) /* newer than what the socket has not yet taken */
        session_drop_ready(session);
    struct encoded_frame **last = &session->ready;
    while (*last)
        last = &(*last)->next;
    *last = picture;
}

void session_drop_ready(struct session *session)
{
    for (struct encoded_frame *picture = session->ready, *next; picture; picture = next) {
        next = picture->next;
        session->dropped++;
        pacer_dropped(&session->pacer);
        encoded_frame_destroy(&picture);
    }
    session->ready = NULL;
}

/* --- wishes --------------------------------------------------------------------------------------------------------------- */

/* A refined picture would hold up for long what comes after it. */
static bool is_slow(const struct session *session)
{
    double bytes = session->still_bytes > 0 ? session->still_bytes : STILL_OVER_MOVING * session->pacer.ladder.unit_bytes;
    return pacer_is_slower(&session->pacer, bytes, SLOW_STILL_NS);
}

static bool is_calm(const struct session *session, int64_t now_ns)
{
    int64_t last_ns = session->moved_ns > session->refined_ns ? session->moved_ns : session->refined_ns;
    return session->pacer.flight_count == 0 && !session->data_pending && now_ns - last_ns >= CALM_NS;
}

static bool refine_due(const struct session *session, int64_t now_ns)
{
    const struct session_context *world = session->world;
    bool others_move = now_ns < world->moving_until_ns && now_ns - session->input_ns < PATIENCE_NS;
    bool short_of = world->loaded || is_slow(session);
    bool data_moves = short_of && now_ns - session->moved_ns < LOADED_STILL_NS && now_ns - session->refined_ns < LOADED_SHARE_NS;
    bool failed = session->failed_ns && now_ns - session->failed_ns < AGAIN_NS;
    if (session->refined == REFINED_FULL || session->pacer.asked > 0 || others_move || data_moves || failed)
        return false;
    return session->refined == REFINED_DRAFT ? is_calm(session, now_ns) : now_ns - session->input_ns >= STILL_NS;
}

/* The data's picture is refined at once where all can be. */
static bool all_can_be_refined(const struct session *session, int64_t now_ns)
{
    return !session->world->loaded && now_ns >= session->world->moving_until_ns;
}

static int scaled(int px, double scale)
{
    int less = (int)(px * scale) & ~1;
    return scale < 1 && px > SMALL_PX && less < px ? less : px;
}

static void make_moving(const struct session *session, struct frame_request *wish)
{
    const struct quality_ladder *ladder = &session->pacer.ladder;
    int step = quality_ladder_step(ladder, session->common_step);
    struct rung rung = quality_ladder_rung(ladder, step);
    wish->view.tier = TIER_PREVIEW;
    wish->view.width_px = scaled(wish->view.width_px, rung.scale);
    wish->view.height_px = scaled(wish->view.height_px, rung.scale);
    wish->quality = (struct encoder_params){ .quality = rung.quality };
    wish->step = step;
}

static void make_still(const struct session *session, struct frame_request *wish)
{
    wish->view.tier = TIER_REFINED;
    wish->urgency = URGENCY_REFINE;
    wish->draft = session->refined == REFINED_NOT && is_slow(session);
    wish->quality = wish->draft ? DRAFT : STILL;
}

/* Whoever looks at a refined picture keeps it when readings change, if it is quick to colour again. */
static void make_refreshed(const struct session *session, int64_t now_ns, struct frame_request *wish)
{
    const struct quality_ladder *ladder = &session->pacer.ladder;
    wish->view.tier = TIER_REFINED;
    wish->quality = STILL;
    wish->or_moving = !all_can_be_refined(session, now_ns);
    wish->moving_quality.quality = quality_ladder_rung(ladder, quality_ladder_step(ladder, session->common_step)).quality;
}

/* A camera that moves, if not fast, brings new readings with its next picture: they need none of their own. */
static bool next_camera_brings(const struct session *session, int64_t now_ns)
{
    return session->refined == REFINED_NOT && now_ns - session->input_ns < SOON_NS;
}

static bool wants(const struct session *session, int64_t now_ns, struct frame_request *wish)
{
    if (session->input_pending || session->always_pending) {
        wish->urgency = URGENCY_INPUT;
        wish->always = wish->alone = session->always_pending;
        wish->view.input_ns = session->input_ns;
        make_moving(session, wish);
    } else if (refine_due(session, now_ns)) {
        wish->view.input_ns = now_ns;
        wish->always = session->refined == REFINED_DRAFT; /* the same, but better */
        make_still(session, wish);
    } else if (session->data_pending && !next_camera_brings(session, now_ns)) {
        wish->view.input_ns = session->data_ns;
        wish->of_data = true;
        wish->urgency = URGENCY_DATA;
        if (session->refined == REFINED_FULL && !is_slow(session))
            make_refreshed(session, now_ns, wish);
        else
            make_moving(session, wish);
    } else {
        return false;
    }
    return true;
}

static bool has_codec(const struct session *session, enum wire_codec codec)
{
    unsigned all = session->world->codecs ? session->world->codecs : 1u << WIRE_CODEC_JPEG | 1u << WIRE_CODEC_PNG;
    return (all & 1u << codec) != 0;
}

bool session_choose_codec(struct session *session, const struct codec_list *codecs, struct message_error *error)
{
    for (int i = 0; i < codecs->count; i++) {
        if (!has_codec(session, codecs->at[i]))
            continue;
        session->codecs = *codecs;
        session->codec = codecs->at[i];
        session->always_pending = true;
        return true;
    }
    message_fail(error, "bad_field", "codecs: this server has jpeg and png%s", has_codec(session, WIRE_CODEC_H264) ? " and h264" : " only");
    return false;
}

static bool decodes(const struct session *session, enum wire_codec codec)
{
    for (int i = 0; i < session->codecs.count; i++)
        if (session->codecs.at[i] == codec)
            return has_codec(session, codec);
    return false;
}

void session_choose_again(struct session *session, int64_t now_ns)
{
    double ns_per_byte = session->pacer.channel.ns_per_byte;
    struct codec_facts facts = { .bytes_per_s = ns_per_byte > 0 ? NS_PER_S / ns_per_byte : 0,
                                 .cpu_free = 1 - session->world->cpu_used,
                                 .pixels = (long)session->view.width_px * session->view.height_px };
    if (!session->codecs.choose || !decodes(session, WIRE_CODEC_H264) || !decodes(session, WIRE_CODEC_JPEG))
        return;
    codec_choice_update(&session->choice, &facts, now_ns);
    session->codec = session->choice.jpeg ? WIRE_CODEC_JPEG : WIRE_CODEC_H264;
}

bool session_next_request(const struct session *session, int64_t now_ns, struct frame_request *wish)
{
    if ((session->starting && now_ns - session->starting_ns < START_NS) || (session->travel.first && !session->leader))
        return false;
    bool may_add = !session->ready && pacer_may_ask(&session->pacer, now_ns);
    if (!session->hello || session->hidden || !session_has_pixels(session) || (!may_add && session->pacer.asked == 0))
        return false;
    *wish = (struct frame_request){ .view = session_shown(session), .codec = session->codec, .asked_ns = now_ns, .only_replace = !may_add };
    wish->payer = session->share ? session->share->payer : 0;
    wish->read_ns = wish->view.at_us ? 0 : session->world->changed_ns; /* what was does not change */
    wish->view.camera_seq = session->view.camera_seq;
    wish->view.params_seq = session->view.params_seq;
    return wants(session, now_ns, wish);
}

void session_requested(struct session *session, const struct frame_request *wish, bool replaced)
{
    if (!replaced)
        pacer_asked(&session->pacer);
    session->input_pending = session->always_pending = session->data_pending = false;
    session->refined = wish->view.tier != TIER_REFINED ? REFINED_NOT : wish->draft ? REFINED_DRAFT : REFINED_FULL;
    if (session->refined)
        session->refined_ns = wish->asked_ns;
}

/* --- on its way ----------------------------------------------------------------------------------------------------------- */

struct encoded_frame *session_next_frame(struct session *session, int64_t now_ns, uint32_t *seq)
{
    struct encoded_frame *picture = session->ready;
    if (!picture)
        return NULL;
    const struct frame_request *wish = &picture->wish;
    struct pacer_note note = { .moving = wish->view.tier == TIER_PREVIEW,
                               .full = wish->view.tier == TIER_REFINED && !wish->draft,
                               .of_data = wish->of_data,
                               .step = wish->step,
                               .input_ns = wish->view.input_ns,
                               .made_ns = picture->made_ns };
    session->ready = picture->next;
    picture->next = NULL;
    *seq = pacer_sent(&session->pacer, encoded_frame_bytes(picture), &note, now_ns);
    return picture;
}

void session_wrote(struct session *session, bool all, int64_t now_ns)
{
    pacer_wrote(&session->pacer, all, now_ns);
}

bool session_gives_up(const struct session *session, const struct encoded_frame *sending, size_t bytes_left, int64_t now_ns)
{
    if (sending->packet->codec == WIRE_CODEC_H264) /* the next would have to stand alone, and be larger */
        return false;
    if (pacer_state(&session->pacer, now_ns) != PACER_FLOWS || session->hidden)
        return true;
    bool moved = session->input_pending && sending->wish.view.tier == TIER_REFINED;
    return moved && pacer_is_slower(&session->pacer, (double)bytes_left, GIVE_UP_NS);
}

/* The render thread takes it for shown: the next is drawn whatever it shows. */
void session_gave_up(struct session *session)
{
    pacer_gave_up(&session->pacer);
    session->always_pending = true;
}

void session_pause(struct session *session)
{
    if (!session->ready)
        return;
    session_drop_ready(session);
    session->always_pending = true;
}

void session_on_shown(struct session *session)
{
    const struct pacer_flight *acked = &session->pacer.acked;
    if (acked->note.full)
        session->still_bytes = (double)acked->bytes;
    session->measured = true;
}

void session_begin(struct session *session, size_t bytes, int64_t took_ns)
{
    const struct view *view = session_view(session);
    channel_on_bytes(&session->pacer.channel, bytes, took_ns);
    quality_ladder_begin(&session->pacer.ladder, &session->pacer.channel, (double)view->width_px * view->height_px);
    session->starting = false;
}

void session_on_pong(struct session *session, int64_t rtt_ns, int64_t now_ns)
{
    channel_on_pong(&session->pacer.channel, rtt_ns, now_ns);
}

enum pacer_state session_state(const struct session *session, int64_t now_ns)
{
    return pacer_state(&session->pacer, now_ns);
}
