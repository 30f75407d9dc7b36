/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Login throttle: counts wrong tokens, and refused log-ins of people, by address. After ten wrong ones within a minute, only one token in
   five seconds is judged from that address, until a minute has passed without a wrong one; a token that was accepted from there before is
   not held up. At most 1024 addresses are remembered; the one heard of longest ago is forgotten first. Pure: time is handed in. Thread: the
   loop. */
#ifndef ACCESS_LOGIN_THROTTLE_H
#define ACCESS_LOGIN_THROTTLE_H
#include <stdbool.h>
#include <stdint.h>

#include "access/tokens.h"

enum { LOGIN_FAILURES = 10, LOGIN_WAIT_S = 5, LOGIN_ADDRESSES = 1024 };

enum login {
    LOGIN_NONE, /* no token was given */
    LOGIN_GOOD,
    LOGIN_GOOD_NEW, /* likewise, and first seen from this address within ten minutes: worth a line in the log */
    LOGIN_WRONG,
    LOGIN_WRONG_SLOWS, /* likewise, and the address is slowed from now on */
    LOGIN_HELD,        /* the address is slowed: the token was not judged */
};

struct login_throttle;
struct login_throttle *login_throttle_create(void);
void login_throttle_destroy(struct login_throttle **throttle); /* &NULL is fine; leaves NULL */
/* Returns the verdict on a token given from that address (as in struct address_usage) and counts it. hash: of a token that is valid;
   NULL: the token is wrong. */
enum login login_throttle_judge(struct login_throttle *throttle, const uint8_t address[16], const uint8_t *hash, int64_t now_ns);
/* Return and count the same for what is judged elsewhere, and later: whether it may not be (LOGIN_HELD, else LOGIN_NONE), and, if it was
   wrong, LOGIN_WRONG or LOGIN_WRONG_SLOWS. */
enum login login_throttle_begin(struct login_throttle *throttle, const uint8_t address[16], int64_t now_ns);
enum login login_throttle_fail(struct login_throttle *throttle, const uint8_t address[16], int64_t now_ns);
/* Returns how many wrong tokens the address gave within the last minute, 10 at most. */
int login_throttle_failures(const struct login_throttle *throttle, const uint8_t address[16], int64_t now_ns);
/* Returns how many addresses are slowed. */
int login_throttle_slowed(const struct login_throttle *throttle, int64_t now_ns);

/* Returns whether the verdict lets the client in. */
static inline bool login_is_good(enum login login)
{
    return login == LOGIN_NONE || login == LOGIN_GOOD || login == LOGIN_GOOD_NEW;
}

#endif
