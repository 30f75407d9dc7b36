/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Placing and checking sensors in an engineer's session. Other sessions do not see trial positions. */
#include "base/mem.h"
#include "message/place_message.h"
#include "message/loop_check_message.h"
#include "session/session_impl.h"

void session_say(struct session *session, const char *text)
{
    session_reply(session, mem_strdup(text));
}

void session_place_leave(struct session *session)
{
    place_set_destroy(&session->placement.set);
    tag_save_free(session->placement.save);
    session->placement.save = NULL;
    view_set_trial(&session->view, 0);
}

static bool can_place(const struct session *session, struct message_error *error)
{
    if (session->context->services->placing)
        return true;
    message_fail(error, "not_allowed", "this server cannot place sensors");
    return false;
}

/* Draws the session's view with the trial positions of the sensors that the client is placing, and sends these positions to the client. */
static void show(struct session *session, int64_t now_ns)
{
    view_set_trial(&session->view, place_set_trial(session->placement.set));
    session_on_input(session, now_ns);
    session_reply(session, placed_text(session->context->plant, session->placement.set, session->placement.seq));
}

bool session_on_place(struct session *session, const struct message *message, int64_t now_ns, struct message_error *error)
{
    struct refusal why;
    if (!can_place(session, error))
        return false;
    if (!session->placement.set)
        session->placement.set = place_set_create(session->context->services->placing);
    if (!place_set_moves(session->placement.set, message->place.moves, message->place.count, &why)) {
        message_refuse_with(error, "bad_field", "moves", why.code, "%s", why.args);
        return false;
    }
    session->placement.seq = message->seq;
    show(session, now_ns);
    return true;
}

void session_on_placed(struct session *session, int64_t now_ns)
{
    if (session->placement.set && place_set_changed(session->placement.set))
        show(session, now_ns);
}

bool session_ask_coverage(struct session *session, const struct message *message, struct message_error *error)
{
    const struct session_context *context = session->context;
    int group = message->coverage.group >= 0 ? message->coverage.group : session->view.field.group;
    if (!can_place(session, error))
        return false;
    placing_request_coverage(context->services->placing, session->placement.set, group, message->coverage.far_m, context->readings.snapshot,
                             session->id, message->seq);
    return true;
}

void session_on_coverage(struct session *session, const struct sensor_coverage_answer *answer)
{
    session_reply(session, coverage_text(session->context->services->scene, session->placement.set, answer));
}

struct tag_save *session_take_save(struct session *session)
{
    struct tag_save *save = session->placement.save;
    session->placement.save = NULL;
    return save;
}

bool session_save_tags(struct session *session, const struct message *message, struct message_error *error)
{
    const struct session_context *context = session->context;
    const struct placed *placed;
    if (!can_place(session, error))
        return false;
    if (!context->services->tag_list) {
        message_refuse(error, "not_allowed", NULL, REFUSAL_UNREAD);
        return false;
    }
    bool moves = message->type == MESSAGE_SAVE_TAGS;
    if (moves && (!session->placement.set || place_set_get(session->placement.set, &placed) == 0)) {
        message_refuse(error, "bad_field", "save_tags", REFUSAL_UNMOVED);
        return false;
    }
    if (context->records.saving) {
        session_reply(session, tags_refused_text(message->seq, &(struct refusal){ .code = REFUSAL_BUSY }));
        return true;
    }
    tag_save_free(session->placement.save);
    session_reply(session, tags_diff_text(context->services->scene, context->services->tag_list, session->placement.set, message,
                                          session_who(session), &session->placement.save));
    if (session->placement.save)
        session_record_save(session, message, moves ? place_set_get(session->placement.set, &placed) : 0);
    return true;
}

bool session_check_loop(struct session *session, const struct message *message, struct message_error *error)
{
    const struct session_context *context = session->context;
    enum refusal_code why = loop_checks_refusal(context->services->loop_checks);
    if (why) {
        message_refuse(error, "no_history", NULL, why);
        return false;
    }
    const struct kept_action action = session_kept_begin(session);
    char *answer = loop_check_do(context->services->loop_checks, context->plant, context->readings.snapshot, message, session_who(session));
    session_kept_reply(session, &action, "proof", session_loop_check_what(session, message, answer), answer);
    return true;
}
