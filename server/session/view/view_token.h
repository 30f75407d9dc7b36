/* SPDX-License-Identifier: GPL-3.0-or-later */
/* View tokens: a session's view as a signed text kept by its client, so that any daemon with the key can restore the view. A
   token is valid for a day, and only for the same user. It contains no secrets and grants no access. Call only in the event
   loop. */
#ifndef SESSION_VIEW_VIEW_TOKEN_H
#define SESSION_VIEW_VIEW_TOKEN_H
#include "session/session_context.h"
#include "session/view/resume.h"

enum { VIEW_TOKEN_KEY_BYTES = 32, VIEW_TOKEN_KEYS = 2 };

/* keys: at[0] signs new view tokens; tokens signed with at[1], the previous key, are still accepted. count 0: no view tokens are made */
struct view_token_keys {
    uint8_t at[VIEW_TOKEN_KEYS][VIEW_TOKEN_KEY_BYTES];
    int count;
};

/* Makes `key` the key that signs new view tokens, unless it already is; tokens signed with the previous key stay valid. */
void view_token_add_key(struct view_token_keys *keys, const uint8_t key[VIEW_TOKEN_KEY_BYTES]);
/* Returns the session's resume secret followed by its signed view; the caller frees it with mem_free. NULL: there is no key, or the view
   is too large. */
char *view_token_make(const struct view_token_keys *keys, const struct session *session, int64_t now_utc_ns);
/* Reads a token made for the session's user. Returns false if it is malformed, too old, or made for another user. */
bool view_token_read(const struct view_token_keys *keys, const char *token, const struct session *session, int64_t now_utc_ns,
                     struct resumed *out);

#endif
