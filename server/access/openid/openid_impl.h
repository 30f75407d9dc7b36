/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The state behind openid.h. Private to openid*.c. */
#ifndef OPENID_OPENID_IMPL_H
#define OPENID_OPENID_IMPL_H
#include <jansson.h>
#include <pthread.h>
#include <stdatomic.h>

#include "access/openid/id_token.h"
#include "access/openid/openid.h"

/* maximum number of codes that wait to be exchanged for tokens: in total, and per address */
enum { OPENID_CODES = 64, OPENID_CODES_OF_ADDRESS = 16 };

struct openid_job { /* job: a code that a browser brought back, or a token to revoke */
    uint64_t request;
    struct sign_in sign_in;
    char *code, *from, *revoke; /* revoke: a refresh token to revoke; NULL: redeem `code` */
    struct openid_job *next;
};

struct openid_jobs {
    struct openid_job *first, **last;
    int count;
};

/* Kinds of tasks; each task runs in a short-lived thread of its own. */
enum openid_task { OPENID_TASK_CODE, OPENID_TASK_CHECK, OPENID_TASK_REVOKE, OPENID_TASK_DISCOVER, OPENID_TASKS };

struct openid {
    struct openid_params params;
    struct openid_config *config;
    pthread_t thread; /* starts tasks that are due */
    bool started;
    counter *good, *people, *refused, *foreign;
    /* changed: rights changed since the last openid_take_changed(); failing: it was logged that the provider fails */
    _Atomic bool stopping, changed, failing;
    pthread_mutex_t asking; /* held while metadata and keys are requested; never taken while `lock` is held */
    /* --- below: protected by `asking` */
    int64_t jwks_ns, discovered_ns; /* monotonic: when keys and metadata were last requested; 0: never */
    /* --- below: protected by `lock` */
    pthread_mutex_t lock;
    pthread_cond_t wake;
    json_t *metadata, *jwks; /* the provider's metadata and keys; replaced under both locks, never modified. NULL: not known yet */
    struct sign_ins *table;
    struct openid_jobs codes, revocations;
    int running[OPENID_TASKS];
    int64_t discover_ns; /* monotonic: when metadata and keys are due to be checked */
    struct openid_answer *answers;
    int64_t error_ns; /* monotonic: when an error of the provider was last recorded; 0: never */
};

/* --- openid_work.c --- */

/* Main function of the thread that starts tasks; its argument is the struct openid. Returns once openid->stopping is set and no task
   runs. */
void *openid_run(void *arg);
/* Queues a job; takes its texts. The caller holds the lock. */
void openid_add_job(struct openid *openid, struct openid_jobs *jobs, const struct openid_job *job);
void openid_free_jobs(struct openid_jobs *jobs);
/* Queues the revocation of a copy of a refresh token, if the provider supports that; NULL: does nothing. The caller holds the lock. */
void openid_revoke_later(struct openid *openid, const char *refresh_token);
/* Queues an answer; takes ownership of the text `why`. The caller holds the lock. */
void openid_add_answer(struct openid *openid, const struct openid_job *job, enum openid_result result, const char *cookie, char *why);
/* Write an entry to the audit trail; openid_say_refused() also logs and counts it. */
void openid_record(struct openid *openid, const char *event, const char *result, const struct token_holder *holder, const char *from,
                   const char *what, const char *why);
void openid_say_refused(struct openid *openid, const char *from, const char *why);

/* --- openid_provider.c; any thread, without the lock --- */

/* Returns whether metadata and keys are known. */
bool openid_knows(struct openid *openid);
/* Requests metadata and keys if they are unknown or old. Returns whether they are known. */
bool openid_discover(struct openid *openid);
/* Reports in the log and the metrics whether the provider answers. why NULL: the provider answers. */
void openid_say(struct openid *openid, const char *why);
/* Returns an endpoint URL from the metadata (mem_free); NULL: there is none. */
char *openid_endpoint(struct openid *openid, const char *name);
/* Verifies an ID token, fetching new keys if needed. Returns its claims (json_decref); NULL with *why (static text). *unsure: the
   token's key is unknown, and the provider's present keys could not be fetched. */
json_t *openid_verify(struct openid *openid, const char *token, const char *nonce, const char *sub, bool *unsure, const char **why);
/* Adds claims from the provider's UserInfo endpoint if groups or name are missing. Returns false if the provider refuses. *told: the
   claims are now complete; otherwise groups may be missing only because the provider was not asked or did not answer. */
bool openid_complete(struct openid *openid, json_t *claims, const char *access_token, bool *told);

/* --- openid_tokens.c; any thread, without the lock --- */

/* Redeems a code. Returns the person, not yet in the table; NULL with *result and *why (mem_free). */
struct person *openid_redeem(struct openid *openid, const struct openid_job *job, enum openid_result *result, char **why);
enum openid_rights { RIGHTS_UNKNOWN, RIGHTS_GONE, RIGHTS_SAME };
/* Checks a person's rights again; updates role and tokens of `person`, a copy that owns its texts. RIGHTS_UNKNOWN: the provider does not
   answer. *why: static text. */
enum openid_rights openid_check(struct openid *openid, struct person *person, const char **why);
/* Revokes a refresh token, if the provider supports that. */
void openid_revoke(struct openid *openid, const char *token);

#endif
