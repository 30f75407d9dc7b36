/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Time travel of a session: going to an instant, playback, and the return to the present. */
#include <math.h>

#include "base/clock.h"
#include "history/history.h"
#include "session/session_impl.h"

static const int64_t STEP_NS = 100 * NS_PER_MS; /* minimum time between two steps of playback, each of which shows a later instant */
/* minimum time between two steps of playback with a speed below SLOW_SPEED. It is longer than STEP_NS, because readings then
   change little from step to step */
static const int64_t SLOW_STEP_NS = 500 * NS_PER_MS;
static const double SLOW_SPEED = 10;

void session_tell_time(struct session *session)
{
    int64_t at_us = session_view(session)->at_us;
    session->owed.time = true;
    session->owed.tags = true;
    /* sends all tags again, because reading.changes of current readings and of historical ones are unrelated counters */
    session->owed.tags_all |= (at_us != 0) != (session->owed.told_at_us != 0);
    session->owed.told_at_us = at_us;
}

static void show(struct session *session, const struct historical_snapshot *historical, int64_t now_ns)
{
    struct travel *travel = &session->travel;
    if (travel->historical)
        snapshot_cache_give(session->context->services->snapshot_cache, &travel->historical);
    travel->historical = historical;
    travel->first = false;
    view_set_instant(&session->view, historical ? historical->at_us : 0, historical ? historical->slot : 0);
    session_tell_time(session);
    session_on_input(session, now_ns);
}

static void come_back(struct session *session, int64_t now_ns)
{
    session->travel.wanted_us = 0;
    session->travel.asked = false;
    session->travel.speed = 0;
    show(session, NULL, now_ns);
}

static void go(struct session *session, int64_t at_us)
{
    session->travel.wanted_us = at_us;
    session->travel.asked = false;
}

static void play(struct session *session, double speed, int64_t from_us, int64_t now_ns)
{
    session->travel.speed = speed;
    session->travel.from_us = from_us;
    session->travel.from_ns = session->travel.stepped_ns = now_ns;
    session->owed.time = true;
}

static void refuse(struct session *session, enum refusal_code why)
{
    struct message_error error = { .about = "time" };
    message_refuse(&error, "no_history", NULL, why);
    session_reply_error(session, &error);
}

void session_time_begin(struct session *session, int64_t at_us, double speed, int64_t now_utc_ns)
{
    if (at_us == 0 || at_us > now_utc_ns / 1000)
        return;
    if (!session->context->services->snapshot_cache) {
        refuse(session, REFUSAL_UNRECORDED);
        return;
    }
    session->travel.first = true;
    session->travel.speed = speed;
    go(session, at_us);
}

void session_time_leave(struct session *session)
{
    session_time_end(session);
    session->travel = (struct travel){ .historical = NULL };
    view_set_instant(&session->view, 0, 0);
    session_tell_time(session);
}

void session_time_end(struct session *session)
{
    if (session->travel.historical)
        snapshot_cache_give(session->context->services->snapshot_cache, &session->travel.historical);
}

void session_time_inherit(struct session *heir, const struct session *session)
{
    struct travel *travel = &heir->travel;
    const struct historical_snapshot *historical =
        session->travel.historical ? snapshot_cache_take(session->context->services->snapshot_cache, session->view.at_us) : NULL;
    session_time_end(heir);
    *travel = session->travel;
    travel->historical = historical;
    travel->asked = travel->first = false;
    view_set_instant(&heir->view, historical ? historical->at_us : 0, historical ? historical->slot : 0);
    session_tell_time(heir);
}

bool session_on_time(struct session *session, const struct time_request *request, int64_t now_ns, int64_t now_utc_ns,
                     struct message_error *error)
{
    struct travel *travel = &session->travel;
    int64_t newest_us = now_utc_ns / 1000 - HISTORY_SETTLED_US, here_us = travel->wanted_us ? travel->wanted_us : session->view.at_us;
    if (request->has_at && request->at_us == 0) {
        come_back(session, now_ns);
        return true;
    }
    if (!session->context->services->snapshot_cache) {
        message_refuse(error, "no_history", NULL, REFUSAL_UNRECORDED);
        return false;
    }
    if (!request->has_at && here_us == 0) {
        message_fail(error, "bad_field", "speed: allowed only for a past time; give the start time in at_us");
        return false;
    }
    int64_t at_us = request->has_at ? request->at_us : here_us;
    if (at_us > newest_us) {
        come_back(session, now_ns);
        return true;
    }
    play(session, request->speed, at_us, now_ns);
    if (request->has_at)
        go(session, at_us);
    return true;
}

/* Advances playback to the instant that is due now. Returns false if playback has reached the present. */
static bool step(struct session *session, int64_t now_ns, int64_t now_utc_ns)
{
    struct travel *travel = &session->travel;
    int64_t at_us = travel->from_us + (int64_t)((double)(now_ns - travel->from_ns) / 1000 * travel->speed);
    travel->stepped_ns = now_ns;
    if (at_us > now_utc_ns / 1000 - HISTORY_SETTLED_US) {
        come_back(session, now_ns);
        return false;
    }
    if (travel->speed < 0 && at_us <= session->context->readings.history_first_us) {
        at_us = session->context->readings.history_first_us;
        travel->speed = 0;
    }
    go(session, at_us);
    return true;
}

bool session_wants_historical_snapshot(struct session *session, int64_t now_ns, int64_t now_utc_ns, int64_t *at_us)
{
    struct travel *travel = &session->travel;
    int64_t step_ns = fabs(travel->speed) < SLOW_SPEED ? SLOW_STEP_NS : STEP_NS;
    bool due = travel->speed != 0 && travel->historical && !travel->wanted_us && !session->hidden && now_ns - travel->stepped_ns >= step_ns;
    if (due && !step(session, now_ns, now_utc_ns))
        return false;
    if (!travel->wanted_us || travel->asked)
        return false;
    travel->asked = true;
    *at_us = travel->wanted_us;
    return true;
}

static void on_failure(struct session *session)
{
    refuse(session, REFUSAL_UNREADABLE);
    session->travel.wanted_us = 0;
    session->travel.asked = session->travel.first = false;
    session->travel.speed = 0;
    session->owed.time = true;
}

/* Shows the loaded instant at_us even if the client has since requested a later one. So a user who drags the time slider sees
   pictures while dragging. */
void session_on_historical_snapshot(struct session *session, int64_t at_us, bool good, int64_t now_ns)
{
    struct travel *travel = &session->travel;
    if (!travel->wanted_us)
        return;
    const struct historical_snapshot *historical = good ? snapshot_cache_take(session->context->services->snapshot_cache, at_us) : NULL;
    if (!historical) {
        on_failure(session);
        return;
    }
    if (at_us == travel->wanted_us) {
        travel->wanted_us = 0;
        travel->asked = false;
        if (travel->speed != 0 && travel->first)
            play(session, travel->speed, at_us, now_ns);
    }
    show(session, historical, now_ns);
}
