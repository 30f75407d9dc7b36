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
/* Does what the message says, as that person, and returns the answers, JSON texts, the caller's; with an error where it is no message
   that is handed on, or that person may not send. */
json_t *session_do_for(const struct session_context *context, const struct session_person *person, const char *text, int64_t now_ns,
                       int64_t now_utc_ns);

#endif
