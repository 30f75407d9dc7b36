/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Acts on one client's messages, does its timed work and applies its limits. */
#include "session/session_impl.h"
#include "session/view/resume.h"
#include "session/view/view_token.h"

#include <math.h>
#include <stdio.h>

#include "access/pairings.h"
#include "base/clock.h"
#include "base/text/json_text.h"
#include "base/mem.h"
#include "message/note_message.h"
#include "message/views_message.h"
#include "message/wall_message.h"
#include "message/message_parse.h"
#include "message/alarm_message.h"
#include "message/fit_message.h"
#include "session/reply/reply.h"

void session_leave(struct session *session, bool keep, int64_t now_ns)
{
    session_release_pixels(session);
    if (session->following.leader)
        session->following.leader->following.followers_changed = true;
    resumes_close(session->context->resumes, session, keep, now_ns);
}

static enum role role_now(const struct session *session, int64_t now_utc_ns)
{
    const struct session_context *context = session->context;
    const struct token_holder *holder = &session->identity.holder;
    if (holder->signed_in)
        return context->sign_in.openid ? openid_role(context->sign_in.openid, holder) : ROLE_NOBODY;
    enum role role = context->sign_in.tokens ? tokens_role(context->sign_in.tokens, holder, now_utc_ns) : ROLE_NOBODY;
    return role_is_node(role) ? ROLE_NOBODY : role;
}

static void on_ping(struct session *session, const struct message *message, int64_t now_ns, int64_t now_utc_ns)
{
    session_reply(session, reply_pong_text(session_snapshot(session), message->ping.t, now_utc_ns));
    if (!message->ping.active)
        return;
    session->identity.active_ns = now_ns;
    if (session->context->sign_in.openid && session->identity.holder.signed_in)
        openid_touch(session->context->sign_in.openid, &session->identity.holder, now_ns);
}

void session_check_token(struct session *session, int64_t now_ns, int64_t now_utc_ns)
{
    bool person = session->identity.holder.signed_in;
    if (session->identity.holder.role == ROLE_NOBODY)
        return;
    struct message_error alone = { 0 };
    if (!session->close.code && session_left_alone(session, now_ns, &alone)) {
        session_reply_error(session, &alone);
        session_close(session, 1008, "locked: no input at this page for the time of --lock-after; sign in again");
        return;
    }
    enum role role = role_now(session, now_utc_ns);
    if (role != ROLE_NOBODY) {
        session->identity.role = session->identity.holder.role = role;
    } else if (!session->close.code) {
        struct message_error error = { 0 };
        enum refusal_code why = person ? REFUSAL_SIGNED_OUT : REFUSAL_TOKEN_ENDED;
        message_refuse(&error, person ? "token_needed" : "bad_token", NULL, why);
        session_reply_error(session, &error);
        session_close(session, 1008, refusal_words(why));
    }
}

/* --- input ------------------------------------------------------------------------------------------------------------ */

static void set_camera(struct session *session, const struct message *message)
{
    session->view.camera = message->camera;
    session->view.camera_seq = message->seq;
}

static bool on_params(struct session *session, const struct message *message, struct message_error *error)
{
    struct view view = session->view;
    if (message->named[0] && !session_look(session, message->named, &view, error))
        return false;
    if (message->has_new_view)
        session_look_new(session, &view);
    view.camera = session->view.camera;
    if (!session_apply_params(session, message, &view, error))
        return false;
    session->view = view;
    session->view.params_seq = session->owed.params_seq = message->params.seq;
    session_record_params(session, message);
    session->owed.params = true;
    return true;
}

static bool on_look(struct session *session, const struct message *message, struct message_error *error)
{
    if (!session_look(session, message->named, &session->view, error))
        return false;
    session_reply(session, reply_camera_text(&session->view.camera, message->seq));
    session->owed.params_seq = session->view.params_seq;
    session->owed.params = true;
    return true;
}

static bool on_resize(struct session *session, const struct message *message, struct message_error *error)
{
    if (!session_reserve_pixels(session, message->size.width_px, message->size.height_px, error))
        return false;
    session->view.width_px = message->size.width_px;
    session->view.height_px = message->size.height_px;
    if (session_is_tile(session))
        session_tile_fit(session, &session->tile.place, message->size.width_px, message->size.height_px, &session->view,
                         &session->tile.layout);
    session_scope_fit(session, &session->view);
    /* sets the named view again when the picture's size changes: if the view states no camera, its camera is computed from that
       size */
    if (session->scope.named[0] && session->identity.holder.views[0])
        return session_look(session, session->scope.named, &session->view, error);
    if (message->size.pixel_ratio > 0)
        session->pixel_ratio = message->size.pixel_ratio;
    return true;
}

