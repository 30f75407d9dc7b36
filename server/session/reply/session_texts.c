/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Chooses the next JSON message for a client, and the time to send it. */
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"
#include "message/alarm_text.h"
#include "message/loop_check_message.h"
#include "session/reply/reply.h"
#include "session/reply/tag_text_cache.h"
#include "session/session_impl.h"

/* minimum time in nanoseconds between two `tags` messages (changed readings) to a client */
static const int64_t TAGS_NS = 500 * NS_PER_MS;

static void add_owned(const struct session *session, struct text *out, char *text)
{
    text = session_scope_text(session, text);
    text_add_bytes(out, text, strlen(text));
    mem_free(text);
}

static void add_reply(struct session *session, struct text *out)
{
    add_owned(session, out, session->owed.replies[0]);
    session->owed.reply_count--;
    memmove(session->owed.replies, session->owed.replies + 1, (size_t)session->owed.reply_count * sizeof(session->owed.replies[0]));
}

bool session_tags_due(const struct session *session, int64_t now_ns)
{
    return session->hello && !session->hidden && !session_is_open(session) &&
           (session->owed.tags_all || (session->owed.tags && now_ns - session->owed.tags_ns >= TAGS_NS));
}

static bool status_due(const struct session *session)
{
    return session->hello && !session->hidden && session->owed.status;
}

static bool alarms_due(const struct session *session)
{
    const struct session_context *context = session->context;
    return session->hello && !session->hidden && !session_is_open(session) && context->services->alarm_service &&
           (!session->owed.alarms_sent || alarm_service_number(context->services->alarm_service) > session->owed.alarms_number);
}

static bool loop_checks_due(const struct session *session)
{
    const struct loop_checks *loop_checks = session->context->services->loop_checks;
    return session->hello && !session_is_open(session) && !session->identity.holder.display && loop_checks &&
           (session->owed.loop_checks || loop_checks_number(loop_checks) > session->owed.loop_checks_sent);
}

static bool views_due(const struct session *session)
{
    return session->hello && !session_is_open(session) && session->context->services->named_views &&
           named_views_number(session->context->services->named_views) > session->owed.views_sent;
}

/* Returns whether the list of notes must be sent: after a change of the notes, and when a session that shows the past moves to
   an instant that had other notes. */
static bool notes_due(const struct session *session)
{
    const struct notes *notes = session->context->services->notes;
    if (!session->hello || session_is_open(session) || !notes || notes_number(notes) == 0)
        return false;
    int64_t sent_us = session->owed.notes_at_us, at_us = session_view(session)->at_us;
    bool other_instant = (sent_us == 0) != (at_us == 0) || (at_us != sent_us && notes_differ(notes, sent_us, at_us));
    return other_instant || notes_number(notes) > session->owed.notes_sent;
}

static bool walls_due(const struct session *session)
{
    return session->hello && !session_is_open(session) && session->context->services->wall_remote &&
           wall_remote_number(session->context->services->wall_remote) > session->owed.walls_sent;
}

static bool pointers_due(const struct session *session)
{
    return session->hello && session->display.display > 0 && !session_is_open(session) &&
           wall_remote_pointer_number(session->context->services->wall_remote) > session->owed.pointers_sent;
}

static void add_loop_checks(struct session *session, struct text *out)
{
    const struct session_context *context = session->context;
    add_owned(session, out,
              loop_checks_text(context->services->loop_checks, context->plant, session->owed.loop_checks_sent, session->owed.loop_checks));
    session->owed.loop_checks_sent = loop_checks_number(context->services->loop_checks);
    session->owed.loop_checks = false;
}

bool session_has_text(const struct session *session, int64_t now_ns)
{
    return session->owed.welcome || session->owed.reply_count > 0 || session->owed.params || session->owed.following ||
           session->owed.time || session->following.followers_text || loop_checks_due(session) || views_due(session) ||
           notes_due(session) || walls_due(session) || pointers_due(session) || status_due(session) || alarms_due(session) ||
           session_tags_due(session, now_ns);
}

static void add_tags(struct session *session, int64_t now_ns, struct text *out)
{
    const struct session_context *context = session->context;
    const struct snapshot *snapshot = session_snapshot(session);
    struct tag_text_cache *cache = snapshot == context->readings.snapshot ? context->caches.tag_texts : NULL;
    add_owned(session, out, tag_text_cache_get(cache, context->plant, snapshot, session->owed.tag_changes, session->owed.tags_all));
    session->owed.tags = session->owed.tags_all = false;
    session->owed.tags_ns = now_ns;
}

bool session_next_text(struct session *session, int64_t now_ns, int64_t now_utc_ns, struct text *out)
{
    const struct session_context *context = session->context;
    if (session->owed.welcome) {
        add_owned(session, out, reply_welcome_text(session, now_utc_ns));
        session->owed.welcome = false;
    } else if (session->owed.reply_count > 0) {
        add_reply(session, out);
    } else if (session->owed.params) {
        add_owned(session, out, reply_params_text(context, &session->view, session->owed.params_seq, session_is_open(session)));
        session->owed.params = false;
    } else if (session->owed.following) {
        add_owned(session, out, reply_following_text(session));
        session->owed.following = false;
    } else if (session->owed.time) {
        add_owned(session, out, reply_time_text(session));
        session->owed.time = false;
        session->owed.told_beginning = session->context->readings.history_first_us != 0;
    } else if (session->following.followers_text) {
        add_owned(session, out, session->following.followers_text);
        session->following.followers_text = NULL;
    } else if (loop_checks_due(session)) {
        add_loop_checks(session, out);
    } else if (views_due(session)) {
        add_owned(session, out, reply_views_text(context, NULL));
        session->owed.views_sent = named_views_number(context->services->named_views);
    } else if (notes_due(session)) {
        session->owed.notes_at_us = session_view(session)->at_us;
        session->owed.notes_sent = notes_number(context->services->notes);
        int64_t at_us = session->owed.notes_at_us;
        add_owned(session, out,
                  at_us ? notes_text_between(context->services->notes, at_us, at_us)
                        : notes_text(context->services->notes, now_utc_ns / 1000));
    } else if (walls_due(session)) {
        add_owned(session, out, wall_remote_text(context->services->wall_remote));
        session->owed.walls_sent = wall_remote_number(context->services->wall_remote);
    } else if (pointers_due(session)) {
        add_owned(session, out, wall_remote_pointers_text(context->services->wall_remote, session->owed.pointers_sent));
        session->owed.pointers_sent = wall_remote_pointer_number(context->services->wall_remote);
    } else if (status_due(session)) {
        add_owned(session, out, reply_status_text(context, session->identity.role, now_utc_ns));
        session->owed.status = false;
    } else if (alarms_due(session)) {
        add_owned(session, out,
                  alarms_text(context->caches.alarm_texts, context->services->alarm_service, context->plant, now_utc_ns,
                              &session->owed.alarms_number));
        session->owed.alarms_sent = true;
    } else if (session_tags_due(session, now_ns)) {
        add_tags(session, now_ns, out);
    } else {
        return false;
    }
    return true;
}
