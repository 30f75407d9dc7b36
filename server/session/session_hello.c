/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Acts on `hello`: verifies the client, admits the session and sets its first view. */
#include <string.h>

#include "scene/scene_create.h"
#include "session/session_impl.h"
#include "session/view/resume.h"
#include "session/view/view_token.h"

/* Refuses a client because the server has no capacity for another session, and closes its connection. Returns false with *error. */
static bool refuse_full(struct session *session, enum refusal_code why, int retry_after_s, struct message_error *error)
{
    message_refuse(error, "full", NULL, why);
    error->retry_after_s = retry_after_s;
    session_close(session, 1013, refusal_words(why));
    return false;
}

bool session_left_alone(const struct session *session, int64_t now_ns, struct message_error *error)
{
    const struct session_identity *identity = &session->identity;
    int64_t lock_ns = session->context->sign_in.lock_ns, since_ns = identity->active_ns ? identity->active_ns : session->opened_ns;
    if (!lock_ns || identity->holder.signed_in || identity->holder.unattended || now_ns - since_ns <= lock_ns)
        return false;
    message_refuse_with(error, "locked", NULL, REFUSAL_LOCKED, "minutes=%.3g", (double)lock_ns / 60e9);
    return true;
}

bool session_may_be(struct session *session, const struct wall_place *place, struct message_error *error)
{
    const struct token_holder *holder = &session->identity.holder;
    if (!holder->display || (holder->display == place->display && !strcmp(holder->wall, place->wall)))
        return true;
    message_refuse_with(error, "not_allowed", NULL, REFUSAL_TOKEN_DISPLAY, "display=%d\nwall=%s", holder->display, holder->wall);
    session_close(session, 1008, "this token belongs to another display");
    return false;
}

static bool judge_token(struct session *session, const char *token, int64_t now_ns, int64_t now_utc_ns, struct message_error *error)
{
    const struct session_context *context = session->context;
    struct token_holder holder;
    bool good = tokens_find(context->sign_in.tokens, token, now_utc_ns, &holder);
    session->identity.login =
        context->sign_in.login_throttle
            ? login_throttle_judge(context->sign_in.login_throttle, session->identity.address, good ? holder.hash : NULL, now_ns)
        : good ? LOGIN_GOOD
               : LOGIN_WRONG;
    if (session->identity.login == LOGIN_HELD)
        return refuse_full(session, REFUSAL_TOKEN_GUESSES, LOGIN_WAIT_S, error);
    session->identity.holder = holder;
    if (!good) {
        message_refuse(error, "bad_token", NULL, REFUSAL_TOKEN_UNKNOWN);
        session_close(session, 1008, refusal_words(REFUSAL_TOKEN_UNKNOWN));
        return false;
    }
    session->identity.role = tokens_role_of(&holder);
    session_keep_token(session, token);
    return true;
}

/* Checks the token and the role. If a token is given, its role applies even if the server requires no token. Returns false with
   *error if the client is refused. */
static bool identify(struct session *session, const struct message *message, int64_t now_ns, int64_t now_utc_ns,
                     struct message_error *error)
{
    if (message->hello.token[0] && session->context->sign_in.tokens &&
        !judge_token(session, message->hello.token, now_ns, now_utc_ns, error))
        return false;
    if (role_may_send(session->identity.role, message, error))
        return true;
    if (session->identity.role == ROLE_NOBODY)
        session_close(session, 1008, refusal_words(REFUSAL_TOKEN_NEEDED));
    else if (role_is_node(session->identity.role))
        session_close(session, 1008, refusal_words(REFUSAL_TOKEN_NODE));
    return false;
}

/* Reserves pixels for the session. A tile (one display's part of a wall's picture) counts only its own display, because all
   tiles share one picture. Returns false with *error if there is no capacity. */
static bool admit(struct session *session, const struct message *message, const struct view *view, struct message_error *error)
{
    const struct session_context *context = session->context;
    bool is_tile = message->hello.tile.display > 0;
    int width_px = is_tile ? message->size.width_px : view->width_px, height_px = is_tile ? message->size.height_px : view->height_px;
    enum refusal_code why = admission_refuses(context->admission, session->room.share, (int64_t)width_px * height_px);
    if (!why)
        return session_reserve_pixels(session, width_px, height_px, error);
    return refuse_full(session, why, ADMISSION_RETRY_S, error);
}

/* Starts the session as a tile (one display's part of a wall's picture). A tile may lead its wall and can delay it, so this requires the
   token of that display or the role engineer. Returns false with *error if the client has neither, or
   if the wall has no such tile. */
static bool begin_tile(struct session *session, const struct message *message, struct view *view, struct message_error *error)
{
    const struct wall_place *place = &message->hello.tile;
    if (session->identity.role < ROLE_ENGINEER && !session->identity.holder.display) {
        message_refuse_with(error, "not_allowed", "tile", REFUSAL_TILE_TOKEN, "display=%d\nwall=%s", place->display, place->wall);
        return false;
    }
    if (!session_may_be(session, place, error))
        return false;
    if (!session_tile_fit(session, place, message->size.width_px, message->size.height_px, view, &session->tile.layout)) {
        message_refuse_with(error, "bad_field", "tile", REFUSAL_TILELESS, "display=%d\nwall=%s", place->display, place->wall);
        return false;
    }
    session->tile.place = *place;
    scene_home(session->context->services->scene, (double)view->width_px / view->height_px, &view->camera);
    return true;
}

