/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The file of tokens: a line each, `ROLE NAME SHA-256 [until YYYY-MM-DD]`. What it does not say is not let in: a file that is gone, or
   that others may write, lets in nobody. Thread: one. */
#ifndef ACCESS_TOKENS_H
#define ACCESS_TOKENS_H
#include "base/log.h"
#include "base/text.h"
#include "access/access.h"

enum { TOKEN_HASH_BYTES = 32, TOKEN_NAME_BYTES = 64 };

struct token_holder {
    enum role role;
    char name[TOKEN_NAME_BYTES];
    uint8_t hash[TOKEN_HASH_BYTES]; /* all 0: nobody's */
    int64_t until_utc_ns;           /* INT64_MAX: for ever */
};

struct tokens;
/* NULL: the file cannot be read, or is not for us alone; the reason is logged. Lines that are wrong are logged, and let in nobody. */
struct tokens *tokens_create(struct log *log, const char *path);
void tokens_destroy(struct tokens **tokens); /* &NULL is fine; leaves NULL */
/* Looks whether the file is another by now, and reads it once it has stopped changing. True: it was read. */
bool tokens_look(struct tokens *tokens);
size_t tokens_count(const struct tokens *tokens);

/* False: nobody's, or its time is over; then *out is whose it was, with its role, or ROLE_NOBODY. */
bool tokens_find(const struct tokens *tokens, const char *token, int64_t now_utc_ns, struct token_holder *out);
/* What the holder of a token may by now; ROLE_NOBODY: it was revoked, or its time is over. */
enum role tokens_role(const struct tokens *tokens, const struct token_holder *holder, int64_t now_utc_ns);

/* --- for `plantcast token` --- */
/* A line to a holder. 0: nothing is on it; 1: a holder; -1: *why says what is wrong. */
int tokens_parse_line(const char *line, struct token_holder *out, const char **why);
void tokens_hash(const char *token, uint8_t hash[TOKEN_HASH_BYTES]);
bool tokens_make(char token[TOKEN_MAX_CHARS + 1]); /* 256 random bits; false: there is no randomness */
void tokens_print_line(struct text *out, const struct token_holder *holder);
bool tokens_name_valid(const char *name);
/* YYYY-MM-DD, the last day (UTC). False: it is none. */
bool tokens_parse_day(const char *text, int64_t *until_utc_ns);

#endif
