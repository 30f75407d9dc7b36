/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Counts the pixels that a session's view takes from the admission budget. They are reserved when the view gets its size, and
   returned while the page is hidden. */

#include "base/clock.h"
#include "session/session_impl.h"

/* A page loses its reserved pixels if it was hidden for longer than this time, or if it is shown again within this time after
   it was last shown. It must then be admitted like a new session. */
static const int64_t HIDDEN_NS = 15 * NS_PER_S;

static void hold(struct session *session, int64_t pixels)
{
    int64_t more = pixels - session->room.pixels;
    session->context->admission->pixels += more;
    if (session->room.share)
        session->room.share->pixels += more;
    session->room.pixels = pixels;
}

/* Returns the pixels that the session takes from the admission budget. A tile (one display's part of a picture over many displays) takes
   only the pixels of its own display, because all tiles share one picture. */
static int64_t pixels_of(const struct session *session)
{
    const int *display_px = session->tile.layout.display_px;
    return session_is_tile(session) ? (int64_t)display_px[0] * display_px[1] : (int64_t)session->view.width_px * session->view.height_px;
}

bool session_reserve_pixels(struct session *session, int width_px, int height_px, struct message_error *error)
{
    const struct session_context *context = session->context;
    int64_t pixels = (int64_t)width_px * height_px, most = context->quotas->at[QUOTA_SESSION_PIXELS];
    enum refusal_code why = REFUSAL_NONE;
    if (pixels > most) {
        message_refuse_with(error, "limit", "width, height", REFUSAL_PIXELS_VIEW, "count=%lld", (long long)most);
        return false;
    }
    if (session->hello && pixels > session->room.pixels)
        why = admission_refuses_pixels(context->admission, session->room.share, session->room.pixels, pixels);
    if (why) {
        message_refuse(error, "limit", "width, height", why);
        return false;
    }
    hold(session, pixels);
    return true;
}

void session_release_pixels(struct session *session)
{
    hold(session, 0);
}

bool session_has_pixels(const struct session *session)
{
    return session->room.pixels > 0;
}

static bool take_again(struct session *session, enum refusal_code *why)
{
    int64_t pixels = pixels_of(session);
    *why = admission_refuses(session->context->admission, session->room.share, pixels);
    if (!*why)
        hold(session, pixels);
    return !*why;
}

/* If a session becomes visible but is not admitted, sends its client an error; pictures follow once there is capacity. */
void session_on_visible(struct session *session, bool visible, int64_t now_ns)
{
    struct message_error error = { 0 };
    enum refusal_code why;
    session->demand.any |= visible && session->hidden;
    if (session->hidden && visible && session->room.shown_ns && now_ns - session->room.shown_ns < HIDDEN_NS)
        hold(session, 0);
    if (session->hidden != !visible)
        *(visible ? &session->room.shown_ns : &session->room.hidden_ns) = now_ns;
    session->hidden = !visible;
    if (session->hidden || session_has_pixels(session) || take_again(session, &why))
        return;
    message_refuse(&error, "limit", "visible", why);
    session_reply_error(session, &error);
}

void session_keep_pixels(struct session *session, int64_t now_ns)
{
    enum refusal_code why;
    if (!session->hello || session->close.code)
        return;
    if (session->hidden && session_has_pixels(session) && now_ns - session->room.hidden_ns >= HIDDEN_NS)
        hold(session, 0);
    else if (!session->hidden && !session_has_pixels(session))
        take_again(session, &why);
}
