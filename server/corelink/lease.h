/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The lease: the rule by which two cores agree which core leads, that is, polls the devices and owns the alarms. Pure: the
   caller passes the time. Call from one thread at a time. Three parties vote: the leader, its standby, and a row in a database.
   The leader may act for LEASE_HOLD_NS from the time when it sent the last confirmed request. Such a request is a renewal of
   the row, or a question that the standby answered with a promise not to bid for LEASE_NS. A follower may bid for the row only
   if three conditions hold: it has seen the row unchanged for LEASE_NS, no promise of its own binds it, and the row names it or
   nobody as standby. A bid changes the row only if the row is still as the bidder saw it. So one of two bids wins, and a leader
   that has renewed in the meantime stays leader. A leader that shuts down gives the lease: it stops acting, then removes itself
   from the row and names the node that may bid at once. A follower that saw the former leader in the row of the same epoch need
   not wait, because its promise bound it only to that leader. After LEASE_NS, any node may bid for a row that was given. The
   leader counts only promises of the node that the row names as its standby, as confirmed by a renewal: no other node may bid.
   A leader whose standby is in maintenance names itself as standby, and makes promises to itself without a message.
   LEASE_HOLD_NS is shorter than LEASE_NS by more than the clocks of two machines can drift apart in that time. Clocks of
   different machines are never compared. */
#ifndef CORELINK_LEASE_H
#define CORELINK_LEASE_H
#include <stdbool.h>
#include <stdint.h>

/* time in nanoseconds without a renewal after which a follower may bid for the lease; a promise lasts as long */
#define LEASE_NS (3 * INT64_C(1000000000))
/* nanoseconds, counted from the sending of a request that is then confirmed, for which a leader may act */
#define LEASE_HOLD_NS (2 * INT64_C(1000000000))
#define LEASE_RENEW_NS (500 * INT64_C(1000000)) /* interval between renewals */
#define LEASE_LOOK_NS (250 * INT64_C(1000000))  /* interval in nanoseconds at which a follower reads the row in the database */
enum { LEASE_NODE_BYTES = 64 };

struct lease_row {    /* the row in the database that says which core leads */
    int64_t epoch;    /* number of the present leadership: increases each time another core becomes the leader */
    int64_t beat;     /* version of the row; increases with each change of the row */
    int64_t instance; /* random number of the leader's process; distinguishes a restarted core from its former process */
    /* unique names of the cores. leader empty: the last leader gave the lease, to `standby` if that is not empty. standby empty: there is
       no standby */
    char leader[LEASE_NODE_BYTES], standby[LEASE_NODE_BYTES];
};

struct lease {
    char node[LEASE_NODE_BYTES]; /* name of this node */
    int64_t instance;
    struct lease_row row; /* the database row as this core last read or wrote it */
    bool known;           /* true: `row` is valid */
    bool leads;
    bool lost;                     /* true: this node was the leader, but another node leads now */
    bool bids;                     /* true: a bid of this node is in flight, or its outcome is unknown */
    bool gave;                     /* true: this node was the leader and gave the lease away; it never bids again */
    /* while another core leads: true: that core refused this node as its standby, so this node must not bid */
    bool refused;
    bool offered;                  /* while another core leads: true: that core has just offered the lease to this node */
    /* while another core leads: time (nanoseconds of the caller's clock) when this node last saw the row change */
    int64_t seen_ns;
    /* time (nanoseconds of the caller's clock) of the last sign of life of another leader: its request for a promise, or its change of
       the row; 0: there was none. Unchanged while this node leads */
    int64_t heard_ns;
    /* while another core leads: time (nanoseconds of the caller's clock) until which a promise forbids this node to bid */
    int64_t bound_ns;
    int64_t until_ns;              /* while this node leads: time (nanoseconds of the caller's clock) until which it may act as leader */
    char counts[LEASE_NODE_BYTES]; /* while this node leads: name of the standby whose promises count; empty: none */
};

/* Initialises a lease that this node does not hold. node: name of this node, shorter than LEASE_NODE_BYTES. instance: random
   number of this process. */
void lease_init(struct lease *lease, const char *node, int64_t instance);
/* Returns true if this node may act as the leader at now_ns. */
bool lease_acts(const struct lease *lease, int64_t now_ns);

/* Updates the lease with the row that the database returned at now_ns. A leader that finds another node in the row stops
   leading (lease->lost). */
void lease_saw(struct lease *lease, const struct lease_row *row, int64_t now_ns);

/* --- for a follower --- */
bool lease_may_bid(const struct lease *lease, int64_t now_ns);
/* Call lease_bid() before sending a bid for the lease. Afterwards call lease_won() if the bid changed the row, or else
   lease_saw() with the current row. */
void lease_bid(struct lease *lease);
void lease_won(struct lease *lease, int64_t sent_ns);
/* Returns true if the leader's refusal (lease->refused) is the only reason why this node may not bid for the lease now. */
bool lease_is_barred(const struct lease *lease, int64_t now_ns);
/* Makes the promise not to bid for the lease for LEASE_NS from now. Returns false if this node cannot promise that. */
bool lease_promise(struct lease *lease, int64_t now_ns);

/* --- for a leader --- */
/* Call lease_renew() before sending a renewal that names `standby` ("": none) in the row. Afterwards call lease_renewed() if
   the renewal changed the row. */
void lease_renew(struct lease *lease, const char *standby);
void lease_renewed(struct lease *lease, const char *standby, int64_t sent_ns);
/* Extends the lease: in reply to a request sent at sent_ns, the standby has promised not to bid. */
void lease_promised(struct lease *lease, const char *standby, int64_t sent_ns);
/* Ends this node's leadership for good. Call it before writing the row that gives the lease to another core. */
void lease_give(struct lease *lease);

#endif
