/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Limits by address: how many connections, streams, requests and messages each address has. An address of IP version 6 counts by its
   first 64 bits, which one customer has whole. Pure: time is handed in. Thread: the loop. */
#ifndef NET_ADDRESS_LIMITS_H
#define NET_ADDRESS_LIMITS_H
#include "session/pacing/admission.h"

struct address_usage {
    uint8_t address[16]; /* version 4 as ::ffff:a.b.c.d */
    bool local;          /* 127.x or ::1 */
    int refs, connections, sessions;
    int named;               /* connections of a proxy whose last request it made */
    int pictures, questions; /* of HTTP, that are being answered */
    int64_t answer_bytes;    /* of HTTP answers that it has not read yet */
    struct address_share share;
    int64_t rate_begin_ns, messages; /* of streams, within the second that began then */
};

struct address_limits;
/* exempt: addresses of this machine are held only to the limits on all together, unless a limit by address was given. Never NULL. */
struct address_limits *address_limits_create(const struct quotas *quotas, bool exempt);
void address_limits_destroy(struct address_limits **limits); /* &NULL is fine; leaves NULL */

/* Returns the usage of a numeric address, with a reference for the caller; added if need be. Whatever is no address counts as one. */
struct address_usage *address_limits_ref(struct address_limits *limits, const char *address);
/* Gives a reference back. &NULL is fine; leaves NULL. */
void address_limits_unref(struct address_limits *limits, struct address_usage **usage);

/* Return whether the address may have one more: connection; stream; connection of a proxy; question about history; `count` bytes of
   answers; frame over HTTP. */
bool address_limits_may_connect(const struct address_limits *limits, const struct address_usage *usage);
bool address_limits_may_stream(const struct address_limits *limits, const struct address_usage *usage);
bool address_limits_may_be_named(const struct address_limits *limits, const struct address_usage *usage);
bool address_limits_may_ask(const struct address_limits *limits, const struct address_usage *usage);
bool address_limits_may_hold(const struct address_limits *limits, const struct address_usage *usage, size_t count);
bool address_limits_may_draw(const struct address_limits *limits, const struct address_usage *usage);
/* Counts a message of a stream. Returns false if the address has sent too many within this second. */
bool address_limits_count_message(const struct address_limits *limits, struct address_usage *usage, int64_t now_ns);
/* Returns how many addresses are known. */
int address_limits_count(const struct address_limits *limits);

#endif