static bool on_ack(struct session *session, const struct message *message, int64_t now_ns, struct message_error *error)
{
    int64_t decode_ns = message->decode_ms < 0 ? -1 : (int64_t)(message->decode_ms * NS_PER_MS);
    enum pacer_ack ack = pacer_acked(&session->delivery.pacer, message->seq, decode_ns, now_ns);
    if (ack == PACER_ACK_NEW)
        session_on_shown(session);
    if (ack != PACER_ACK_NEVER_SENT)
        return true;
    message_fail(error, "bad_field", "seq: the client acknowledged frame %u, which was never sent", message->seq);
    return false;
}

/* Answers the message `fit` with a camera that shows the requested object as a whole. The session's view does not change: the client sends
   that camera itself. */
static void on_fit(struct session *session, const struct message *message)
{
    struct camera camera = session->view.camera;
    fit_apply(session->context->services->scene, &message->fit, &session->view, &camera);
    session_reply(session, reply_camera_text(&camera, message->seq));
}

static void on_pick(struct session *session, const struct message *message)
{
    session->pick.query = (struct pick_query){ .client = session->id, .seq = message->seq, .view = session_shown(session) };
    session->pick.query.x_px = message->pick.x_px;
    session->pick.query.y_px = message->pick.y_px;
    session->pick.query.view.pixel_ratio = session->pixel_ratio;
    if (message->pick.has_camera)
        session->pick.query.view.camera = message->pick.camera;
    session->pick.pending = true;
}

bool session_next_pick(struct session *session, struct pick_query *query)
{
    bool pending = session->pick.pending;
    if (pending)
        *query = session->pick.query;
    session->pick.pending = false;
    return pending;
}

void session_on_pick(struct session *session, const struct pick_answer *answer)
{
    struct pick_answer cache = *answer;
    if (session_is_open(session)) {
        cache.pick.value = NAN;
        cache.pick.uncertain = false;
        cache.pick.drawn_error = 0;
        cache.pick.nearest_count = 0;
        cache.pick.sensor = -1;
        if (cache.pick.state == PICK_MEASURED)
            cache.pick.state = PICK_BETWEEN;
    }
    session_reply(session, reply_picked_text(session->context->plant, &cache));
}

/* Removes the name that a signed-in user put into a message: the identity provider's name is used instead. With a token the
   name stays, because several people may share a desk's token. */
static void clear_claimed_name(const struct session *session, struct message *message)
{
    if (!session->identity.holder.signed_in)
        return;
    if (message->type == MESSAGE_ALARM)
        message->alarm.name[0] = 0;
    if (message->type == MESSAGE_NOTE || message->type == MESSAGE_REMOVE_NOTE)
        message->note.name[0] = 0;
}

static bool on_alarm(struct session *session, const struct message *message, struct message_error *error)
{
    const struct session_context *context = session->context;
    if (!context->services->alarm_service || context->plant->alarms != ALARMS_LOCAL) {
        message_refuse(error, "not_allowed", NULL, REFUSAL_ELSEWHERE);
        return false;
    }
    const struct kept_action action = session_kept_begin(session);
    char *answer = alarm_do(context->services->alarm_service, context->plant, message, session_who(session));
    session_kept_reply(session, &action, "alarm", session_alarm_what(session, message), answer);
    return true;
}

static bool on_view_edit(struct session *session, const struct message *message, int64_t now_utc_ns, struct message_error *error)
{
    struct named_views *views = session->context->services->named_views;
    const char *address = message->view_edit.address;
    /* an address that was saved before may be saved again: to move the view in the list, or to restore an earlier version */
    if (message->type == MESSAGE_SAVE_VIEW && !named_views_have(views, address) && !role_may_save(session->identity.role, address, error))
        return false;
    const struct kept_action action = session_kept_begin(session);
    char *answer = view_edit_do(views, message, session_who(session), now_utc_ns / 1000);
    session_kept_reply(session, &action, "view", session_view_what(message), answer);
    return true;
}

static void on_share_view(struct session *session, const struct message *message, int64_t now_utc_ns)
{
    const struct kept_action action = session_kept_begin(session);
    char added[SHORT_LINK_ID_BYTES], *answer = share_view_do(session->context->services->short_links, message, now_utc_ns / 1000, added);
    if (added[0])
        session_kept_reply(session, &action, "view", mem_printf("share %s", added), answer);
    else
        session_reply(session, answer);
}

