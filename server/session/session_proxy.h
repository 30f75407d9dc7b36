/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Carries out users' actions that another daemon forwarded: a renderer (daemon that draws for a core) sends them to its core,
   which acts on them. Call only in the event loop. */
#ifndef SESSION_SESSION_PROXY_H
#define SESSION_SESSION_PROXY_H
#include "session/session.h"

struct session_person {                /* user who sent the message to another daemon, which forwarded it */
    const struct token_holder *holder; /* the user's token or sign-in, verified by this daemon */
    const char *refusal;               /* reason why the user could not be verified; NULL: the user is verified */
    const char *from;                  /* the user's address, as reported by the other daemon */
    const char *through;               /* name of the other daemon and of its token, for the audit trail */
};
/* Acts on the message on behalf of the user who sent it. Returns a session that holds the answers, for session_answers_of().
   The answer is an error if renderers may not forward such a message, or the user may not send it. */
struct session *session_do_for(const struct session_context *context, const struct session_person *person, const char *text, int64_t now_ns,
                               int64_t now_utc_ns);
/* Returns NULL while an answer still waits for the disk. Once all are on disk, destroys the session and returns its answers, a
   JSON array of texts. */
json_t *session_answers_of(struct session **session);

#endif
