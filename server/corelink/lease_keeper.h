/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Keeps the lease (corelink/lease.h) of one of two cores, on a thread of its own: looks at the row in PostgreSQL, bids for it, renews it,
   and has the kernel end the process in the moment when it may act no more. Thread: any, where nothing else is said. */
#ifndef CORELINK_LEASE_KEEPER_H
#define CORELINK_LEASE_KEEPER_H
#include "base/log/log.h"
#include "base/metrics/counters.h"
#include "corelink/lease.h"
#include "plant/plant.h"

struct lease_keeper_params {
    struct log *log;
    struct counters *counters;
    const struct plant_postgres *postgres; /* where the row is; copied */
    const char *plant, *node;              /* its name; this one's, with what tells it from others of that name (lease_name). Copied */
    void (*won)(void *arg);  /* called by the thread, once: this node leads from now on */
    void (*lost)(void *arg); /* called by the thread, once: the process is to end; the kernel ends it soon */
    void *arg;
};

/* Writes "NODE ID": what tells this core from others, also of its name (corelink/seat.h). Returns false if that is too long. */
bool lease_name(char out[LEASE_NODE_BYTES], const char *node, const char *id);

struct lease_keeper;
/* Returns NULL if there is no timer of the kernel (logged). This node follows until lease_keeper_start(). */
struct lease_keeper *lease_keeper_create(const struct lease_keeper_params *params);
bool lease_keeper_start(struct lease_keeper *keeper); /* returns false if there is no thread (logged) */
/* Gives the lease back, if this node leads, and ends: whatever it led for must have ended before. &NULL is fine; leaves NULL. */
void lease_keeper_destroy(struct lease_keeper **keeper);
bool lease_keeper_leads(struct lease_keeper *keeper); /* returns whether this node leads */

/* --- for a leader: the standby that is connected --- */
/* Names it; "": its connection has ended. Its promises count once the row names it, which it does for 10 s after its connection has ended:
   where the database is lost in the moment of a reload, its promises are all there is. follows: it has this core's version and
   configuration; else it is a witness that it does not lead, and no standby in the metrics. */
void lease_keeper_set_standby(struct lease_keeper *keeper, const char *node, bool follows);
/* Returns the number of a question that is sent to the standby now. */
uint64_t lease_keeper_ask(struct lease_keeper *keeper);
/* The standby has answered that question with a promise. */
void lease_keeper_promised(struct lease_keeper *keeper, const char *node, uint64_t number);

/* --- for a follower --- */
const char *lease_keeper_id(const struct lease_keeper *keeper); /* returns the ID of its name; lives as long as the keeper */
/* Promises the leader, who asks, not to take its place for LEASE_NS. Returns false if it cannot. */
bool lease_keeper_promise(struct lease_keeper *keeper);

#endif
