/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What people do at one daemon, done by another: a renderer hands it on, its core does it. Thread: the loop. */
#ifndef SESSION_SESSION_PROXY_H
#define SESSION_SESSION_PROXY_H
#include "session/session.h"

struct session_person {                /* the person who sent the message */
    const struct token_holder *holder; /* as this daemon verified */
    const char *refusal;               /* why nobody could be verified; NULL: somebody was */
    const char *from;                  /* the address, as the other daemon says */
    const char *through;               /* the other daemon and its token, for the audit trail */
};
/* Does what the message says, as that person: the answer says where it is no message that is handed on, or that person may not send.
   Returns a session that holds the answers, for session_answers_of(). */
struct session *session_do_for(const struct session_context *context, const struct session_person *person, const char *text, int64_t now_ns,
                               int64_t now_utc_ns);
/* Ends the session and returns its answers, JSON texts, once none waits for the disk; until then NULL. */
json_t *session_answers_of(struct session **session);

#endif
