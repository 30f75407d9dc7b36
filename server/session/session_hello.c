/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The first message of a session: who it is, whether there is room for it, and what it looks at. */
#include <string.h>

#include "session/session_impl.h"

static bool judge_token(struct session *session, const char *token, int64_t now_ns, int64_t now_utc_ns, struct message_error *error)
{
    const struct session_context *world = session->world;
    bool good = tokens_find(world->tokens, token, now_utc_ns, &session->holder);
    session->login = world->logins ? login_throttle_judge(world->logins, session->address, good ? session->holder.hash : NULL, now_ns)
                     : good        ? LOGIN_GOOD
                                   : LOGIN_WRONG;
    if (session->login == LOGIN_HELD) {
        message_fail(error, "full", "too many wrong tokens came from this address");
        error->retry_after_s = LOGIN_WAIT_S;
        session_close(session, 1013, "full: too many wrong tokens came from this address; try again later");
    } else if (!good) {
        message_fail(error, "bad_token", "this token is not, or no longer, let in");
        session_close(session, 1008, "this token is not let in");
    } else {
        session->role = session->holder.role;
    }
    return login_is_good(session->login);
}

/* With a token, its holder's role counts, even where none is needed. */
static bool identify(struct session *session, const struct message *message, int64_t now_ns, int64_t now_utc_ns,
                     struct message_error *error)
{
    if (message->token[0] && session->world->tokens && !judge_token(session, message->token, now_ns, now_utc_ns, error))
        return false;
    if (role_may_send(session->role, message, error))
        return true;
    if (session->role == ROLE_NOBODY)
        session_close(session, 1008, "a token is needed");
    return false;
}

static bool admit(struct session *session, const struct view *view, struct message_error *error)
{
    const struct session_context *world = session->world;
    const char *why = admission_refuses(world->admission, session->share, (int64_t)view->width_px * view->height_px);
    if (!why)
        return session_reserve_pixels(session, view->width_px, view->height_px, error);
    message_fail(error, "full", "%s", why);
    error->retry_after_s = ADMISSION_RETRY_S;
    session_close(session, 1013, why);
    return false;
}

/* The view to begin with: the one it left, or the plant's own. */
static bool begin_view(const struct session *session, const struct message *message, const struct resumed *resumed, struct view *view,
                       struct message_error *error)
{
    if (!resumed && (message->width_px == 0 || message->codecs.count == 0)) {
        message_fail(error, "bad_field", "resume: there is no such view (any more); width, height and codecs are needed");
        return false;
    }
    if (resumed) {
        *view = resumed->view;
        view_set_instant(view, 0, 0);
        view_set_trial(view, 0);
    }
    if (!resumed)
        view_default(session->world->scene, message->width_px, message->height_px, view);
    if (message->width_px) {
        view->width_px = message->width_px;
        view->height_px = message->height_px;
    }
    view->camera_seq = view->params_seq = 0;
    if (message->has_camera) {
        view->camera = message->camera;
        view->camera_seq = message->seq;
    }
    if (message->has_params)
        view->params_seq = message->params.seq;
    return !message->has_params || session_apply_params(session, message, view, error);
}

bool session_apply_params(const struct session *session, const struct message *message, struct view *view, struct message_error *error)
{
    const struct session_context *world = session->world;
    const struct params_context params = { .scene = world->scene, .baselines = world->baselines, .snapshot = session_snapshot(session) };
    struct view changed = *view;
    if (!params_apply(&params, &message->params, &changed, error) || !split_apply(&params, &message->split, &changed, error))
        return false;
    view_set_instant(&changed, view->at_us, view->field.slot);
    view_set_trial(&changed, view->field.trial);
    *view = changed;
    return true;
}

static void take_over(struct session *session, const struct resumed *resumed, const char *secret)
{
    resumes_forget(session->world->resumes, secret);
    if (resumed->live)
        session_close(resumed->live, 1000, "a new connection has taken this view over");
}

bool session_hello(struct session *session, const struct message *message, int64_t now_ns, int64_t now_utc_ns, struct message_error *error)
{
    const struct session_context *world = session->world;
    struct resumed resumed = { .live = NULL };
    struct view view;
    if (!identify(session, message, now_ns, now_utc_ns, error))
        return false;
    bool back = message->resume[0] && resumes_find(world->resumes, message->resume, session, now_ns, &resumed);
    const struct resumed *before = back && !message->anew ? &resumed : NULL; /* of which the view is taken, too */
    if (!begin_view(session, message, before, &view, error) ||
        !session_choose_codec(session, message->codecs.count ? &message->codecs : &resumed.codecs, error) || !admit(session, &view, error))
        return false;
    if (back)
        take_over(session, &resumed, message->resume);
    session->view = view;
    if (message->time.has_at)
        session_time_begin(session, message->time.at_us, message->time.speed);
    else if (before)
        session_time_begin(session, resumed.view.at_us, resumed.speed);
    session->resumed = session->returned = back;
    if (back)
        session->called = resumed.called;
    session->pixel_ratio = message->pixel_ratio > 0 ? message->pixel_ratio : before ? resumed.pixel_ratio : 1;
    resumes_open(world->resumes, session, session->resume);
    session->hello = session->owes_welcome = session->owes_tags_all = session->owes_status = session->always_pending = true;
    session->owes_time = world->snapshot_cache != NULL;
    session->owes_loop_checks = true;
    return true;
}
