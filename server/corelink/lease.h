/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The rule by which two cores agree who leads: polls the devices, owns the alarms. Pure: time is an argument. Thread: one at a time.

   Three vote: the leader, its standby, and a row in a database. The leader may act for LEASE_HOLD_NS from when it sent what was confirmed
   last: a renewal of the row, or a question to the standby that was answered by a promise not to bid for LEASE_NS. Whoever follows may bid
   for the row only once it has seen it unchanged for LEASE_NS and no promise of its own binds it, and only if the row names it, or names no
   standby. A bid changes the row only if it is still as it was seen, so of two bids one wins, and a leader that renewed meanwhile stays.
   The leader counts the promises of that node alone which the row names as its standby, by its own confirmed renewal: nobody else may bid.
   LEASE_HOLD_NS is shorter than LEASE_NS by more than the clocks of two machines can run apart in that time. No clock of one machine is
   ever compared with that of another. */
#ifndef CORELINK_LEASE_H
#define CORELINK_LEASE_H
#include <stdbool.h>
#include <stdint.h>

#define LEASE_NS (3 * INT64_C(1000000000))        /* that a follower waits */
#define LEASE_HOLD_NS (2 * INT64_C(1000000000))   /* that a leader goes on */
#define LEASE_RENEW_NS (500 * INT64_C(1000000))   /* between two renewals */
#define LEASE_LOOK_NS (250 * INT64_C(1000000))    /* between two looks at the row */
enum { LEASE_NODE_BYTES = 64 };

struct lease_row { /* as the database has it */
    int64_t epoch;    /* increases with each leader */
    int64_t beat;     /* increases with each change of the row */
    int64_t instance; /* a random number of the leader's process: a node that was started again is another one */
    char leader[LEASE_NODE_BYTES], standby[LEASE_NODE_BYTES]; /* nodes, no two alike; "": it was given back; there is none */
};

struct lease {
    char node[LEASE_NODE_BYTES]; /* this one */
    int64_t instance;
    struct lease_row row; /* as it was seen or written last */
    bool known;           /* the row is */
    bool leads;
    bool lost;            /* it did lead, and another does now */
    bool bids;            /* a bid of ours is under way, or what became of it is not known */
    int64_t seen_ns;      /* a follower's: since when the row is as it is */
    int64_t bound_ns;     /* a follower's: until when its promise binds it */
    int64_t until_ns;     /* a leader's: it may act before this */
    char counts[LEASE_NODE_BYTES]; /* a leader's: whose promises count; "": nobody's */
};

/* node: shorter than LEASE_NODE_BYTES. */
void lease_init(struct lease *lease, const char *node, int64_t instance);
/* Returns whether it may act at this time. */
bool lease_acts(const struct lease *lease, int64_t now_ns);

/* The row, as the database has answered at now_ns. A leader that finds another's name in it has lost. */
void lease_saw(struct lease *lease, const struct lease_row *row, int64_t now_ns);

/* --- a follower --- */
bool lease_may_bid(const struct lease *lease, int64_t now_ns);
/* To be called before the bid is sent; then lease_won() if the row was changed by it, or lease_saw() with the row. */
void lease_bid(struct lease *lease);
void lease_won(struct lease *lease, int64_t sent_ns);
/* Promises not to bid, for LEASE_NS from now. Returns false if it cannot. */
bool lease_promise(struct lease *lease, int64_t now_ns);

/* --- a leader --- */
/* To be called before a renewal is sent that names that standby ("": none); lease_renewed() if the row was changed by it. */
void lease_renew(struct lease *lease, const char *standby);
void lease_renewed(struct lease *lease, const char *standby, int64_t sent_ns);
/* A promise came, of a question that was sent then. */
void lease_promised(struct lease *lease, const char *standby, int64_t sent_ns);

#endif
