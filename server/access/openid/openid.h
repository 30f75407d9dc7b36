/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Signing people in by OpenID Connect: authorization code flow with PKCE. Threads ask the identity provider; the loop begins log-ins, hands
   in what browsers bring back, and asks who a cookie belongs to. Rights of all who are signed in are asked for again and again, beside
   log-ins; while the provider does not answer they stay as they are. Thread: the loop, unless it says otherwise. */
#ifndef OPENID_OPENID_H
#define OPENID_OPENID_H
#include "access/openid/openid_config.h"
#include "access/openid/sign_ins.h"
#include "audit/audit.h"
#include "base/metrics/counters.h"

struct openid_params {
    struct log *log;
    struct counters *counters;
    struct audit *audit;     /* NULL: nothing is recorded */
    const char *path;        /* of its file */
    int64_t lock_ns;         /* who was not at the page for so long is signed out; 0: nobody is */
    void (*wake)(void *arg); /* called by any thread when openid_collect has an answer, or rights changed */
    void *wake_arg;
};

struct openid;
/* Reads the file and starts to ask. Returns NULL if that fails, already logged; a provider that does not answer is no failure. */
struct openid *openid_start(const struct openid_params *params);
/* Ends it, and all sessions of people. &NULL is fine; leaves NULL. */
void openid_stop(struct openid **openid);
const struct openid_config *openid_config_of(const struct openid *openid);

/* Begins a log-in. Returns the URL to send the browser to (mem_free), and the cookie that it has to bring back; NULL with *why (static). */
char *openid_begin(struct openid *openid, const uint8_t address[16], const char *path, int64_t now_ns,
                   char binding[SIGN_IN_SECRET_CHARS + 1], const char **why);

struct openid_return { /* what a browser brings back from the provider; texts may be NULL */
    uint64_t request;  /* names the answer */
    const char *state, *code, *iss, *error, *binding, *from;
};
enum openid_finish {
    OPENID_WAITS,   /* an answer will come (openid_collect) */
    OPENID_FOREIGN, /* no log-in of that browser waits for this: a replay, or a forgery; it is counted, and nothing else */
    OPENID_FULL,    /* too many wait; the log-in has to begin again */
};
/* Hands it in. */
enum openid_finish openid_finish(struct openid *openid, const struct openid_return *brought, int64_t now_ns);

enum openid_result {
    OPENID_LET_IN,
    OPENID_REFUSED, /* recorded: somebody logged in there, and may not be let in */
    OPENID_GUESSED, /* recorded; counts as a wrong token does: nobody logged in there */
    OPENID_AWAY,    /* nobody's guess, as when the provider does not answer, or refuses us: not recorded one by one */
};

struct openid_answer {
    uint64_t request;
    uint8_t address[16]; /* from which the log-in was begun */
    enum openid_result result;
    char cookie[SIGN_IN_SECRET_CHARS + 1]; /* of the new session */
    char path[SIGN_IN_PATH_BYTES];         /* to return to */
    char *why;                             /* NULL: let in */
    struct openid_answer *next;
};
/* Returns all answers that have come, as a list; free each with openid_answer_free. */
struct openid_answer *openid_collect(struct openid *openid);
void openid_answer_free(struct openid_answer *answer);

/* Returns whether somebody's rights changed, or ended, since the last call. */
bool openid_take_changed(struct openid *openid);
/* Finds whose cookie it is. Returns false if nobody's. */
bool openid_find(struct openid *openid, const char *cookie, struct token_holder *out);
/* Returns the role that a holder has now; ROLE_NOBODY: the person is not signed in (any more), or was none. */
enum role openid_role(struct openid *openid, const struct token_holder *holder);
/* Returns the newest ID token of a person who is signed in here, for a core that verifies it (mem_free); NULL: there is none. */
char *openid_id_token(struct openid *openid, const struct token_holder *holder);
/* Verifies the ID token of a person who is signed in at another daemon of the same provider and client, with the keys that are known here:
   no request is made. A token is good for `hours` from its `iat`, as a log-in is. Returns NULL and the person in *out, or the reason of
   the refusal (static). */
const char *openid_vouch(struct openid *openid, const char *id_token, struct token_holder *out);
/* Notes that a person is at the page. */
void openid_touch(struct openid *openid, const struct token_holder *holder, int64_t now_ns);
/* Signs a person out. Returns the URL at which the provider signs it out as well (mem_free); NULL: there is none. */
char *openid_end(struct openid *openid, const char *cookie, const char *from);

#endif