static void on_note(struct session *session, const struct message *message, int64_t now_utc_ns)
{
    const struct session_context *context = session->context;
    const struct kept_action action = session_kept_begin(session);
    /* describes the note first: note_do() may remove it, and its author would then be unknown */
    char *what = session_note_what(session, message);
    char *answer = note_do(context->services->notes, context->plant, message, session_who(session),
                           session->identity.role >= ROLE_ENGINEER, now_utc_ns / 1000);
    session_kept_reply(session, &action, "note", what, answer);
}

static void on_send_to_wall(struct session *session, const struct message *message, int64_t now_utc_ns)
{
    const struct kept_action action = session_kept_begin(session);
    char *answer = send_to_wall_do(session->context->services->wall_remote, message, session_who(session), now_utc_ns / 1000);
    session_kept_reply(session, &action, "wall", session_wall_what(message), answer);
}

/* Makes the session a wall display. From now on it is also sent the mouse pointers that users at desks show on the wall.
 * Returns false with error if the client may not act as that display. */
static bool on_display(struct session *session, const struct message *message, struct message_error *error)
{
    if (!session_may_be(session, &message->wall.place, error))
        return false;
    session->display = message->wall.place;
    session->owed.pointers_sent = wall_remote_pointer_number(session->context->services->wall_remote);
    return true;
}

static bool on_pair(struct session *session, const struct message *message, int64_t now_ns, int64_t now_utc_ns, struct message_error *error)
{
    const struct session_context *context = session->context;
    bool pairs = message->type == MESSAGE_PAIR;
    char id[TOKEN_NAME_BYTES] = "";
    if (!context->sign_in.tokens) {
        message_refuse(error, "not_allowed", NULL, REFUSAL_UNPAIRED);
        return false;
    }
    if (!pairs)
        snprintf(id, sizeof(id), "%s", message->pair.device);
    const struct kept_action action = session_kept_begin(session);
    const char *digits = message->pair.digits;
    enum refusal_code why = pairs
                                ? pairings_approve(context->services->pairings, digits, session_who(session), now_ns, now_utc_ns / 1000, id)
                                : pairings_revoke(context->services->pairings, id);
    json_t *said = json_pack("{s:s,s:I,s:s,s:b}", "type", "paired", "seq", (json_int_t)message->seq, "id", id, "kept", !why);
    refusal_add(said, why);
    session_kept_reply(session, &action, "device", mem_printf("%s %s", pairs ? "pair" : "unpair", id), json_text(said, 0));
    return true;
}

static void on_point(const struct session *session, const struct message *message)
{
    const struct wall_request *wall = &message->wall;
    const double *position_m = wall->has_position ? wall->position_m : NULL;
    wall_remote_point(session->context->services->wall_remote, &wall->place, position_m, session_who(session), wall->desk);
}

static bool act(struct session *session, const struct message *message, int64_t now_ns, int64_t now_utc_ns, struct message_error *error)
{
    switch (message->type) {
    case MESSAGE_HELLO: session_on_input(session, now_ns); return session_hello(session, message, now_ns, now_utc_ns, error);
    case MESSAGE_CAMERA:
        set_camera(session, message);
        session_on_input(session, now_ns);
        return true;
    case MESSAGE_PARAMS: session_on_input(session, now_ns); return on_params(session, message, error);
    case MESSAGE_RESIZE: session_on_input(session, now_ns); return on_resize(session, message, error);
    case MESSAGE_ACK: return on_ack(session, message, now_ns, error);
    case MESSAGE_VISIBLE: session_on_visible(session, message->visible, now_ns); return true;
    case MESSAGE_FOLLOW: session_ask_follow(session, message); return true;
    case MESSAGE_LEAD: session_ask_lead(session, message); return true;
    case MESSAGE_ALARM: return on_alarm(session, message, error);
    case MESSAGE_FIT: on_fit(session, message); return true;
    case MESSAGE_PICK: on_pick(session, message); return true;
    case MESSAGE_KEY_FRAME: session->demand.any = true; return true;
    case MESSAGE_CODECS: return session_choose_codec(session, &message->codecs, error);
    case MESSAGE_TIME: return session_on_time(session, &message->time, now_ns, now_utc_ns, error);
    case MESSAGE_PLACE: return session_on_place(session, message, now_ns, error);
    case MESSAGE_COVERAGE: return session_ask_coverage(session, message, error);
    case MESSAGE_SAVE_TAGS:
    case MESSAGE_ACCEPT_PLACES:
    case MESSAGE_RESTORE_TAGS: return session_save_tags(session, message, error);
    case MESSAGE_LOOP_CHECK: return session_check_loop(session, message, error);
    case MESSAGE_SAVE_VIEW:
    case MESSAGE_REMOVE_VIEW: return on_view_edit(session, message, now_utc_ns, error);
    case MESSAGE_SHARE_VIEW: on_share_view(session, message, now_utc_ns); return true;
    case MESSAGE_NOTE:
    case MESSAGE_REMOVE_NOTE: on_note(session, message, now_utc_ns); return true;
    case MESSAGE_DISPLAY: return on_display(session, message, error);
    case MESSAGE_SEND_TO_WALL: on_send_to_wall(session, message, now_utc_ns); return true;
    case MESSAGE_POINT: on_point(session, message); return true;
    case MESSAGE_PAIR:
    case MESSAGE_UNPAIR: return on_pair(session, message, now_ns, now_utc_ns, error);
    case MESSAGE_LOOK: session_on_input(session, now_ns); return on_look(session, message, error);
    case MESSAGE_SIGN: return session_choose_signed(session, message->signed_frames, error);
    case MESSAGE_PING: on_ping(session, message, now_ns, now_utc_ns); return true;
    }
    return true;
}