/* Sets the first view: the resumed one, or the plant's default. Returns false with *error if the message asks for a view that cannot be
   set. */
static bool begin_view(struct session *session, const struct message *message, const struct resumed *resumed, struct view *view,
                       struct message_error *error)
{
    if (!resumed && (message->size.width_px == 0 || message->codecs.count == 0)) {
        message_fail(error, "bad_field", "resume: the daemon no longer keeps this view: send hello with width, height and codecs");
        return false;
    }
    if (resumed) {
        *view = resumed->view;
        view_set_instant(view, 0, 0);
        view_set_trial(view, 0);
    }
    if (!resumed)
        view_default(session->context->services->scene, message->size.width_px, message->size.height_px, view);
    if (message->size.width_px) {
        view->width_px = message->size.width_px;
        view->height_px = message->size.height_px;
    }
    view->camera_seq = view->params_seq = 0;
    if (message->hello.tile.display && !begin_tile(session, message, view, error))
        return false;
    session_scope_fit(session, view);
    if (session->identity.holder.views[0])
        return session_scope_view(session, message->named, view, error);
    if (message->named[0] && !session_look(session, message->named, view, error))
        return false;
    if (message->hello.has_camera) {
        view->camera = message->camera;
        view->camera_seq = message->seq;
    }
    if (message->hello.has_params)
        view->params_seq = message->params.seq;
    return !message->hello.has_params || session_apply_params(session, message, view, error);
}

static void take_over(struct session *session, const struct resumed *resumed, const char *secret)
{
    resumes_forget(session->context->resumes, secret);
    if (resumed->live)
        session_close(resumed->live, 1000, "another connection of the same client took over this view");
}

/* Finds the view that a returning client resumes: by the secret if this daemon kept the view, otherwise from the signed view
   token, which another daemon may have made. Returns false if there is none. */
static bool find_resumed(const struct session *session, const char *token, int64_t now_ns, int64_t now_utc_ns,
                         char secret[RESUME_CHARS + 1], struct resumed *out)
{
    const struct session_context *context = session->context;
    snprintf(secret, RESUME_CHARS + 1, "%.*s", (int)strcspn(token, "."), token);
    if (!token[0])
        return false;
    if (resumes_find(context->resumes, secret, session, now_ns, out))
        return true;
    return view_token_read(context->sign_in.token_keys, token, session, now_utc_ns, out) &&
           !resumes_has_live(context->resumes, out->called);
}

bool session_hello(struct session *session, const struct message *message, int64_t now_ns, int64_t now_utc_ns, struct message_error *error)
{
    const struct session_context *context = session->context;
    struct resumed resumed = { .live = NULL };
    struct view view;
    if (!identify(session, message, now_ns, now_utc_ns, error))
        return false;
    /* time of the user's last activity, from the page: a hello sent by an automatic reconnection is not a sign of activity */
    if (message->hello.idle_ms >= 0)
        session->identity.active_ns = now_ns - (int64_t)(message->hello.idle_ms * 1e6);
    if (session->identity.holder.role != ROLE_NOBODY && session_left_alone(session, now_ns, error))
        return false;
    bool narrowed = session->identity.holder.views[0] || session->identity.holder.display;
    session_scope_begin(session);
    char secret[RESUME_CHARS + 1];
    bool back = !message->hello.tile.display && find_resumed(session, message->hello.resume, now_ns, now_utc_ns, secret, &resumed);
    /* the view to resume; NULL: there is none, or the client wants a new view */
    const struct resumed *before = back && !message->hello.anew ? &resumed : NULL;
    if (!begin_view(session, message, before, &view, error) ||
        !session_choose_codec(session, message->codecs.count ? &message->codecs : &resumed.codecs, error) ||
        !session_choose_signed(session, message->signed_frames, error) || !admit(session, message, &view, error))
        return false;
    if (back)
        take_over(session, &resumed, secret);
    session->view = view;
    if (message->hello.has_params && !session->identity.holder.views[0])
        session_record_params(session, message);
    /* without a history, session_time_begin() replies that the session shows the present */
    if (message->time.has_at && (!narrowed || !context->services->snapshot_cache))
        session_time_begin(session, message->time.at_us, message->time.speed, now_utc_ns);
    else if (before && !narrowed)
        session_time_begin(session, resumed.view.at_us, resumed.speed, now_utc_ns);
    session->identity.tokens = message->hello.tokens;
    session->asks_depth = message->hello.depth;
    session->identity.resumed = session->identity.returned = back;
    if (back)
        session->identity.number = resumed.called;
    session->pixel_ratio = message->size.pixel_ratio > 0 ? message->size.pixel_ratio : before ? resumed.pixel_ratio : 1;
    resumes_open(context->resumes, session, session->identity.resume_secret);
    session->hello = session->owed.welcome = session->owed.tags_all = session->owed.status = session->demand.any = true;
    session->owed.time = context->services->snapshot_cache != NULL;
    session->owed.loop_checks = true;
    return true;
}
