/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Login throttle: counts wrong tokens and failed sign-ins per client address. After ten failures within a minute, only one
   token every five seconds is checked from that address, until a minute passes without a failure. The 256 tokens
   last accepted from the address are never delayed. At most 1024 addresses are remembered; the least recently used is evicted
   first. No input or output; the caller passes the time. Call only in the event loop. */
#ifndef ACCESS_LOGIN_THROTTLE_H
#define ACCESS_LOGIN_THROTTLE_H
#include <stdbool.h>
#include <stdint.h>

#include "access/tokens.h"

enum { LOGIN_FAILURES = 10, LOGIN_WAIT_S = 5, LOGIN_ADDRESSES = 1024 };

enum login {
    LOGIN_NONE, /* the client sent no token */
    LOGIN_GOOD,
    LOGIN_GOOD_NEW, /* the token is valid but was not used from this address in the last ten minutes, so the caller writes a log line */
    LOGIN_WRONG,
    LOGIN_WRONG_SLOWS, /* the token is wrong, and this failure reaches the limit: the address is throttled from now on */
    LOGIN_HELD,        /* the token was not checked, because the address sent too many wrong ones; the client may retry later */
};

struct login_throttle;
struct login_throttle *login_throttle_create(void);
/* Frees the throttle and sets *throttle to NULL; accepts a pointer to NULL. */
void login_throttle_destroy(struct login_throttle **throttle);
/* Counts a token that a client sent and classifies it: wrong, valid, or not to be checked because the address is throttled.
   address: the client's, as in struct address_usage; hash: hash of the token if it is valid; NULL: the token is wrong. */
enum login login_throttle_judge(struct login_throttle *throttle, const uint8_t address[16], const uint8_t *hash, int64_t now_ns);
/* Like login_throttle_judge(), for attempts whose result arrives later, such as sign-ins at an identity provider. Returns
   LOGIN_HELD if the attempt must be refused, otherwise LOGIN_NONE. When such an attempt fails, login_throttle_fail() counts the
   failure and returns LOGIN_WRONG or LOGIN_WRONG_SLOWS. */
enum login login_throttle_begin(struct login_throttle *throttle, const uint8_t address[16], int64_t now_ns);
enum login login_throttle_fail(struct login_throttle *throttle, const uint8_t address[16], int64_t now_ns);
/* Returns the number of failed attempts from the address within the last minute, 10 at most. */
int login_throttle_failures(const struct login_throttle *throttle, const uint8_t address[16], int64_t now_ns);
/* Returns the number of addresses that are throttled at now_ns. */
int login_throttle_slowed(const struct login_throttle *throttle, int64_t now_ns);

/* Returns true if the throttle's result does not keep the client out: the token is valid, or the client sent none. */
static inline bool login_is_good(enum login login)
{
    return login == LOGIN_NONE || login == LOGIN_GOOD || login == LOGIN_GOOD_NEW;
}

#endif
