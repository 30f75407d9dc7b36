/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Who is signing in, and who is signed in. Pure: time is handed in. Thread: one at a time. */
#ifndef OPENID_SIGN_INS_H
#define OPENID_SIGN_INS_H
#include "access/tokens.h"

enum { SIGN_IN_SECRET_CHARS = 43, SIGN_IN_PATH_BYTES = 1024, SIGN_INS = 4096, SIGN_INS_OF_ADDRESS = 16, PEOPLE = 512, PEOPLE_SAME = 16 };

struct sign_in { /* a log-in that was sent to the provider */
    char state[SIGN_IN_SECRET_CHARS + 1], nonce[SIGN_IN_SECRET_CHARS + 1], verifier[SIGN_IN_SECRET_CHARS + 1];
    char binding[SIGN_IN_SECRET_CHARS + 1]; /* a cookie of the browser that began it */
    char path[SIGN_IN_PATH_BYTES];          /* where it is to return to */
    uint8_t address[16];
    int64_t began_ns; /* 0: free */
};

struct person {                 /* who is signed in; members that are texts are owned */
    struct token_holder holder; /* its hash is that of the session's cookie */
    char *sub, *refresh_token, *access_token;
    char *id_token; /* the newest */
    int64_t access_until_s; /* UTC; 0: not said */
    int64_t active_ns;      /* monotonic: when the person was last at the page */
    int64_t check_ns;       /* monotonic: when rights are to be checked next */
    uint64_t number;
    bool checking; /* a thread is asking for them */
};

struct sign_ins;
struct sign_ins *sign_ins_create(void);
void sign_ins_destroy(struct sign_ins **table); /* &NULL is fine; leaves NULL */

/* Begins a log-in with fresh secrets. Each address has few, and the oldest gives way, so that nobody can push out others'. Returns it,
   valid until the next call; NULL: the system has no randomness. */
const struct sign_in *sign_ins_begin(struct sign_ins *table, const uint8_t address[16], const char *path, int64_t now_ns);
/* Takes out the log-in with that state, which thereby answers once only. Returns false if there is none, its time is over, or another
   browser began it. */
bool sign_ins_take(struct sign_ins *table, const char *state, const char *binding, int64_t now_ns, struct sign_in *out);

/* Adds a person; takes its texts. cookie: the session's new secret. *left: the refresh token of a session that had to make room (mem_free);
   NULL: none. Returns false if the system has no randomness. */
bool sign_ins_add_person(struct sign_ins *table, struct person *person, char cookie[SIGN_IN_SECRET_CHARS + 1], char **left);
/* Return the person of a cookie, of its hash, or with that number; NULL: none. Valid until the next call that adds or removes. */
struct person *sign_ins_find(struct sign_ins *table, const char *cookie);
struct person *sign_ins_find_hash(struct sign_ins *table, const uint8_t hash[TOKEN_HASH_BYTES]);
struct person *sign_ins_numbered(struct sign_ins *table, uint64_t number);
/* Returns the person whose rights are to be checked first; NULL: nobody is signed in, or all are being checked. */
struct person *sign_ins_next_check(struct sign_ins *table);
/* Removes a person. */
void sign_ins_remove(struct sign_ins *table, struct person *person);
/* Returns how many are signed in. */
size_t sign_ins_count(const struct sign_ins *table);

/* Writes the code challenge of a verifier (RFC 7636, S256). */
void sign_in_challenge(const char *verifier, char out[SIGN_IN_SECRET_CHARS + 1]);
/* Returns whether a page may be returned to: a path of this server, and no way to another. */
bool sign_in_path_good(const char *path);

#endif
