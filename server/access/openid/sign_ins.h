/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Log-ins in progress, and signed-in people. Pure: the caller passes the time. Thread: one at a time. */
#ifndef OPENID_SIGN_INS_H
#define OPENID_SIGN_INS_H
#include "access/tokens.h"

enum { SIGN_IN_SECRET_CHARS = 43, SIGN_IN_PATH_BYTES = 1024, SIGN_INS = 4096, SIGN_INS_OF_ADDRESS = 16, PEOPLE = 512, PEOPLE_SAME = 16 };

struct sign_in { /* a log-in whose browser was redirected to the provider */
    char state[SIGN_IN_SECRET_CHARS + 1], nonce[SIGN_IN_SECRET_CHARS + 1], verifier[SIGN_IN_SECRET_CHARS + 1];
    char binding[SIGN_IN_SECRET_CHARS + 1]; /* cookie that ties the log-in to the browser that began it */
    char path[SIGN_IN_PATH_BYTES];          /* page to return to */
    uint8_t address[16];
    int64_t began_ns; /* monotonic time when the log-in began; 0: the entry is free */
};

struct person {                 /* a signed-in person; the struct owns its texts */
    struct token_holder holder; /* the person's name, role and rights; `hash` is that of the session cookie */
    char *sub, *refresh_token, *access_token;
    char *id_token;         /* the newest ID token */
    int64_t access_until_s; /* expiry of the access token, in seconds since 1970 UTC; 0: not known */
    int64_t active_ns;      /* monotonic time when the person was last active at the page */
    int64_t check_ns;       /* monotonic time when the person's rights must be checked next */
    uint64_t number;
    bool checking; /* true: a thread is checking the rights */
};

struct sign_ins;
struct sign_ins *sign_ins_create(void);
void sign_ins_destroy(struct sign_ins **table); /* frees the table and sets *table to NULL; accepts a pointer to NULL */

/* Begins a log-in with new secrets. Each address may have a few log-ins in progress; a new one replaces the address's own oldest one, so
   that no address displaces another's. Returns the log-in, valid until the next call; NULL: the system has no randomness. */
const struct sign_in *sign_ins_begin(struct sign_ins *table, const uint8_t address[16], const char *path, int64_t now_ns);
/* Removes the log-in with that state from the table, so that it can be answered only once, and copies it out. Returns false if there is
   none, it has expired, or another browser began it. */
bool sign_ins_take(struct sign_ins *table, const char *state, const char *binding, int64_t now_ns, struct sign_in *out);

/* Adds a signed-in person; takes ownership of its texts. cookie: receives the new session's secret. *left receives the refresh token of
   a session that was removed to make room (mem_free); NULL: none was. Returns false if the system has no randomness. */
bool sign_ins_add_person(struct sign_ins *table, struct person *person, char cookie[SIGN_IN_SECRET_CHARS + 1], char **left);
/* sign_ins_find(), sign_ins_find_hash() and sign_ins_numbered() return the person with a cookie, a cookie's hash or a person number;
   NULL: nobody. The result is valid until the next call that adds or removes a person. */
struct person *sign_ins_find(struct sign_ins *table, const char *cookie);
struct person *sign_ins_find_hash(struct sign_ins *table, const uint8_t hash[TOKEN_HASH_BYTES]);
struct person *sign_ins_numbered(struct sign_ins *table, uint64_t number);
/* Returns the person whose rights check is due first; NULL: nobody is signed in, or all rights are being checked. */
struct person *sign_ins_next_check(struct sign_ins *table);
/* Removes a person. */
void sign_ins_remove(struct sign_ins *table, struct person *person);
/* Returns the number of signed-in people. */
size_t sign_ins_count(const struct sign_ins *table);

/* Writes the code challenge of a verifier (RFC 7636, S256). */
void sign_in_challenge(const char *verifier, char out[SIGN_IN_SECRET_CHARS + 1]);
/* Returns true if `path` is a path on this server that cannot lead to another host, so that a browser may be redirected to it after the
   log-in. */
bool sign_in_path_good(const char *path);

#endif
