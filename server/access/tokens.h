/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The token file: one token per line, `ROLE NAME SHA-256 [until YYYY-MM-DD] [unattended] [views ID,... | display WALL:NUMBER]
   [plant PLANT]`. A token that is not in the file or is for another plant is refused. All tokens are refused if the file is
   missing or users other than its owner may write it. Call from one thread only. */
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
    uint8_t hash[TOKEN_HASH_BYTES]; /* SHA-256 of the token; all 0: no token */
    int64_t until_utc_ns;           /* time when the token expires (UTC); INT64_MAX: never */
    char plant[TOKEN_PLANT_BYTES];  /* name of the only plant for which the token is valid; empty: any plant */
    /* comma-separated ids of saved views: the token gives access to their pictures only; empty: not restricted */
    char views[TOKEN_VIEWS_BYTES];
    bool unattended;                /* true: token of a wall or a program, which is not signed out for lack of user activity */
    bool signed_in;                 /* true: a user signed in through the identity provider; `hash` is the hash of the session cookie */
    char wall[NAMED_VIEW_ID_BYTES]; /* id of the wall with the only display for which the token is valid; empty: not restricted */
    int display;                    /* number of that display on the wall, from 1; 0: not restricted */
};

struct tokens;
/* Reads the token file. Returns NULL (logged) if it cannot be read or if users other than its owner may write it. Invalid lines
   are logged and skipped. */
struct tokens *tokens_create(struct log *log, const char *path);
/* Sets (copies) the name of this plant; from now on, tokens for other plants are refused. */
void tokens_set_plant(struct tokens *tokens, const char *plant);
/* Makes tokens_find() accept paired devices (access/pairings.h) as well. `find` is pairings_find(), and `pairings` its struct
   pairings, which must stay valid until the next call. */
typedef bool tokens_find_device(const void *pairings, const uint8_t hash[TOKEN_HASH_BYTES], struct token_holder *out);
void tokens_set_pairings(struct tokens *tokens, tokens_find_device *find, const void *pairings);
void tokens_destroy(struct tokens **tokens); /* frees the tokens and sets *tokens to NULL; accepts a pointer to NULL */
/* Reads the token file again if it has changed and is no longer being written. Returns true if it was read. */
bool tokens_look(struct tokens *tokens);
/* Returns true if the file has a token whose holder has that name. */
bool tokens_has_name(const struct tokens *tokens, const char *name);

/* Finds the holder of a token, in the file or among paired devices, and writes it to *out. Returns false if there is none
   (out->role is then ROLE_NOBODY), or if the token has expired. */
bool tokens_find(const struct tokens *tokens, const char *token, int64_t now_utc_ns, struct token_holder *out);
/* Returns the current role of a token's holder; ROLE_NOBODY: the token was revoked, has expired, or is now restricted to other
   views or another display. */
enum role tokens_role(const struct tokens *tokens, const struct token_holder *holder, int64_t now_utc_ns);

/* --- for `plantcast token` --- */
/* Parses a line of the token file into *out. Returns 1 on success, 0 for an empty line or a comment, -1 with *why (static text)
   for an invalid line. */
int tokens_parse_line(const char *line, struct token_holder *out, const char **why);
/* Computes the SHA-256 hash under which a token is stored and looked up. */
void tokens_hash(const char *token, uint8_t hash[TOKEN_HASH_BYTES]);
/* Generates a token of 256 random bits. Returns false if the system's random number generator failed. */
bool tokens_make(char token[TOKEN_MAX_CHARS + 1]);
/* Appends to `out` the line of the token file that describes the token's holder. */
void tokens_print_line(struct text *out, const struct token_holder *holder);
/* Returns true if the name is valid for a token's holder. */
bool tokens_name_valid(const char *name);
/* Returns true if a token may be restricted to a plant of that name: the name must fit on one line of the token file. */
bool tokens_plant_valid(const char *plant);
/* Returns true if the text is a valid list of saved views for a token: ids, comma separated. */
bool tokens_views_valid(const char *views);
/* Parses WALL:NUMBER, the only display that a token may show, into *out. Returns false if the text is invalid. */
bool tokens_parse_display(const char *text, struct token_holder *out);
/* Returns the holder's effective role: ROLE_OPEN (pictures only) if the token is restricted to some saved views. */
enum role tokens_role_of(const struct token_holder *holder);
/* Returns true if the holder may see that saved view. */
bool tokens_may_see(const struct token_holder *holder, const char *view);
/* Parses YYYY-MM-DD, the last day (UTC) on which a token is valid. Returns false if it is not a date. */
bool tokens_parse_day(const char *text, int64_t *until_utc_ns);

#endif
