/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sign-in with OpenID Connect: authorization code flow with PKCE. Background threads talk to the identity provider. The event
   loop begins log-ins, passes on the codes that browsers bring back, and finds the user of a session cookie. Users' rights are
   rechecked at the provider at intervals; while the provider does not answer, they stay unchanged. Call only in the event loop,
   unless said otherwise. */
#ifndef OPENID_OPENID_H
#define OPENID_OPENID_H
#include "access/openid/openid_config.h"
#include "access/openid/sign_ins.h"
#include "audit/audit.h"
#include "base/metrics/counters.h"

struct openid_params {
    struct log *log;
    struct counters *counters;
    struct audit *audit;     /* audit trail in which log-ins and refusals are recorded; NULL: nothing is recorded */
    const char *path;        /* path of the configuration file */
    int64_t lock_ns;         /* nanoseconds of inactivity after which a user is signed out; 0: never */
    /* called on any thread when openid_collect() has the result of a log-in, or a signed-in user's rights changed */
    void (*wake)(void *arg);
    void *wake_arg;
};

struct openid;
/* Reads the configuration and starts the threads that talk to the provider. Returns NULL on failure, already logged; an unreachable
   provider is not a failure. */
struct openid *openid_start(const struct openid_params *params);
/* Ends the threads and the sessions of all users. Accepts a pointer to NULL; sets *openid to NULL. */
void openid_stop(struct openid **openid);
const struct openid_config *openid_config_of(const struct openid *openid);

/* Begins a log-in. Returns the URL at the provider to redirect the browser to (free with mem_free()). `binding` receives a
   cookie that the same browser must bring back. Returns NULL with *why (static text) if the log-in cannot begin. */
char *openid_begin(struct openid *openid, const uint8_t address[16], const char *path, int64_t now_ns,
                   char binding[SIGN_IN_SECRET_CHARS + 1], const char **why);

struct openid_return { /* parameters of the request with which a browser returns from the provider; the texts may be NULL */
    uint64_t request;  /* id of the HTTP request; openid_collect() returns it along with the answer */
    const char *state, *code, *iss, *error, *binding, *from;
};
enum openid_finish {
    OPENID_WAITS, /* OPENID_WAITS: the provider is being asked whether the log-in is genuine; openid_collect() returns the result later */
    /* this browser began no log-in with the value of the parameter `state` that it sent: a replay or a forgery, which is only
       counted, not recorded in the audit trail */
    OPENID_FOREIGN,
    OPENID_FULL, /* too many log-ins are waiting for verification; the user must try again */
};
/* Handles the request with which a browser returns from the provider. */
enum openid_finish openid_finish(struct openid *openid, const struct openid_return *brought, int64_t now_ns);

enum openid_result {
    OPENID_LET_IN,
    OPENID_REFUSED, /* the user logged in at the provider but may not use this server; recorded in the audit trail */
    OPENID_GUESSED, /* the authorization code was invalid; recorded in the audit trail and counted as a wrong token */
    /* the log-in failed for another reason, for example because the provider does not answer or refuses this server; recorded
       only at intervals */
    OPENID_AWAY,
};

struct openid_answer {
    uint64_t request;
    uint8_t address[16]; /* address of the client that began the log-in */
    enum openid_result result;
    char cookie[SIGN_IN_SECRET_CHARS + 1]; /* value of the cookie for the new session */
    char path[SIGN_IN_PATH_BYTES];         /* path of the page to which the browser is redirected */
    char *why;                             /* why the log-in was refused; NULL: the user is signed in */
    struct openid_answer *next;
};
/* Returns the list of log-in results since the last call; the caller frees each with openid_answer_free(). */
struct openid_answer *openid_collect(struct openid *openid);
void openid_answer_free(struct openid_answer *answer);

/* Returns true if any user's rights changed or ended since the last call. */
bool openid_take_changed(struct openid *openid);
/* Finds the signed-in user that a session cookie belongs to. Returns false if there is none. */
bool openid_find(struct openid *openid, const char *cookie, struct token_holder *out);
/* Returns the current role of a user; ROLE_NOBODY: the user is not signed in. */
enum role openid_role(struct openid *openid, const struct token_holder *holder);
/* Returns the newest ID token of a user who signed in at this daemon (free with mem_free()); NULL: there is none. The daemon
   sends the token to a core, which verifies it. */
char *openid_id_token(struct openid *openid, const struct token_holder *holder);
/* Verifies the ID token of a user who signed in at another daemon with the same provider and client id. Uses only the keys
   known here and sends no request to the provider. A token is accepted for config->hours after it was issued, which is also how
   long a log-in lasts. Returns NULL and the user in *out, or the reason for the refusal (static text). */
const char *openid_vouch(struct openid *openid, const char *id_token, struct token_holder *out);
/* Records user activity on the page, which postpones the automatic sign-out. */
void openid_touch(struct openid *openid, const struct token_holder *holder, int64_t now_ns);
/* Signs out the user of a session cookie. Returns the URL that also ends the user's session at the provider (free with
   mem_free()); NULL: there is none. */
char *openid_end(struct openid *openid, const char *cookie, const char *from);

#endif
