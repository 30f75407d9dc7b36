/* SPDX-License-Identifier: GPL-3.0-or-later */
/* State behind openid.h, and functions that the files openid*.c share. Private to them. */
#ifndef OPENID_OPENID_IMPL_H
#define OPENID_OPENID_IMPL_H
#include <jansson.h>
#include <pthread.h>
#include <stdatomic.h>

#include "access/openid/id_token.h"
#include "access/openid/openid.h"

/* OPENID_CODES: maximum number of authorization codes waiting to be exchanged for tokens; OPENID_CODES_OF_ADDRESS: the same for
   one client address */
enum { OPENID_CODES = 64, OPENID_CODES_OF_ADDRESS = 16 };

struct openid_job { /* a queued request to the provider: exchange the authorization code that a browser brought back, or revoke a token */
    uint64_t request;
    struct sign_in sign_in;
    /* code: authorization code to exchange for tokens; from: address of the client as text; revoke: refresh token to revoke;
       NULL: the job exchanges `code` */
    char *code, *from, *revoke;
    struct openid_job *next;
};

struct openid_jobs {
    struct openid_job *first, **last;
    int count;
};

/* Kinds of requests to the identity provider. Each request runs in a short-lived thread of its own. */
enum openid_task { OPENID_TASK_CODE, OPENID_TASK_CHECK, OPENID_TASK_REVOKE, OPENID_TASK_DISCOVER, OPENID_TASKS };

struct openid {
    struct openid_params params;
    struct openid_config *config;
    pthread_t thread; /* thread that starts the requests to the identity provider when they are due */
    bool started;
    counter *good, *people, *refused, *foreign;
    /* changed: a user's rights changed since the last openid_take_changed(); failing: the log already reports that the provider fails */
    _Atomic bool stopping, changed, failing;
    /* mutex held while the provider's metadata and keys are requested; a thread that already holds the mutex `lock` must not
       lock this one */
    pthread_mutex_t asking;
    /* --- below: protected by `asking` */
    /* jwks_ns: monotonic time when the provider's keys were last requested; discovered_ns: the same for its metadata; 0: never */
    int64_t jwks_ns, discovered_ns;
    /* --- below: protected by `lock` */
    pthread_mutex_t lock;
    pthread_cond_t wake;
    json_t *metadata, *jwks; /* the provider's metadata and keys; replaced under both locks, never modified. NULL: not known yet */
    struct sign_ins *table;
    struct openid_jobs codes, revocations;
    int running[OPENID_TASKS];
    int64_t discover_ns; /* monotonic time when the provider's metadata and keys must be requested again */
    struct openid_answer *answers;
    int64_t error_ns; /* monotonic time of the provider's last error recorded in the audit trail; 0: none yet */
};

/* --- openid_work.c --- */

/* Main function of the thread that starts due requests to the identity provider; its argument is the struct openid. Returns
   once openid->stopping is set and no request is running. */
void *openid_run(void *arg);
/* Queues the result of a log-in for openid_collect(); takes ownership of the text `why`. The caller holds the lock. */
void openid_add_answer(struct openid *openid, const struct openid_job *job, enum openid_result result, const char *cookie, char *why);
/* openid_record() writes an entry to the audit trail; openid_say_refused() does so too, and also logs and counts a refused log-in. */
void openid_record(struct openid *openid, const char *event, const char *result, const struct token_holder *holder, const char *from,
                   const char *what, const char *why);
void openid_say_refused(struct openid *openid, const char *from, const char *why);

/* --- functions of openid_jobs.c; the caller holds the lock, except for openid_free_job() --- */

/* Queues a request to the provider; takes ownership of its texts. */
void openid_add_job(struct openid *openid, struct openid_jobs *jobs, const struct openid_job *job);
void openid_free_jobs(struct openid_jobs *jobs);
/* Queues the revocation of a refresh token, which is copied, if the provider supports revocation. A NULL token is a no-op. */
void openid_revoke_later(struct openid *openid, const char *refresh_token);
/* Removes the oldest job from the queue and returns it; the caller frees it with openid_free_job(). The queue must not be empty. */
struct openid_job *openid_take_job(struct openid_jobs *jobs);
void openid_free_job(struct openid_job *job);

/* --- functions of openid_provider.c; called by any thread, without the lock --- */

/* Returns true if the provider's metadata and keys are known. */
bool openid_knows(struct openid *openid);
/* Requests the provider's metadata and keys if they are unknown or old. Returns true if they are known. */
bool openid_discover(struct openid *openid);
/* Reports in the log and the metrics whether the provider answers. why: the error; NULL: the provider answers. */
void openid_say(struct openid *openid, const char *why);
/* Returns the URL of one of the provider's endpoints, from its metadata; name: metadata key, such as "token_endpoint". Free with
   mem_free(). NULL: the provider has no such endpoint. */
char *openid_endpoint(struct openid *openid, const char *name);
/* Verifies an ID token; fetches the provider's keys if the token's key is unknown. Returns the token's claims (free with
   json_decref()), or NULL with the reason in *why (static text). *unsure true: the token may be valid, but its key is unknown
   and the keys could not be fetched. */
json_t *openid_verify(struct openid *openid, const char *token, const char *nonce, const char *sub, bool *unsure, const char **why);
/* Adds claims from the provider's UserInfo endpoint if the user's groups or name are missing. Returns false if the provider
 * refuses. *told receives true if the claims are complete now; false if groups may be missing only because the provider was not
 * asked or did not answer. */
bool openid_complete(struct openid *openid, json_t *claims, const char *access_token, bool *told);

/* --- functions of openid_tokens.c; called by any thread, without the lock --- */

/* Exchanges an authorization code at the provider for tokens. Returns the user who logged in, not yet in the table of signed-in users;
   NULL with *result and *why (mem_free) if the log-in failed. */
struct person *openid_redeem(struct openid *openid, const struct openid_job *job, enum openid_result *result, char **why);
enum openid_rights { RIGHTS_UNKNOWN, RIGHTS_GONE, RIGHTS_SAME };
/* Rechecks a signed-in user's rights at the provider. Updates role and tokens of `person`, a copy that owns its texts. Returns
   RIGHTS_UNKNOWN if the provider does not answer. *why: static text. */
enum openid_rights openid_check(struct openid *openid, struct person *person, const char **why);
/* Revokes a refresh token at the provider, if the provider supports that. */
void openid_revoke(struct openid *openid, const char *token);

#endif
