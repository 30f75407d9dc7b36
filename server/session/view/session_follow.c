/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes a session show another session's view, and keeps the session's own camera, parameters and size meanwhile. */
#include <string.h>

#include "base/mem.h"
#include "session/reply/reply.h"
#include "session/session_impl.h"

void session_ask_follow(struct session *session, const struct message *message)
{
    /* ignores the message: a tile (display with a part of a wall's picture) always follows its wall's leader */
    if (session_is_tile(session))
        return;
    session->following.wanted = message->follow;
    session->following.asked = true;
}

void session_come_to_own(struct session *session)
{
    const struct view shown = session->view;
    session_time_leave(session);
    session->view = session->following.own_view;
    session->view.width_px = shown.width_px;
    session->view.height_px = shown.height_px;
    session->view.pixel_ratio = shown.pixel_ratio;
    session->view.camera_seq = shown.camera_seq;
    session->view.params_seq = shown.params_seq;
    view_set_instant(&session->view, 0, 0);
    session->following.left = 0;
}

void session_leader_gone(struct session *session, int64_t now_ns)
{
    uint64_t called = session->following.leader->identity.number;
    session->following.own_view = session->view;
    session_inherit(session, session->following.leader);
    /* stops using the positions at which the leader's user tries out sensors, because they are freed together with the leader's
       session */
    view_set_trial(&session->view, 0);
    session_follow(session, NULL, now_ns);
    session->following.left = called;
}

void session_follow(struct session *session, struct session *leader, int64_t now_ns)
{
    if (session->following.left)
        session_come_to_own(session);
    if (session->following.leader)
        session->following.leader->following.followers_changed = true;
    if (leader)
        leader->following.followers_changed = true;
    session->following.leader = leader;
    session->delivery.common_step = -1;
    session->owed.following = true;
    session_on_leader(session, now_ns);
}

void session_ask_lead(struct session *session, const struct message *message)
{
    /* ignores a tile (display with a part of a wall's picture): the positions of a wall's displays decide which tile leads */
    if (!session_is_tile(session))
        session->following.heir_wanted = message->follow;
}

void session_inherit(struct session *heir, const struct session *session)
{
    struct view own = heir->view;
    heir->view = session->view;
    heir->view.width_px = own.width_px;
    heir->view.height_px = own.height_px;
    heir->view.pixel_ratio = own.pixel_ratio;
    heir->view.camera_seq = own.camera_seq;
    heir->view.params_seq = own.params_seq;
    if (heir->view.width_px < VIEW_SPLIT_LEAST_PX) {
        heir->view.split = false;
        heir->view.right = (struct split_half){ 0 };
    }
    session_time_inherit(heir, session);
}

void session_lead_nobody(struct session *session)
{
    struct message_error error = { .about = "lead" };
    message_refuse(&error, "bad_field", "session", REFUSAL_GONE);
    session_reply_error(session, &error);
}

struct follow_request session_take_follow_request(struct session *session)
{
    struct session_following *following = &session->following;
    struct follow_request request = { session->identity.returned, following->heir_wanted, following->asked, following->wanted };
    session->identity.returned = following->asked = false;
    following->heir_wanted = 0;
    return request;
}

void session_say_followers(struct session *session, const struct session *const *followers, size_t count, int64_t now_ns)
{
    mem_free(session->following.followers_text);
    session->following.followers_text = reply_followers_text(followers, count, session_is_open(session));
    session->following.followers_changed = false;
    session->following.followers_ns = now_ns;
}

void session_follow_nobody(struct session *session)
{
    struct message_error error = { .about = "follow" };
    message_refuse(&error, "bad_field", "session", REFUSAL_GONE);
    session_reply_error(session, &error);
}

void session_on_leader(struct session *session, int64_t now_ns)
{
    const struct view *view = session_view(session);
    int *size_px = session->following.told_size_px;
    bool told = view->params_seq == session->following.told_params_seq && view->width_px == size_px[0] && view->height_px == size_px[1];
    session->owed.following |= session->following.leader && !told;
    session->following.told_params_seq = view->params_seq;
    size_px[0] = view->width_px;
    size_px[1] = view->height_px;
    session_tell_time(session);
    session_on_input(session, now_ns);
}

static struct session *seen(struct session *session)
{
    return session->following.leader ? session->following.leader : session;
}

void session_clear_steps(struct session *session)
{
    memset(session->delivery.steps, 0, sizeof(session->delivery.steps));
}

void session_count_step(struct session *session)
{
    const struct quality_ladder *ladder = &session->delivery.pacer.ladder;
    if (ladder->known)
        seen(session)->delivery.steps[ladder->step]++;
}

void session_choose_step(struct session *session)
{
    const struct frame_delivery *delivery = &seen(session)->delivery;
    session->delivery.common_step = quality_ladder_common(&delivery->pacer.ladder, delivery->steps);
    session->delivery.pacer.ladder.made = delivery->pacer.ladder.made; /* otherwise a view would be drawn in several sizes */
}
