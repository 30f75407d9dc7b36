/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How a display is let in where nobody types a token: it makes a secret of its own, shows the six digits that the server has for it, and
   keeps the secret in a file once an engineer has entered them. Thread: that of the links, under the player's lock. */
#ifndef WALL_PAIRING_H
#define WALL_PAIRING_H
#include "access/access.h"
#include "link.h"

enum { PAIRING_PATH_BYTES = 600 };
enum pairing_state {
    PAIRING_NOT,     /* it is let in, or was not refused yet */
    PAIRING_ASKS,    /* it waits for digits */
    PAIRING_SHOWS,   /* digits are to be shown */
    PAIRING_CROWDED, /* too many displays wait for theirs */
    PAIRING_NOWHERE, /* the server has no such display */
    PAIRING_NEVER    /* this server lets nobody in by digits */
};

struct pairing {
    bool enabled;           /* false: there is a token or there is none, as daemon.h has it */
    const char *token_path; /* of --token-file; NULL: none */
    char state_path[PAIRING_PATH_BYTES]; /* where the secret is kept if that cannot be written, or is not there; "": nowhere */
    char path[PAIRING_PATH_BYTES];       /* what is asked for */
    enum pairing_state state;
    char digits[8];
    int64_t until_ns; /* monotonic: the digits are good so long */
    int64_t heard_ns; /* monotonic: when the server last answered, or refused; 0: never */
    /* --- below: of pairing.c */
    char secret[TOKEN_MAX_CHARS + 1];      /* that is shown digits for; "": none */
    char kept[TOKEN_MAX_CHARS + 1];        /* that was let in here, should no file take it; "": none */
    char used[TOKEN_MAX_CHARS + 1];        /* with which the last connection began */
    char turned_away[TOKEN_MAX_CHARS + 1]; /* the token that was refused last */
    int64_t let_in_ns;                     /* monotonic: when an engineer let it in; 0: never */
};

/* Sets up the pairing of a display. token_path: of --token-file, or NULL; it must outlive this, as must the other texts. */
void pairing_init(struct pairing *pairing, const char *token_path, const struct daemon_url *url, const char *wall, int display);
/* Chooses the token of the next connection, of those that the files have by now: another one than was refused last, if there is one. */
void pairing_choose_token(struct pairing *pairing);
/* The server refused that token: asks for digits from now on. */
void pairing_refused(struct pairing *pairing, struct links *links, int64_t now_ns);
/* The server greeted. */
void pairing_welcomed(struct pairing *pairing);
/* Takes an answer to what was asked for. Returns whether the display was let in, and its secret kept: it is to connect anew. */
bool pairing_take(struct pairing *pairing, struct links *links, const json_t *answer, int64_t now_ns);

#endif
