/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The state of openid.h. Private to openid*.c. */
#ifndef OPENID_OPENID_IMPL_H
#define OPENID_OPENID_IMPL_H
#include <jansson.h>
#include <pthread.h>
#include <stdatomic.h>

#include "access/openid/id_token.h"
#include "access/openid/openid.h"

enum { OPENID_CODES = 64, OPENID_CODES_OF_ADDRESS = 16 }; /* that wait to be redeemed */

struct openid_job { /* a browser came back with a code, or a token is to be revoked */
    uint64_t request;
    struct sign_in sign_in;
    char *code, *from, *revoke; /* revoke: a refresh token, and nothing else */
    struct openid_job *next;
};

struct openid_jobs {
    struct openid_job *first, **last;
    int count;
};

/* What is under way: each piece in a thread of its own, that lives as long as it does. */
enum openid_task { OPENID_TASK_CODE, OPENID_TASK_CHECK, OPENID_TASK_REVOKE, OPENID_TASK_DISCOVER, OPENID_TASKS };

struct openid {
    struct openid_params params;
    struct openid_config *config;
    pthread_t thread; /* hands out what is due */
    bool started;
    counter *good, *people, *refused, *foreign;
    _Atomic bool stopping, changed, failing; /* changed: of rights, not told to the loop yet; failing: said so */
    pthread_mutex_t asking;                  /* for metadata and keys; never taken under `lock` */
    /* --- below: under asking */
    int64_t jwks_ns, discovered_ns; /* monotonic: when they were last asked for; 0: never */
    /* --- below: under lock */
    pthread_mutex_t lock;
    pthread_cond_t wake;
    json_t *metadata, *jwks; /* of the provider; replaced, under both locks, never changed. NULL: not known yet */
    struct sign_ins *table;
    struct openid_jobs codes, revocations;
    int running[OPENID_TASKS];
    int64_t discover_ns; /* monotonic: when metadata and keys are to be looked at next */
    struct openid_answer *answers;
    int64_t error_ns; /* monotonic: when an error of the provider was recorded last; 0: never */
};

/* --- openid_work.c --- */

/* The thread that hands out what is due; its argument is the struct openid. Returns when that is stopping and nothing is under way. */
void *openid_run(void *arg);
/* To be called under the lock. Takes the job's texts. */
void openid_add_job(struct openid *openid, struct openid_jobs *jobs, const struct openid_job *job);
void openid_free_jobs(struct openid_jobs *jobs);
/* To be called under the lock. Has a copy of a refresh token revoked, if the provider can; NULL: nothing. */
void openid_revoke_later(struct openid *openid, const char *refresh_token);
/* To be called under the lock. Takes why. */
void openid_add_answer(struct openid *openid, const struct openid_job *job, enum openid_result result, const char *cookie, char *why);
/* Write a line of the trail; the latter one of the log, too, and counts. */
void openid_record(struct openid *openid, const char *event, const char *result, const struct token_holder *holder, const char *from,
                   const char *what, const char *why);
void openid_say_refused(struct openid *openid, const char *from, const char *why);

/* --- openid_provider.c; any thread, without the lock --- */

/* Returns whether metadata and keys are known. */
bool openid_knows(struct openid *openid);
/* Asks for them where they are not known, or old. Returns whether they are known. */
bool openid_discover(struct openid *openid);
/* Says in the log and the metrics whether the provider answers. why: NULL: it does. */
void openid_say(struct openid *openid, const char *why);
/* Returns an address of the metadata (mem_free); NULL: there is none. */
char *openid_endpoint(struct openid *openid, const char *name);
/* Verifies an ID token, with new keys if need be. Returns its claims (json_decref); NULL with *why (static). *unsure: its key is not
   among those that are known, and the provider's present ones could not be had. */
json_t *openid_verify(struct openid *openid, const char *token, const char *nonce, const char *sub, bool *unsure, const char **why);
/* Adds what the provider tells about a person (UserInfo) to the claims, where they lack groups or name. Returns false if it refuses. *told:
   whether the claims are all that it tells; else groups may be missing because it was not asked, or did not answer. */
bool openid_complete(struct openid *openid, json_t *claims, const char *access_token, bool *told);

/* --- openid_tokens.c; any thread, without the lock --- */

/* Redeems a code. Returns the person, who is not in the table yet; NULL with *result and *why (mem_free). */
struct person *openid_redeem(struct openid *openid, const struct openid_job *job, enum openid_result *result, char **why);
enum openid_rights { RIGHTS_UNKNOWN, RIGHTS_GONE, RIGHTS_SAME };
/* Asks for a person's rights again, and changes role and tokens of `person`, a copy that owns its texts. RIGHTS_UNKNOWN: the provider does
   not answer. *why: static. */
enum openid_rights openid_check(struct openid *openid, struct person *person, const char **why);
/* Revokes a refresh token, if the provider can. */
void openid_revoke(struct openid *openid, const char *token);

#endif
