/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The file of tokens: one per line, `ROLE NAME SHA-256 [until YYYY-MM-DD] [unattended] [views ID,... | display WALL:NUMBER]
   [plant PLANT]`. A token that is not in it, or is for another plant, is not accepted; nor is any, once the file is gone or others may
   write it. Thread: one. */
#ifndef ACCESS_TOKENS_H
#define ACCESS_TOKENS_H
#include "base/log/log.h"
#include "base/text/text.h"
#include "access/access.h"
#include "plant/walls/wall.h"

enum { TOKEN_HASH_BYTES = 32, TOKEN_NAME_BYTES = 64, TOKEN_PLANT_BYTES = 128, TOKEN_VIEWS_BYTES = 256 };

struct token_holder {
    enum role role;
    char name[TOKEN_NAME_BYTES];
    uint8_t hash[TOKEN_HASH_BYTES]; /* all 0: no holder */
    int64_t until_utc_ns;           /* INT64_MAX: for ever */
    char plant[TOKEN_PLANT_BYTES];  /* the name of the only plant that it is for; "": any */
    char views[TOKEN_VIEWS_BYTES];  /* ids, with commas: it is good for pictures of these views of the plant file only; "": for all */
    bool unattended;                /* of a wall or a program: it is not locked when nobody is at the page */
    bool signed_in;                 /* a person, by the identity provider; the hash is that of a cookie */
    char wall[NAMED_VIEW_ID_BYTES]; /* of a display: the only one that it may be */
    int display;                    /* likewise; 0: it is none */
};

struct tokens;
/* Reads the file. Returns NULL if it cannot be read, or if others than its owner may write it; the reason is logged. Lines that are wrong
   are logged and skipped. */
struct tokens *tokens_create(struct log *log, const char *path);
/* Says which plant this is: tokens for others are not accepted. The name is copied. */
void tokens_set_plant(struct tokens *tokens, const char *plant);
/* Has it accept paired devices, too: find(pairings, ...) is pairings_find. pairings must outlive it, or the next call. */
typedef bool tokens_find_device(const void *pairings, const uint8_t hash[TOKEN_HASH_BYTES], struct token_holder *out);
void tokens_set_pairings(struct tokens *tokens, tokens_find_device *find, const void *pairings);
void tokens_destroy(struct tokens **tokens); /* &NULL is fine; leaves NULL */
/* Reads the file again if it changed and has stopped changing. Returns whether it was read. */
bool tokens_look(struct tokens *tokens);
/* Returns how many tokens are in force. */
size_t tokens_count(const struct tokens *tokens);
/* Returns whether a token of the file has that name. */
bool tokens_has_name(const struct tokens *tokens, const char *name);

/* Looks a token up, in the file and among paired devices, and writes its holder into *out. Returns false if it is in neither (then
   out->role is ROLE_NOBODY), or has expired. */
bool tokens_find(const struct tokens *tokens, const char *token, int64_t now_utc_ns, struct token_holder *out);
/* Returns the role that the holder of a token has now; ROLE_NOBODY: the token was revoked, has expired, or is for other views or another
   display now. */
enum role tokens_role(const struct tokens *tokens, const struct token_holder *holder, int64_t now_utc_ns);

/* --- for `plantcast token` --- */
/* Parses a line of the file into *out. Returns 1; 0 for an empty line or a comment; -1 with *why (static) saying what is wrong. */
int tokens_parse_line(const char *line, struct token_holder *out, const char **why);
/* Writes the SHA-256 of a token. */
void tokens_hash(const char *token, uint8_t hash[TOKEN_HASH_BYTES]);
/* Makes a token of 256 random bits. Returns false if the system has no randomness. */
bool tokens_make(char token[TOKEN_MAX_CHARS + 1]);
/* Appends the line of a holder. */
void tokens_print_line(struct text *out, const struct token_holder *holder);
/* Returns whether a holder may have that name. */
bool tokens_name_valid(const char *name);
/* Returns whether a token may be for a plant of that name: it stands in a line. */
bool tokens_plant_valid(const char *plant);
/* Returns whether a token may be for these views: ids with commas. */
bool tokens_views_valid(const char *views);
/* Reads the display that a token is for, WALL:NUMBER, into *out. Returns false if it is none. */
bool tokens_parse_display(const char *text, struct token_holder *out);
/* Returns what the holder may do: ROLE_OPEN (pictures, and no more) where the token is for some views. */
enum role tokens_role_of(const struct token_holder *holder);
/* Returns whether the holder may see that view. */
bool tokens_may_see(const struct token_holder *holder, const char *view);
/* Parses YYYY-MM-DD, the last day (UTC) on which a token is valid. Returns false if it is not a date. */
bool tokens_parse_day(const char *text, int64_t *until_utc_ns);

#endif
