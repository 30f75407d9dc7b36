/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sign-in with OpenID Connect: authorization code flow with PKCE. Threads talk to the identity provider. The event loop begins log-ins,
   passes on the codes that browsers bring back, and looks up the users of cookies. The rights of all signed-in users are checked again
   at intervals; while the provider does not answer, these rights do not change. Thread: the event loop, unless said otherwise. */
#ifndef OPENID_OPENID_H
#define OPENID_OPENID_H
#include "access/openid/openid_config.h"
#include "access/openid/sign_ins.h"
#include "audit/audit.h"
#include "base/metrics/counters.h"

struct openid_params {
    struct log *log;
    struct counters *counters;
    struct audit *audit;     /* audit trail; NULL: nothing is recorded */
    const char *path;        /* path of the configuration file */
    int64_t lock_ns;         /* monotonic duration without activity after which a user is signed out; 0: never */
    void (*wake)(void *arg); /* called by any thread when openid_collect() has an answer, or rights changed */
    void *wake_arg;
};

struct openid;
/* Reads the configuration and starts the threads. Returns NULL on failure, already logged; an unreachable provider is no failure. */
struct openid *openid_start(const struct openid_params *params);
/* Ends the threads and all users' sessions. &NULL is allowed; sets *openid to NULL. */
void openid_stop(struct openid **openid);
const struct openid_config *openid_config_of(const struct openid *openid);

/* Begins a log-in. Returns the URL to which the browser must be redirected (mem_free); `binding` receives the cookie that the browser
   must bring back. Returns NULL with *why (static text) if the log-in cannot begin. */
char *openid_begin(struct openid *openid, const uint8_t address[16], const char *path, int64_t now_ns,
                   char binding[SIGN_IN_SECRET_CHARS + 1], const char **why);

struct openid_return { /* the parameters with which a browser returns from the provider; the texts may be NULL */
    uint64_t request;  /* id of the HTTP request; openid_collect() returns it with the answer */
    const char *state, *code, *iss, *error, *binding, *from;
};
enum openid_finish {
    OPENID_WAITS,   /* the result is not known yet; openid_collect() returns it later */
    OPENID_FOREIGN, /* no log-in of that browser with this state is in progress, so the request is a replay or a forgery; it is only
                       counted, not recorded */
    OPENID_FULL,    /* too many log-ins wait to be verified; the user must begin the log-in again */
};
/* Takes the parameters with which a browser returned from the provider. OPENID_WAITS means that the log-in is being verified. */
enum openid_finish openid_finish(struct openid *openid, const struct openid_return *brought, int64_t now_ns);

enum openid_result {
    OPENID_LET_IN,
    OPENID_REFUSED, /* recorded: the user logged in at the provider but may not use this server */
    OPENID_GUESSED, /* recorded, and counted like a wrong token: the authorization code was invalid */
    /* the log-in failed without a guess at a secret, for example because the provider does not answer or refuses this server; recorded only
       at intervals */
    OPENID_AWAY,
};

struct openid_answer {
    uint64_t request;
    uint8_t address[16]; /* address from which the log-in was begun */
    enum openid_result result;
    char cookie[SIGN_IN_SECRET_CHARS + 1]; /* cookie of the new session */
    char path[SIGN_IN_PATH_BYTES];         /* path of the page to which the browser returns */
    char *why;                             /* reason of the refusal; NULL: the user is signed in */
    struct openid_answer *next;
};
/* Returns a list of all answers that came since the last call; the caller frees each with openid_answer_free(). */
struct openid_answer *openid_collect(struct openid *openid);
void openid_answer_free(struct openid_answer *answer);

/* Returns true if a user's rights changed or ended since the last call. */
bool openid_take_changed(struct openid *openid);
/* Finds the user of a cookie. Returns false if there is none. */
bool openid_find(struct openid *openid, const char *cookie, struct token_holder *out);
/* Returns the present role of a user; ROLE_NOBODY: the user is not signed in (any more), or never was. */
enum role openid_role(struct openid *openid, const struct token_holder *holder);
/* Returns the newest ID token of a user who signed in at this daemon (mem_free), to be sent to a core that verifies it; NULL: there is
   none. */
char *openid_id_token(struct openid *openid, const struct token_holder *holder);
/* Verifies the ID token of a user who signed in at another daemon with the same provider and client. Uses the keys that are known here,
   without asking the provider. A token is accepted for `hours` after its `iat`, like a log-in. Returns NULL, with the user in *out, or
   the reason of the refusal (static text). */
const char *openid_vouch(struct openid *openid, const char *id_token, struct token_holder *out);
/* Records that a user is active at the page, which delays the automatic sign-out. */
void openid_touch(struct openid *openid, const struct token_holder *holder, int64_t now_ns);
/* Signs out the user of a cookie. Returns the URL at which the provider ends its own session as well (mem_free); NULL: there is none. */
char *openid_end(struct openid *openid, const char *cookie, const char *from);

#endif
