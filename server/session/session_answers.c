/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Functions that queue a session's answers, drop its frames, record user input and close the session. */
#include <string.h>

#include "base/mem.h"
#include "session/reply/reply.h"
#include "session/session_impl.h"

void session_close(struct session *session, int code, const char *text)
{
    if (session->close.code)
        return;
    session->close.code = code;
    session->close.text = text;
}

void session_reply(struct session *session, char *text)
{
    /* the queue is full because the client reads nothing, so the oldest answer is dropped */
    if (session->owed.reply_count == SESSION_MAX_REPLIES) {
        mem_free(session->owed.replies[0]);
        memmove(session->owed.replies, session->owed.replies + 1, sizeof(session->owed.replies) - sizeof(session->owed.replies[0]));
        session->owed.reply_count--;
    }
    session->owed.replies[session->owed.reply_count++] = text;
}

void session_reply_error(struct session *session, const struct message_error *error)
{
    session->stats.errors++;
    session_reply(session, reply_error_text(error));
}

void session_drop_ready(struct session *session)
{
    for (struct encoded_frame *encoded = session->delivery.ready, *next; encoded; encoded = next) {
        next = encoded->next;
        session->stats.dropped++;
        pacer_dropped(&session->delivery.pacer, session_times(&encoded->request));
        encoded_frame_destroy(&encoded);
    }
    session->delivery.ready = NULL;
}

void session_on_input(struct session *session, int64_t now_ns)
{
    session->demand.input = true;
    session->demand.refined = REFINED_NOT;
    session->demand.failure_said = false;
    session->demand.input_ns = now_ns;
    if (!session->demand.starting_ns)
        session->demand.starting_ns = now_ns;
}

const char *session_who(const struct session *session)
{
    return session->identity.holder.name[0] ? session->identity.holder.name : "local";
}
