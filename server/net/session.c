/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One client: its view, what it is owed, what it may have. */
#include "net/session.h"

#include <string.h>

#include "base/clock.h"
#include "base/mem.h"
#include "net/framing.h"
#include "net/reply.h"

static const int64_t STILL_NS = 200 * NS_PER_MS;         /* nothing moved for so long: refine */
static const int64_t LOADED_STILL_NS = 1000 * NS_PER_MS; /* likewise, when not all can be refined */
static const int64_t LOADED_SHARE_NS = 3 * NS_PER_S;      /* but after so long without one, however often readings change */
static const int64_t PATIENCE_NS = 10 * NS_PER_S;        /* others may move for so long before one is refined all the same */
static const int64_t TAGS_NS = 500 * NS_PER_MS;          /* changed values, at most this often */
static const int64_t REPEAT_NS = 2000 * NS_PER_MS;       /* all values and the links, at least this often */
static const struct encoder_params MOVING = { .quality = 78, .full_chroma = false }, STILL = { .quality = 92, .full_chroma = true };

struct session *session_create(const struct session_world *world, uint64_t id, int64_t now_ns)
{
    struct session *session = mem_new(sizeof(*session));
    *session = (struct session){ .id = id, .world = world, .rate_begin_ns = now_ns };
    session->tag_changes = mem_array(world->plant->tag_count, sizeof(*session->tag_changes));
    return session;
}

void session_destroy(struct session **session_ptr)
{
    struct session *session = *session_ptr;
    if (!session)
        return;
    picture_destroy(&session->ready);
    for (int i = 0; i < session->reply_count; i++)
        mem_free(session->replies[i]);
    mem_free(session->tag_changes);
    mem_free(session);
    *session_ptr = NULL;
}

/* --- input ---------------------------------------------------------------------------------------------------------------- */

static void reply(struct session *session, char *text)
{
    if (session->reply_count == SESSION_MAX_REPLIES) { /* it does not read: the oldest answer is worth least */
        mem_free(session->replies[0]);
        memmove(session->replies, session->replies + 1, sizeof(session->replies) - sizeof(session->replies[0]));
        session->reply_count--;
    }
    session->replies[session->reply_count++] = text;
}

static void reply_error(struct session *session, const struct message_error *error)
{
    session->errors++;
    reply(session, reply_error_text(error));
}

static void on_input(struct session *session, int64_t now_ns)
{
    session->input_pending = true;
    session->refined = session->failure_said = false;
    session->input_ns = now_ns;
}

static void set_camera(struct session *session, const struct message *message)
{
    session->view.camera = message->camera;
    session->view.camera_seq = message->seq;
}

static bool apply_params(const struct session *session, const struct message *message, struct view *view, struct message_error *error)
{
    const struct session_world *world = session->world;
    const struct params_world params = { world->scene, world->baselines, world->snapshot };
    struct view changed = *view;
    if (!params_apply(&params, &message->params, &changed, error) || !split_apply(&params, &message->split, &changed, error))
        return false;
    *view = changed;
    return true;
}

static bool on_hello(struct session *session, const struct message *message, struct message_error *error)
{
    struct view view;
    view_default(session->world->scene, message->width_px, message->height_px, &view);
    if (message->has_params && !apply_params(session, message, &view, error))
        return false;
    session->view = view;
    if (message->has_params)
        session->view.params_seq = message->params.seq;
    if (message->has_camera)
        set_camera(session, message);
    session->codec = message->codec;
    session->hello = session->owes_welcome = session->owes_tags_all = session->owes_status = session->always_pending = true;
    return true;
}

static bool on_params(struct session *session, const struct message *message, struct message_error *error)
{
    if (!apply_params(session, message, &session->view, error))
        return false;
    session->view.params_seq = session->params_seq = message->params.seq;
    session->owes_params = true;
    return true;
}

static bool on_ack(struct session *session, const struct message *message, int64_t now_ns, struct message_error *error)
{
    if (pacer_acked(&session->pacer, message->seq, now_ns) != PACER_ACK_NEVER_SENT)
        return true;
    message_fail(error, "bad_field", "seq: frame %u was never sent", message->seq);
    return false;
}

static void on_visible(struct session *session, bool visible)
{
    session->always_pending |= visible && session->hidden;
    session->hidden = !visible;
}

/* Answered only: the camera is the client's. */
static void on_fit(struct session *session, const struct message *message)
{
    struct camera camera = session->view.camera;
    fit_apply(session->world->scene, &message->fit, (double)session->view.width_px / session->view.height_px, &camera);
    reply(session, reply_camera_text(&camera, message->seq));
}

static void on_pick(struct session *session, const struct message *message)
{
    session->pick = (struct pick_order){ .client = session->id, .seq = message->seq, .view = session->view };
    session->pick.x_px = message->pick.x_px;
    session->pick.y_px = message->pick.y_px;
    if (message->pick.has_camera)
        session->pick.view.camera = message->pick.camera;
    session->pick_pending = true;
}

