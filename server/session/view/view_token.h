/* SPDX-License-Identifier: GPL-3.0-or-later */
/* View tokens: the view of a session as a signed text that its client keeps, so that any daemon with the key can restore it. A token is
   good for whoever's it was, for a day; it names nothing secret, and lets nobody in. Thread: the loop. */
#ifndef SESSION_VIEW_VIEW_TOKEN_H
#define SESSION_VIEW_VIEW_TOKEN_H
#include "session/session_context.h"
#include "session/view/resume.h"

enum { VIEW_TOKEN_KEY_BYTES = 32, VIEW_TOKEN_KEYS = 2 };

struct view_token_keys { /* the one that signs, and the one before, which is still believed. Count 0: there are no tokens */
    uint8_t at[VIEW_TOKEN_KEYS][VIEW_TOKEN_KEY_BYTES];
    int count;
};

/* Adds a key that signs from now on, if it is another. */
void view_token_add_key(struct view_token_keys *keys, const uint8_t key[VIEW_TOKEN_KEY_BYTES]);
/* Returns the session's resume secret followed by its view, signed; mem_free. NULL: there is no key, or the view is too large. */
char *view_token_make(const struct view_token_keys *keys, const struct session *session, int64_t now_utc_ns);
/* Reads a token that was made for the holder that session has. Returns false if it is none, for another, or too old. */
bool view_token_read(const struct view_token_keys *keys, const char *token, const struct session *session, int64_t now_utc_ns,
                     struct resumed *out);

#endif
