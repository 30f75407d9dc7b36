/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The state of openid.h's thread. Private to openid*.c. */
#ifndef OPENID_OPENID_IMPL_H
#define OPENID_OPENID_IMPL_H
#include <jansson.h>
#include <pthread.h>
#include <stdatomic.h>

#include "access/openid/id_token.h"
#include "access/openid/openid.h"

struct openid_job { /* a browser came back with a code, or a token is to be revoked */
    uint64_t request;
    struct sign_in sign_in;
    char *code, *from, *revoke; /* revoke: a refresh token, and nothing else */
    struct openid_job *next;
};

struct openid {
    struct openid_params params;
    struct openid_config *config;
    pthread_t thread;
    bool started;
    counter *good, *people, *refused;
    _Atomic bool stopping, changed; /* changed: of rights, not told to the loop yet */
    /* --- below: of the thread */
    json_t *jwks;
    int64_t jwks_ns, discovered_ns; /* monotonic: when they were last asked for; 0: never */
    bool failing;
    pthread_mutex_t lock;
    pthread_cond_t wake;
    /* --- below: under lock */
    json_t *metadata; /* of the provider; replaced, never changed. NULL: not known yet */
    struct sign_ins *table;
    struct openid_job *jobs, **last_job;
    struct openid_answer *answers;
};

/* --- openid_provider.c; thread: its own --- */

/* Asks for metadata and keys where they are not known, or old. Returns whether they are known. */
bool openid_discover(struct openid *openid);
/* Says in the log and the metrics whether the provider answers. why: NULL: it does. */
void openid_say(struct openid *openid, const char *why);
/* Returns an address of the metadata (mem_free); NULL: there is none. */
char *openid_endpoint(struct openid *openid, const char *name);
/* Verifies an ID token, with new keys if need be. Returns its claims (json_decref); NULL with *why (static). */
json_t *openid_verify(struct openid *openid, const char *token, const char *nonce, const char *sub, const char **why);
/* Adds what the provider tells about a person (UserInfo) to the claims, where they lack groups or name. Returns false if it refuses. *told:
   whether the claims are all that it tells; else groups may be missing because it was not asked, or did not answer. */
bool openid_complete(struct openid *openid, json_t *claims, const char *access_token, bool *told);

/* --- openid_tokens.c; thread: its own --- */

/* Redeems a code. Returns the person, who is not in the table yet; NULL with *why (mem_free). */
struct person *openid_redeem(struct openid *openid, const struct openid_job *job, char **why);
enum openid_rights { RIGHTS_UNKNOWN, RIGHTS_GONE, RIGHTS_SAME };
/* Asks for a person's rights again, and changes role and tokens of `person`, a copy that owns its texts. RIGHTS_UNKNOWN: the provider does
   not answer. *why: static. */
enum openid_rights openid_check(struct openid *openid, struct person *person, const char **why);
/* Revokes a refresh token, if the provider can. */
void openid_revoke(struct openid *openid, const char *token);

#endif
