/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tables of log-ins in progress and of signed-in users. The caller passes the time. Call from one thread at a time. */
#ifndef OPENID_SIGN_INS_H
#define OPENID_SIGN_INS_H
#include "access/tokens.h"

enum { SIGN_IN_SECRET_CHARS = 43, SIGN_IN_PATH_BYTES = 1024, SIGN_INS = 4096, SIGN_INS_OF_ADDRESS = 16, PEOPLE = 512, PEOPLE_SAME = 16 };

struct sign_in { /* a log-in in progress: the browser has been redirected to the provider and has not returned yet */
    char state[SIGN_IN_SECRET_CHARS + 1], nonce[SIGN_IN_SECRET_CHARS + 1], verifier[SIGN_IN_SECRET_CHARS + 1];
    /* value of the cookie that proves that the same browser returns that began the log-in */
    char binding[SIGN_IN_SECRET_CHARS + 1];
    char path[SIGN_IN_PATH_BYTES]; /* path of the page to show after the log-in */
    uint8_t address[16];
    int64_t began_ns; /* monotonic time when the log-in began; 0: this table entry is free */
};

struct person {                 /* a session of a signed-in user; the struct owns its texts */
    struct token_holder holder; /* the user's name and role; `hash` is the hash of the session cookie */
    char *sub, *refresh_token, *access_token;
    char *id_token;         /* newest ID token of the user */
    int64_t access_until_s; /* expiry of the access token, in seconds since 1970 UTC; 0: not known */
    int64_t active_ns;      /* monotonic time when the user was last active on the page */
    int64_t check_ns;       /* monotonic time when the user's rights must next be checked at the provider */
    uint64_t number;
    bool checking; /* true: a thread is checking the user's rights */
};

struct sign_ins;
struct sign_ins *sign_ins_create(void);
void sign_ins_destroy(struct sign_ins **table); /* frees the table and sets *table to NULL; accepts a pointer to NULL */

/* Begins a log-in with new secrets. An address may have SIGN_INS_OF_ADDRESS log-ins in progress; a further log-in replaces the
   oldest of the same address. If the table is full, it replaces the oldest log-in of all. Returns the log-in, valid until the
   next call; NULL: the system's random number generator failed. */
const struct sign_in *sign_ins_begin(struct sign_ins *table, const uint8_t address[16], const char *path, int64_t now_ns);
/* Removes the log-in that the OpenID value `state` identifies from the table and copies it to *out, so that it can be completed
   only once. Returns false if there is none, it has expired, or another browser began it. */
bool sign_ins_take(struct sign_ins *table, const char *state, const char *binding, int64_t now_ns, struct sign_in *out);

/* Adds a session of a signed-in user; takes ownership of the texts of `person`. cookie: receives the new session's secret.
   *left receives a refresh token that is no longer used, for example that of a session removed to make room (free with
   mem_free()); NULL: none. Returns false if the system's random number generator failed. */
bool sign_ins_add_person(struct sign_ins *table, struct person *person, char cookie[SIGN_IN_SECRET_CHARS + 1], char **left);
/* Return the session with a given cookie, hash of a cookie, or number; NULL: there is none. The result is valid until a session
   is added or removed. */
struct person *sign_ins_find(struct sign_ins *table, const char *cookie);
struct person *sign_ins_find_hash(struct sign_ins *table, const uint8_t hash[TOKEN_HASH_BYTES]);
struct person *sign_ins_numbered(struct sign_ins *table, uint64_t number);
/* Returns the signed-in user whose rights check is due first; NULL: nobody is signed in, or all users are being checked. */
struct person *sign_ins_next_check(struct sign_ins *table);
/* Removes a session and frees its texts. */
void sign_ins_remove(struct sign_ins *table, struct person *person);
/* Returns the number of sessions of signed-in users. */
size_t sign_ins_count(const struct sign_ins *table);

/* Writes the PKCE code challenge for a code verifier (RFC 7636, S256). */
void sign_in_challenge(const char *verifier, char out[SIGN_IN_SECRET_CHARS + 1]);
/* Returns true if `path` stays on this server and cannot lead to another host, so that a browser may be redirected to it after
   the log-in. */
bool sign_in_path_good(const char *path);

#endif
