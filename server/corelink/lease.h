/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The rule by which two cores agree which core leads, that is, polls the devices and owns the alarms. Pure: time is an argument. Thread:
   one at a time.

   Three parties vote: the leader, its standby, and a row in a database. The leader may act for LEASE_HOLD_NS from when it sent the last
   confirmed request: either a renewal of the row, or a question to the standby that was answered by a promise not to bid for LEASE_NS. A
   follower may bid for the row only if it has seen the row unchanged for LEASE_NS, no promise of its own binds it, and the row names it
   as standby or names no standby. A bid changes the row only if the row is still as the bidder saw it, so one of two bids wins, and a
   leader that has renewed meanwhile stays. The leader counts only promises of the node that the row names as its standby, as confirmed
   by a renewal: no other node may bid. LEASE_HOLD_NS is shorter than LEASE_NS by more than the clocks of two machines can drift apart in
   that time. Clocks of different machines are never compared. */
#ifndef CORELINK_LEASE_H
#define CORELINK_LEASE_H
#include <stdbool.h>
#include <stdint.h>

#define LEASE_NS (3 * INT64_C(1000000000))      /* time that a follower waits */
#define LEASE_HOLD_NS (2 * INT64_C(1000000000)) /* time that a leader may act after a confirmation */
#define LEASE_RENEW_NS (500 * INT64_C(1000000)) /* interval between renewals */
#define LEASE_LOOK_NS (250 * INT64_C(1000000))  /* interval between a follower's reads of the row */
enum { LEASE_NODE_BYTES = 64 };

struct lease_row {    /* the row in the database */
    int64_t epoch;    /* increases with each new leader */
    int64_t beat;     /* sequence number that increases with each change of the row (beat) */
    int64_t instance; /* random number of the leader's process, which distinguishes a restarted node */
    /* unique names of nodes; leader "": the lease was given back; standby "": none */
    char leader[LEASE_NODE_BYTES], standby[LEASE_NODE_BYTES];
};

struct lease {
    char node[LEASE_NODE_BYTES]; /* name of this node */
    int64_t instance;
    struct lease_row row; /* the row as last read or written */
    bool known;           /* `row` is valid */
    bool leads;
    bool lost;                     /* this node was the leader, and another node leads now */
    bool bids;                     /* a bid of this node is in progress, or its outcome is unknown */
    int64_t seen_ns;               /* follower: time since which the row is unchanged */
    int64_t bound_ns;              /* follower: time until which its promise binds it */
    int64_t until_ns;              /* leader: time until which it may act */
    char counts[LEASE_NODE_BYTES]; /* leader: name of the node whose promises count; "": none */
};

/* Initialises a lease. node: shorter than LEASE_NODE_BYTES. */
void lease_init(struct lease *lease, const char *node, int64_t instance);
/* Returns whether this node may act at this time. */
bool lease_acts(const struct lease *lease, int64_t now_ns);

/* Processes the row that the database returned at now_ns. A leader that finds another node's name in the row is no longer the leader. */
void lease_saw(struct lease *lease, const struct lease_row *row, int64_t now_ns);

/* --- for a follower --- */
bool lease_may_bid(const struct lease *lease, int64_t now_ns);
/* Call lease_bid() before sending the bid; then lease_won() if the bid changed the row, or lease_saw() with the current row. */
void lease_bid(struct lease *lease);
void lease_won(struct lease *lease, int64_t sent_ns);
/* Promises not to bid for LEASE_NS from now. Returns false if this node cannot promise that. */
bool lease_promise(struct lease *lease, int64_t now_ns);

/* --- for a leader --- */
/* Call lease_renew() before sending a renewal that names `standby` ("": none), and lease_renewed() if the renewal changed the row. */
void lease_renew(struct lease *lease, const char *standby);
void lease_renewed(struct lease *lease, const char *standby, int64_t sent_ns);
/* Processes a promise of the standby, as the answer to a question sent at sent_ns. */
void lease_promised(struct lease *lease, const char *standby, int64_t sent_ns);

#endif