static bool in_order(const struct session *session, const struct message *message, struct message_error *error)
{
    if (message->type == MESSAGE_HELLO && session->hello) {
        message_fail(error, "hello_again", "hello was already sent; send resize, camera or params to change settings");
        return false;
    }
    if (message->type != MESSAGE_HELLO && message->type != MESSAGE_PING && !session->hello) {
        message_fail(error, "hello_first", "the first message must be hello");
        return false;
    }
    /* hello passes unchecked: session_hello() checks its token, which decides what the client may do */
    return message->type == MESSAGE_HELLO ||
           (role_may_send(session->identity.role, message, error) && session_scope_allows(session, message, error));
}

/* On a renderer (daemon that draws for a core): forwards messages that the core must act on. Returns true if it forwarded the
   message, or replied with an error (set in `error`) because the core is not connected. */
static bool hand_on(struct session *session, const struct message *message, const char *text, struct message_error *error)
{
    const struct session_context *context = session->context;
    if (!context->core.hand_on || !message_is_handed_on(message))
        return false;
    if (!context->core.hand_on(context->core.hand_on_arg, session, text)) {
        message_fail(error, "core_lost", "not done: the daemon that polls the devices (core) cannot be reached");
        session_reply_error(session, error);
    }
    return true;
}

void session_too_fast(struct session *session, int64_t count, const char *whose)
{
    struct message_error error = { 0 };
    if (session->rate.exceeded)
        return;
    message_fail(&error, "too_fast", "too many messages: more than %lld %swithin a second: further messages are read a second later",
                 (long long)count, whose);
    session->rate.exceeded = true;
    session_reply_error(session, &error);
}

/* Starts a new second for the limit on a client's messages. Messages read beyond the limit of the last second count against the
   new one. most: messages allowed per second. */
static void begin_second(struct message_rate *rate, int64_t most, int64_t now_ns)
{
    int64_t seconds = (now_ns - rate->begin_ns) / NS_PER_S, allowed = seconds * most;
    if (seconds <= 0)
        return;
    rate->begin_ns = rate->count > allowed ? rate->begin_ns + seconds * NS_PER_S : now_ns;
    rate->count = rate->count > allowed ? rate->count - (int)allowed : 0;
}

static bool may_be_read_again(const struct session *session, int64_t now_ns)
{
    int64_t seconds = session->rate.count / session->context->quotas->at[QUOTA_MESSAGES];
    return now_ns - session->rate.begin_ns >= (seconds > 1 ? seconds : 1) * NS_PER_S;
}

static void count_message(struct session *session, int64_t now_ns)
{
    int64_t most = session->context->quotas->at[QUOTA_MESSAGES];
    session->stats.messages++;
    session->heard_ns = now_ns;
    begin_second(&session->rate, most, now_ns);
    if (++session->rate.count >= most)
        session_too_fast(session, most, "");
}

static bool parse(const struct session *session, const char *text, size_t count, struct message *message, struct message_error *error)
{
    struct plant copy;
    const struct plant *plant = session->context->plant, *known = role_plant(session->identity.role, plant, &copy);
    struct message_error other;
    if (message_parse(known, text, count, message, error))
        return true;
    /* the first message, hello, may refer to anything in the plant, because its token is not checked yet; later messages only
       to what the token's role may see */
    return known != plant && !session->hello && message_parse(plant, text, count, message, &other) && message->hello.token[0];
}

