/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Limits per client address: how many connections, streams, requests and messages each has. IPv6 addresses are grouped by their
   first 64 bits, because one customer usually owns all addresses of such a prefix. Pure: the caller passes the time. Call only
   in the event loop. */
#ifndef NET_ADDRESS_LIMITS_H
#define NET_ADDRESS_LIMITS_H
#include "session/pacing/admission.h"

struct address_usage {
    uint8_t address[16]; /* address of the client; an IPv4 address has the form ::ffff:a.b.c.d */
    bool local;          /* true: the client is on this machine: its address is 127.x or ::1 */
    int refs, connections, sessions;
    int named;               /* number of reverse-proxy connections whose last request named this client address */
    int pictures, questions; /* numbers of HTTP requests in progress: `pictures` for pictures, `questions` for recorded history */
    int64_t answer_bytes;    /* bytes of HTTP answers that the client has not read yet */
    struct address_share share;
    /* messages: number of messages received over streams since rate_begin_ns (monotonic start of the current second) */
    int64_t rate_begin_ns, messages;
};

struct address_limits;
/* exempt: true: loopback addresses have no limits of their own unless the user set one; the server's total limits still apply.
   Never returns NULL. */
struct address_limits *address_limits_create(const struct quotas *quotas, bool exempt);
void address_limits_destroy(struct address_limits **limits); /* destroys the limits and sets *limits to NULL; accepts a pointer to NULL */

/* Returns the usage of a numeric address, creating it if needed. The caller owns a reference (address_limits_unref). All texts
   that are not valid addresses share one struct. */
struct address_usage *address_limits_ref(struct address_limits *limits, const char *address);
/* Releases a reference and sets *usage to NULL; accepts a pointer to NULL. */
void address_limits_unref(struct address_limits *limits, struct address_usage **usage);

/* Each function checks one limit of the address, and returns true if one more is allowed. may_connect: a connection;
   may_stream: a stream; may_be_named: a connection of a proxy for this client; may_ask: a history query; may_hold: an HTTP
   answer of `count` bytes; may_draw: a picture over HTTP. */
bool address_limits_may_connect(const struct address_limits *limits, const struct address_usage *usage);
bool address_limits_may_stream(const struct address_limits *limits, const struct address_usage *usage);
bool address_limits_may_be_named(const struct address_limits *limits, const struct address_usage *usage);
bool address_limits_may_ask(const struct address_limits *limits, const struct address_usage *usage);
bool address_limits_may_hold(const struct address_limits *limits, const struct address_usage *usage, size_t count);
bool address_limits_may_draw(const struct address_limits *limits, const struct address_usage *usage);
/* Counts a stream message. Returns false if the address has sent more than its quota within this second. */
bool address_limits_count_message(const struct address_limits *limits, struct address_usage *usage, int64_t now_ns);

#endif
