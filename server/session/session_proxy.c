/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Implements sessions without a client. Each exists for one message forwarded by another daemon. */
#include "session/session_proxy.h"

#include <stdio.h>
#include <string.h>

#include "message/message_parse.h"
#include "message/role.h"
#include "session/session_impl.h"

static void act_as(struct session *session, const struct session_person *person, const char *text, int64_t now_ns, int64_t now_utc_ns)
{
    struct message message;
    struct message_error error;
    session->hello = true;
    session->identity.holder = *person->holder;
    session->identity.role = tokens_role_of(person->holder);
    session->identity.login = LOGIN_GOOD;
    snprintf(session->identity.through, sizeof(session->identity.through), "%s", person->through);
    snprintf(session->identity.from, sizeof(session->identity.from), "%s", person->from);
    if (!message_parse(session->context->plant, text, strlen(text), &message, &error)) {
        session_reply_error(session, &error);
    } else if (!message_is_handed_on(&message)) {
        message_fail(&error, "not_allowed", "this message is not allowed from a client of a renderer (daemon that draws for a core)");
        session_reply_error(session, &error);
    } else if (person->refusal) {
        message_fail(&error, "not_allowed", "not done: %s", person->refusal);
        session_record_refusal(session, &error);
        session_reply_error(session, &error);
    } else {
        session_on_message(session, text, strlen(text), now_ns, now_utc_ns);
    }
}

struct session *session_do_for(const struct session_context *context, const struct session_person *person, const char *text, int64_t now_ns,
                               int64_t now_utc_ns)
{
    struct session *session = session_create(context, 0, now_ns);
    act_as(session, person, text, now_ns, now_utc_ns);
    return session;
}

json_t *session_answers_of(struct session **session)
{
    session_settle(*session);
    if ((*session)->kept)
        return NULL;
    json_t *texts = json_array();
    for (int i = 0; i < (*session)->owed.reply_count; i++)
        json_array_append_new(texts, json_string((*session)->owed.replies[i]));
    session_destroy(session);
    return texts;
}