void session_on_message(struct session *session, const char *text, size_t count, int64_t now_ns, int64_t now_utc_ns)
{
    struct message message;
    struct message_error error;
    count_message(session, now_ns);
    /* the connection is being closed, because the client's token was refused or has ended */
    if (!login_is_good(session->identity.login) || session->close.code == 1008)
        return;
    bool good = parse(session, text, count, &message, &error);
    if (good)
        clear_claimed_name(session, &message);
    if (good && session->context->core.hand_on && in_order(session, &message, &error) && hand_on(session, &message, text, &error))
        return;
    if (!good || !in_order(session, &message, &error) || !act(session, &message, now_ns, now_utc_ns, &error)) {
        session_record_refusal(session, &error);
        session_reply_error(session, &error);
    }
}

void session_on_oversize(struct session *session, size_t count, int64_t now_ns)
{
    struct message_error error = { 0 };
    count_message(session, now_ns);
    message_fail(&error, "too_long", "the message has %zu bytes; at most %lld are allowed", count,
                 (long long)session->context->quotas->at[QUOTA_MESSAGE_BYTES]);
    session_reply_error(session, &error);
}

static const int64_t TOKEN_NS = 3600 * NS_PER_S; /* a view token is sent again after this time even if the view has not changed */

/* Sends the client a new view token if its view changed, so that another daemon can restore the view if this one dies. View
   tokens are valid for a day, and across one restart of the core (daemon that reads the devices). */
static void tell_token(struct session *session, int64_t now_ns)
{
    struct session_identity *identity = &session->identity;
    int64_t age_ns = now_ns - identity->token_ns;
    bool same = view_equal(&identity->token_view, &session->view) && age_ns < TOKEN_NS;
    if (!session->hello || !identity->tokens || age_ns < NS_PER_S || same)
        return;
    const struct snapshot *snapshot = session->context->readings.snapshot;
    char *token =
        view_token_make(session->context->sign_in.token_keys, session, snapshot->taken_utc_ns + (now_ns - snapshot->taken_mono_ns));
    identity->token_ns = now_ns;
    if (token) {
        identity->token_view = session->view;
        session_reply(session, json_text(json_pack("{s:s,s:s}", "type", "resume", "resume", token), 0));
    }
    mem_free(token);
}

/* Returns whether a newer picture is outstanding: wanted, requested, in flight or ready to send. */
static bool is_owed(const struct session *session)
{
    const struct frame_demand *demand = &session->demand;
    const struct pacer *pacer = &session->delivery.pacer;
    return demand->input || demand->data || demand->any || pacer->asked > 0 || pacer->flight_count > 0 || session->delivery.ready;
}

void session_on_tick(struct session *session, int64_t now_ns)
{
    if (!is_owed(session))
        session->settled_ns = session->heard_ns;
    tell_token(session, now_ns);
    if (!session->hello && now_ns - session->opened_ns >= session->context->quotas->at[QUOTA_PATIENCE_S] * NS_PER_S)
        session_close(session, 1008, "the client sent no hello within the time limit");
    if (session->rate.exceeded && may_be_read_again(session, now_ns))
        session->rate.exceeded = false;
    if (pacer_state(&session->delivery.pacer, now_ns) != PACER_FLOWS)
        session_pause(session);
    session_choose_again(session, now_ns);
    session_keep_pixels(session, now_ns);
    session->owed.time |= session->hello && session->context->services->snapshot_cache && session->context->readings.history_first_us &&
                          !session->owed.told_beginning;
}

bool session_moves(const struct session *session, int64_t now_ns)
{
    return session->hello && now_ns - session->demand.input_ns < NS_PER_S;
}

void session_on_links(struct session *session)
{
    session->owed.status = true;
}

int64_t session_fresh_ns(const struct session *session)
{
    int64_t sent_ns = session->delivery.pacer.acked.sent_ns ? session->delivery.pacer.acked.sent_ns : session->opened_ns;
    return !is_owed(session) ? session->heard_ns : sent_ns > session->settled_ns ? sent_ns : session->settled_ns;
}

bool session_rests(const struct session *session, int64_t now_ns)
{
    const struct frame_demand *demand = &session->demand;
    const struct pacer *pacer = &session->delivery.pacer;
    if (session->rate.exceeded || pacer->asked > 0 || pacer->flight_count > 0 || session->delivery.ready ||
        session->following.followers_changed)
        return false;
    if (!session->hello || session->hidden)
        return true;
    bool frame_due = demand->input || demand->data || demand->any || demand->refined != REFINED_FULL;
    bool plays = session->travel.speed != 0 || session->travel.wanted_us;
    return !frame_due && !session_moves(session, now_ns) && !plays && (!session->owed.tags || session_is_open(session));
}