bool session_pick(struct session *session, struct pick_order *order)
{
    bool pending = session->pick_pending;
    if (pending)
        *order = session->pick;
    session->pick_pending = false;
    return pending;
}

void session_on_pick(struct session *session, const struct pick_answer *answer)
{
    reply(session, reply_picked_text(session->world->plant, answer));
}

static bool act(struct session *session, const struct message *message, int64_t now_ns, int64_t now_utc_ns, struct message_error *error)
{
    switch (message->type) {
    case MESSAGE_HELLO: on_input(session, now_ns); return on_hello(session, message, error);
    case MESSAGE_CAMERA:
        set_camera(session, message);
        on_input(session, now_ns);
        return true;
    case MESSAGE_PARAMS: on_input(session, now_ns); return on_params(session, message, error);
    case MESSAGE_RESIZE:
        session->view.width_px = message->width_px;
        session->view.height_px = message->height_px;
        on_input(session, now_ns);
        return true;
    case MESSAGE_ACK: return on_ack(session, message, now_ns, error);
    case MESSAGE_VISIBLE: on_visible(session, message->visible); return true;
    case MESSAGE_FIT: on_fit(session, message); return true;
    case MESSAGE_PICK: on_pick(session, message); return true;
    case MESSAGE_PING: reply(session, reply_pong_text(message->t, now_utc_ns)); return true;
    }
    return true;
}

static bool in_order(const struct session *session, const struct message *message, struct message_error *error)
{
    if (message->type == MESSAGE_HELLO && session->hello) {
        message_fail(error, "hello_again", "hello comes once; use resize, camera and params");
        return false;
    }
    if (message->type != MESSAGE_HELLO && message->type != MESSAGE_PING && !session->hello) {
        message_fail(error, "hello_first", "the first message is hello");
        return false;
    }
    return true;
}

static void count_message(struct session *session, int64_t now_ns)
{
    session->messages++;
    if (now_ns - session->rate_begin_ns >= NS_PER_S) {
        session->rate_begin_ns = now_ns;
        session->rate_count = 0;
    }
    if (++session->rate_count < SESSION_MAX_MESSAGES_PER_S || session->too_fast)
        return;
    struct message_error error = { 0 };
    message_fail(&error, "too_fast", "%d messages within a second: the next are read after it", SESSION_MAX_MESSAGES_PER_S);
    session->too_fast = true;
    reply_error(session, &error);
}

void session_on_message(struct session *session, const char *text, size_t count, int64_t now_ns, int64_t now_utc_ns)
{
    struct message message;
    struct message_error error;
    count_message(session, now_ns);
    if (!message_parse(session->world->plant, text, count, &message, &error) || !in_order(session, &message, &error) ||
        !act(session, &message, now_ns, now_utc_ns, &error))
        reply_error(session, &error);
}

void session_on_oversize(struct session *session, size_t count, int64_t now_ns)
{
    struct message_error error = { 0 };
    count_message(session, now_ns);
    message_fail(&error, "too_long", "%zu bytes; a message holds at most %u", count, WIRE_MAX_MESSAGE_BYTES);
    reply_error(session, &error);
}

void session_on_tick(struct session *session, int64_t now_ns)
{
    if (session->too_fast && now_ns - session->rate_begin_ns >= NS_PER_S)
        session->too_fast = false;
}

void session_on_data(struct session *session, int64_t now_ns)
{
    if (!session->data_pending)
        session->data_ns = now_ns;
    session->data_pending = session->owes_tags = true;
}

/* The one who already has a picture keeps it; a new one would look at nothing. */
static void on_failure(struct session *session, const struct view *view)
{
    struct message_error error = { 0 };
    if (session->newest_number == 0) {
        session->refused = true;
        return;
    }
    if (session->failure_said)
        return;
    session->failure_said = true;
    message_fail(&error, "no_picture", "%dx%d cannot be drawn: the server is out of memory; the last picture stays", view->width_px,
                 view->height_px);
    reply_error(session, &error);
}

void session_on_picture(struct session *session, struct picture *picture)
{
    if (picture->failed)
        on_failure(session, &picture->wish.view);
    bool late = picture->number < session->newest_number;
    if (!picture->packet || late) {
        session->dropped += late;
        pacer_dropped(&session->pacer);
        picture_destroy(&picture);
        return;
    }
    session->newest_number = picture->number;
    if (picture->wish.view.tier == TIER_MOVING)
        session->moved_ns = picture->wish.asked_ns;
    if (session->ready) { /* newer than what the socket has not yet taken */
        session->dropped++;
        pacer_dropped(&session->pacer);
        picture_destroy(&session->ready);
    }
    session->ready = picture;
}

/* --- wishes --------------------------------------------------------------------------------------------------------------- */

