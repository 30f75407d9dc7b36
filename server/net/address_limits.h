/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What each address has: connections, streams, messages within a second. One of version 6 counts by its first 64 bits, which one
   customer has whole. Pure: time is handed in. Thread: the loop. */
#ifndef NET_ADDRESS_LIMITS_H
#define NET_ADDRESS_LIMITS_H
#include "session/admission.h"

struct address_usage {
    uint8_t address[16]; /* version 4 as ::ffff:a.b.c.d */
    bool local;          /* 127.x or ::1 */
    int refs, connections, sessions;
    int named;               /* connections of a proxy whose last request was its */
    int pictures, questions; /* of HTTP, that are being answered */
    int64_t answer_bytes;    /* over HTTP, that it has not read yet */
    struct address_share share;
    int64_t rate_begin_ns, messages;
};

struct address_limits;
/* exempt: this machine's own addresses have only the limits on all together, unless one for an address was set. */
struct address_limits *address_limits_create(const struct quotas *quotas, bool exempt);
void address_limits_destroy(struct address_limits **peers); /* &NULL is fine; leaves NULL */

/* The peer of a numeric address, made if need be; what is no address is one peer together. The caller has a reference. */
struct address_usage *address_limits_ref(struct address_limits *peers, const char *address);
void address_limits_unref(struct address_limits *peers, struct address_usage **peer); /* &NULL is fine; leaves NULL */

/* Whether it may have one more. */
bool address_limits_may_connect(const struct address_limits *peers, const struct address_usage *peer);
bool address_limits_may_stream(const struct address_limits *peers, const struct address_usage *peer);
bool address_limits_may_be_named(const struct address_limits *peers, const struct address_usage *peer);
bool address_limits_may_ask(const struct address_limits *peers, const struct address_usage *peer); /* one more question about the past */
bool address_limits_may_hold(const struct address_limits *peers, const struct address_usage *peer,
                             size_t count);                                                         /* so many bytes of answers more */
bool address_limits_may_draw(const struct address_limits *peers, const struct address_usage *peer); /* one more picture for HTTP */
/* Counts a message. False: the address has sent too many within this second. */
bool address_limits_count_message(const struct address_limits *peers, struct address_usage *peer, int64_t now_ns);
int address_limits_count(const struct address_limits *peers);

#endif
