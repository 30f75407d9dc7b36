/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Login throttle: counts wrong tokens by address. After ten within a minute, tokens of that address are looked at once in five seconds
   until a minute has passed without a wrong one; tokens that were let in from there before are not held up by others' mistakes.
   At most 1024 addresses are remembered; the one heard of longest ago makes room. Pure: time is handed in. Thread: the loop. */
#ifndef ACCESS_LOGIN_THROTTLE_H
#define ACCESS_LOGIN_THROTTLE_H
#include <stdbool.h>
#include <stdint.h>

#include "access/tokens.h"

enum { LOGIN_FAILURES = 10, LOGIN_WAIT_S = 5, LOGIN_ADDRESSES = 1024 };

enum login {
    LOGIN_NONE, /* no token was shown */
    LOGIN_GOOD,
    LOGIN_GOOD_NEW, /* and this address has not shown it for ten minutes: worth a line in the log */
    LOGIN_WRONG,
    LOGIN_WRONG_SLOWS, /* from now on the address is slowed */
    LOGIN_HELD,        /* the address is slowed: the token was not judged */
};

struct login_throttle;
struct login_throttle *login_throttle_create(void);
void login_throttle_destroy(struct login_throttle **logins); /* &NULL is fine; leaves NULL */
/* address: 16 bytes, as in struct address_usage. hash: of a token that would be let in; NULL: the token is wrong. */
enum login login_throttle_judge(struct login_throttle *logins, const uint8_t address[16], const uint8_t *hash, int64_t now_ns);
int login_throttle_failures(const struct login_throttle *logins, const uint8_t address[16],
                            int64_t now_ns);                            /* within the last minute; 10 at most */
int logins_slowed(const struct login_throttle *logins, int64_t now_ns); /* how many addresses are */

static inline bool login_is_good(enum login login)
{
    return login == LOGIN_NONE || login == LOGIN_GOOD || login == LOGIN_GOOD_NEW;
}

#endif
