/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which pictures a session wants, and what becomes of those that come. */
#include "base/clock.h"
#include "net/reply.h"
#include "net/session_impl.h"

static const int64_t STILL_NS = 200 * NS_PER_MS;         /* nothing moved for so long: refine */
static const int64_t LOADED_STILL_NS = 1000 * NS_PER_MS; /* likewise, when not all can be refined */
static const int64_t LOADED_SHARE_NS = 3 * NS_PER_S;      /* but after so long without one, however often readings change */
static const int64_t PATIENCE_NS = 10 * NS_PER_S;        /* others may move for so long before one is refined all the same */
static const struct encoder_params MOVING = { .quality = 78, .full_chroma = false }, STILL = { .quality = 92, .full_chroma = true };

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
    session_reply_error(session, &error);
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

struct picture *session_next_picture(struct session *session, int64_t now_ns, uint32_t *seq)
{
    struct picture *picture = session->ready;
    if (!picture)
        return NULL;
    session->ready = NULL;
    *seq = pacer_sent(&session->pacer, picture->packet->count, now_ns);
    return picture;
}
