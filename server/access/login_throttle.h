/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Login throttle: counts wrong tokens and failed sign-ins per address. After ten failures within a minute, only one token in five
   seconds is checked from that address, until a minute has passed without a failure. A token that was accepted from the address before
   is never delayed. At most 1024 addresses are remembered; the one least recently used is forgotten first. Pure: the caller passes the
   time. Thread: the event loop. */
#ifndef ACCESS_LOGIN_THROTTLE_H
#define ACCESS_LOGIN_THROTTLE_H
#include <stdbool.h>
#include <stdint.h>

#include "access/tokens.h"

enum { LOGIN_FAILURES = 10, LOGIN_WAIT_S = 5, LOGIN_ADDRESSES = 1024 };

enum login {
    LOGIN_NONE, /* no token was given */
    LOGIN_GOOD,
    LOGIN_GOOD_NEW, /* the token is valid and was not seen from this address within ten minutes, so it is worth a log line */
    LOGIN_WRONG,
    LOGIN_WRONG_SLOWS, /* the token is wrong; with this failure the address has reached the limit and becomes slowed */
    LOGIN_HELD,        /* the address is slowed: the token was not checked */
};

struct login_throttle;
struct login_throttle *login_throttle_create(void);
/* frees the throttle and sets *throttle to NULL; accepts a pointer to NULL */
void login_throttle_destroy(struct login_throttle **throttle);
/* Judges and counts a token from an address (as in struct address_usage): wrong, valid, or not checked because the address is slowed.
   hash: hash of the token if it is valid; NULL: the token is wrong. */
enum login login_throttle_judge(struct login_throttle *throttle, const uint8_t address[16], const uint8_t *hash, int64_t now_ns);
/* Login throttle for attempts whose result comes later, such as sign-ins at an identity provider. Returns LOGIN_HELD if the attempt must be
   refused, otherwise LOGIN_NONE. When such an attempt fails, login_throttle_fail() counts the failure and returns LOGIN_WRONG or
   LOGIN_WRONG_SLOWS. */
enum login login_throttle_begin(struct login_throttle *throttle, const uint8_t address[16], int64_t now_ns);
enum login login_throttle_fail(struct login_throttle *throttle, const uint8_t address[16], int64_t now_ns);
/* Returns the number of failures of the address within the last minute, 10 at most. */
int login_throttle_failures(const struct login_throttle *throttle, const uint8_t address[16], int64_t now_ns);
/* Returns the number of addresses that are slowed at now_ns. */
int login_throttle_slowed(const struct login_throttle *throttle, int64_t now_ns);

/* Returns true if the verdict admits the client. */
static inline bool login_is_good(enum login login)
{
    return login == LOGIN_NONE || login == LOGIN_GOOD || login == LOGIN_GOOD_NEW;
}

#endif
