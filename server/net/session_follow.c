/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A session that is shown the view of another one. Its own camera, parameters and size go on beneath. */
#include "base/clock.h"
#include "net/reply.h"
#include "net/session_impl.h"

const struct view *session_view(const struct session *session)
{
    return session->leader ? &session->leader->view : &session->view;
}

void session_ask_follow(struct session *session, const struct message *message)
{
    session->follow = message->follow;
    session->follow_asked = true;
}

void session_follow(struct session *session, struct session *leader, int64_t now_ns)
{
    session->leader = leader;
    session->common_step = -1;
    session->owes_following = true;
    session_on_leader(session, now_ns);
}

void session_follow_nobody(struct session *session)
{
    struct message_error error = { .about = "follow" };
    message_fail(&error, "bad_field", "session: %llu is not connected, or is this one", (unsigned long long)session->follow);
    session_reply_error(session, &error);
}

void session_on_leader(struct session *session, int64_t now_ns)
{
    const struct view *view = session_view(session);
    int *size_px = session->leader_size_px;
    bool told = view->params_seq == session->leader_params_seq && view->width_px == size_px[0] && view->height_px == size_px[1];
    session->owes_following |= session->leader && !told;
    session->leader_params_seq = view->params_seq;
    size_px[0] = view->width_px;
    size_px[1] = view->height_px;
    session_tell_time(session);
    session_on_input(session, now_ns);
}
