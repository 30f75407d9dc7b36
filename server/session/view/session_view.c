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
    return seen->travel.historical ? &seen->travel.historical->snapshot : session->context->readings.snapshot;
}

bool session_apply_params(const struct session *session, const struct message *message, struct view *view, struct message_error *error)
{
    const struct session_context *context = session->context;
    const struct params_context params = { .scene = context->services->scene,
                                           .baselines = context->services->baselines,
                                           .snapshot = session_snapshot(session) };
    struct view changed = *view;
    if (!params_apply(&params, &message->params, &changed, error) || !split_apply(&params, &message->split, &changed, error))
        return false;
    view_set_instant(&changed, view->at_us, view->field.slot);
    view_set_trial(&changed, view->field.trial);
    *view = changed;
    return true;
}
