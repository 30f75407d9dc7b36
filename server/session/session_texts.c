/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a session is to be told in words, and when. */
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"
#include "message/alarm_text.h"
#include "message/prove_message.h"
#include "session/reply.h"
#include "session/session_impl.h"
#include "session/tag_text_cache.h"

static const int64_t TAGS_NS = 500 * NS_PER_MS; /* changed values, at most this often */

static void add_owned(struct text *out, char *text)
{
    text_add_bytes(out, text, strlen(text));
    mem_free(text);
}

static void add_reply(struct session *session, struct text *out)
{
    add_owned(out, session->replies[0]);
    session->reply_count--;
    memmove(session->replies, session->replies + 1, (size_t)session->reply_count * sizeof(session->replies[0]));
}

static bool tags_due(const struct session *session, int64_t now_ns)
{
    return session->hello && !session->hidden && !session_is_open(session) &&
           (session->owes_tags_all || (session->owes_tags && now_ns - session->tags_ns >= TAGS_NS));
}

static bool status_due(const struct session *session)
{
    return session->hello && !session->hidden && session->owes_status;
}

static bool alarms_due(const struct session *session)
{
    const struct session_context *world = session->world;
    return session->hello && !session->hidden && !session_is_open(session) && world->alarm_service &&
           (!session->alarms_said || alarm_service_number(world->alarm_service) > session->alarms_number);
}

static bool loop_checks_due(const struct session *session)
{
    const struct loop_checks *loop_checks = session->world->loop_checks;
    return session->hello && !session_is_open(session) && loop_checks &&
           (session->owes_loop_checks || loop_checks_number(loop_checks) > session->loop_checks_said);
}

static void add_proofs(struct session *session, struct text *out)
{
    const struct session_context *world = session->world;
    add_owned(out, loop_checks_text(world->loop_checks, world->plant, session->loop_checks_said, session->owes_loop_checks));
    session->loop_checks_said = loop_checks_number(world->loop_checks);
    session->owes_loop_checks = false;
}

bool session_has_text(const struct session *session, int64_t now_ns)
{
    return session->owes_welcome || session->reply_count > 0 || session->owes_params || session->owes_following || session->owes_time ||
           session->followers || loop_checks_due(session) || status_due(session) || alarms_due(session) || tags_due(session, now_ns);
}

static void add_tags(struct session *session, int64_t now_ns, struct text *out)
{
    const struct session_context *world = session->world;
    const struct snapshot *snapshot = session_snapshot(session);
    struct tag_text_cache *said = snapshot == world->snapshot ? world->tags_said : NULL;
    add_owned(out, tag_text_cache_get(said, world->plant, snapshot, session->tag_changes, session->owes_tags_all));
    session->owes_tags = session->owes_tags_all = false;
    session->tags_ns = now_ns;
}

bool session_next_text(struct session *session, int64_t now_ns, int64_t now_utc_ns, struct text *out)
{
    const struct session_context *world = session->world;
    if (session->owes_welcome) {
        add_owned(out, reply_welcome_text(session, now_utc_ns));
        session->owes_welcome = false;
    } else if (session->reply_count > 0) {
        add_reply(session, out);
    } else if (session->owes_params) {
        add_owned(out, reply_params_text(world, &session->view, session->params_seq, session_is_open(session)));
        session->owes_params = false;
    } else if (session->owes_following) {
        add_owned(out, reply_following_text(session));
        session->owes_following = false;
    } else if (session->owes_time) {
        add_owned(out, reply_time_text(session));
        session->owes_time = false;
        session->told_beginning = session->world->history_first_us != 0;
    } else if (session->followers) {
        add_owned(out, session->followers);
        session->followers = NULL;
    } else if (loop_checks_due(session)) {
        add_proofs(session, out);
    } else if (status_due(session)) {
        add_owned(out, reply_status_text(world, now_utc_ns));
        session->owes_status = false;
    } else if (alarms_due(session)) {
        add_owned(out, alarms_text(world->alarms_said, world->alarm_service, world->plant, now_utc_ns, &session->alarms_number));
        session->alarms_said = true;
    } else if (tags_due(session, now_ns)) {
        add_tags(session, now_ns, out);
    } else {
        return false;
    }
    return true;
}
