/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "session/view/session_view.h"

#include "session/session_context.h"

const struct view *session_view(const struct session *session)
{
    return session->following.leader ? &session->following.leader->view : &session->view;
}

struct view session_shown(const struct session *session)
{
    struct view view = *session_view(session);
    if (session->following.leader)
        view_set_trial(&view, 0);
    return view;
}

const struct snapshot *session_snapshot(const struct session *session)
{
    const struct session *seen = session->following.leader ? session->following.leader : session;
    return seen->travel.historical ? &seen->travel.historical->snapshot : session->context->snapshot;
}
