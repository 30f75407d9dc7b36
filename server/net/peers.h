/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What each address has: connections, streams, messages within a second. One of version 6 counts by its first 64 bits, which one
   customer has whole. Pure: time is handed in. Thread: the loop. */
#ifndef NET_PEERS_H
#define NET_PEERS_H
#include "net/session/admission.h"

struct peer {
    uint8_t address[16]; /* version 4 as ::ffff:a.b.c.d */
    bool local;          /* 127.x or ::1 */
    int refs, connections, sessions;
    int named;               /* connections of a proxy whose last request was its */
    int pictures, questions; /* of HTTP, that are being answered */
    int64_t answer_bytes;    /* over HTTP, that it has not read yet */
    struct share share;
    int64_t rate_begin_ns, messages;
};

struct peers;
/* exempt: this machine's own addresses have only the limits on all together, unless one for an address was set. */
struct peers *peers_create(const struct quotas *quotas, bool exempt);
void peers_destroy(struct peers **peers); /* &NULL is fine; leaves NULL */

/* The peer of a numeric address, made if need be; what is no address is one peer together. The caller has a reference. */
struct peer *peers_ref(struct peers *peers, const char *address);
void peers_unref(struct peers *peers, struct peer **peer); /* &NULL is fine; leaves NULL */

/* Whether it may have one more. */
bool peers_may_connect(const struct peers *peers, const struct peer *peer);
bool peers_may_stream(const struct peers *peers, const struct peer *peer);
bool peers_may_be_named(const struct peers *peers, const struct peer *peer);
bool peers_may_ask(const struct peers *peers, const struct peer *peer);  /* one more question about the past */
bool peers_may_hold(const struct peers *peers, const struct peer *peer, size_t count); /* so many bytes of answers more */
bool peers_may_draw(const struct peers *peers, const struct peer *peer); /* one more picture for HTTP */
/* Counts a message. False: the address has sent too many within this second. */
bool peers_count_message(const struct peers *peers, struct peer *peer, int64_t now_ns);
int peers_count(const struct peers *peers);

#endif