static bool refine_due(const struct session *session, int64_t now_ns)
{
    const struct session_world *world = session->world;
    bool others_move = now_ns < world->moving_until_ns && now_ns - session->input_ns < PATIENCE_NS;
    bool data_moves = world->loaded && now_ns - session->moved_ns < LOADED_STILL_NS && now_ns - session->refined_ns < LOADED_SHARE_NS;
    return !session->refined && session->pacer.asked == 0 && !others_move && !data_moves && now_ns - session->input_ns >= STILL_NS;
}

static bool wants(const struct session *session, int64_t now_ns, struct wish *wish)
{
    enum tier tier = TIER_MOVING;
    int64_t since_ns = session->input_ns;
    if (session->input_pending || session->always_pending) {
        wish->urgency = URGENCY_INPUT;
        wish->always = session->always_pending;
    } else if (refine_due(session, now_ns)) {
        wish->urgency = URGENCY_REFINE;
        tier = TIER_STILL;
        since_ns = now_ns;
    } else if (session->data_pending) {
        bool still = session->refined && !session->world->loaded && now_ns >= session->world->moving_until_ns;
        wish->urgency = still ? URGENCY_REFINE : URGENCY_DATA;
        tier = still ? TIER_STILL : TIER_MOVING;
        since_ns = session->data_ns;
    } else {
        return false;
    }
    wish->view.tier = tier;
    wish->view.input_ns = since_ns;
    wish->quality = tier == TIER_STILL ? STILL : MOVING;
    return true;
}

bool session_wish(const struct session *session, int64_t now_ns, struct wish *wish)
{
    bool may_add = pacer_may_ask(&session->pacer);
    if (!session->hello || session->hidden || (!may_add && session->pacer.asked == 0))
        return false;
    *wish = (struct wish){ .view = session->view, .codec = session->codec, .asked_ns = now_ns, .only_replace = !may_add };
    return wants(session, now_ns, wish);
}

void session_asked(struct session *session, const struct wish *wish, bool replaced)
{
    if (!replaced)
        pacer_asked(&session->pacer);
    session->input_pending = session->always_pending = session->data_pending = false;
    session->refined = wish->view.tier == TIER_STILL;
    if (session->refined)
        session->refined_ns = wish->asked_ns;
}

/* --- output --------------------------------------------------------------------------------------------------------------- */

static void add_owned(struct text *out, char *text)
{
    text_add(out, "%s", text);
    mem_free(text);
}

static void add_reply(struct session *session, struct text *out)
{
    add_owned(out, session->replies[0]);
    session->reply_count--;
    memmove(session->replies, session->replies + 1, (size_t)session->reply_count * sizeof(session->replies[0]));
}

static bool tags_all_due(const struct session *session, int64_t now_ns)
{
    return session->owes_tags_all || now_ns - session->tags_all_ns >= REPEAT_NS;
}

static bool tags_due(const struct session *session, int64_t now_ns)
{
    return session->hello && !session->hidden &&
           (tags_all_due(session, now_ns) || (session->owes_tags && now_ns - session->tags_ns >= TAGS_NS));
}

static bool status_due(const struct session *session, int64_t now_ns)
{
    return session->hello && !session->hidden && (session->owes_status || now_ns - session->status_ns >= REPEAT_NS);
}

bool session_has_text(const struct session *session, int64_t now_ns)
{
    return session->owes_welcome || session->reply_count > 0 || session->owes_params || status_due(session, now_ns) ||
           tags_due(session, now_ns);
}

static void add_tags(struct session *session, int64_t now_ns, struct text *out)
{
    bool all = tags_all_due(session, now_ns);
    add_owned(out, reply_tags_text(session->world, session->tag_changes, all));
    session->owes_tags = session->owes_tags_all = false;
    session->tags_ns = now_ns;
    if (all)
        session->tags_all_ns = now_ns;
}

bool session_next_text(struct session *session, int64_t now_ns, int64_t now_utc_ns, struct text *out)
{
    const struct session_world *world = session->world;
    if (session->owes_welcome) {
        add_owned(out, reply_welcome_text(world, session->id, session->codec, &session->view, now_utc_ns));
        session->owes_welcome = false;
    } else if (session->reply_count > 0) {
        add_reply(session, out);
    } else if (session->owes_params) {
        add_owned(out, reply_params_text(world, &session->view, session->params_seq));
        session->owes_params = false;
    } else if (status_due(session, now_ns)) {
        add_owned(out, reply_status_text(world, now_utc_ns));
        session->owes_status = false;
        session->status_ns = now_ns;
    } else if (tags_due(session, now_ns)) {
        add_tags(session, now_ns, out);
    } else {
        return false;
    }
    return true;
}

struct picture *session_next_picture(struct session *session, int64_t now_ns, uint32_t *seq)
{
    struct picture *picture = session->ready;
    if (!picture)
        return NULL;
    session->ready = NULL;
    *seq = pacer_sent(&session->pacer, picture->packet->count, now_ns);
    return picture;
}
