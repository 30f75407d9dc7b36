/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Holds the lease (corelink/lease.h) of one of two cores, on a thread of its own: reads the row in PostgreSQL, bids for it, renews it,
   and lets the kernel end the process at the moment when it may no longer act. Thread: any, unless stated otherwise. */
#ifndef CORELINK_LEASE_KEEPER_H
#define CORELINK_LEASE_KEEPER_H
#include "base/log/log.h"
#include "base/metrics/counters.h"
#include "corelink/lease.h"
#include "plant/plant.h"

struct lease_keeper_params {
    struct log *log;
    struct counters *counters;
    const struct plant_postgres *postgres; /* database with the row; copied */
    const char *plant, *node;              /* name of the plant; unique name of this node (lease_name()). Copied */
    void (*won)(void *arg);                /* called by the thread, once: this node leads from now on */
    void (*lost)(void *arg);               /* called by the thread, once: the process must end; the kernel ends it soon */
    void *arg;
};

/* Writes "NODE ID", which distinguishes this core even from others with its name (corelink/seat.h). Returns false if that is too long. */
bool lease_name(char out[LEASE_NODE_BYTES], const char *node, const char *id);

struct lease_keeper;
/* Creates a keeper. Returns NULL if the kernel provides no timer (logged). This node follows until lease_keeper_start(). */
struct lease_keeper *lease_keeper_create(const struct lease_keeper_params *params);
bool lease_keeper_start(struct lease_keeper *keeper); /* Returns false if the thread cannot be started (logged). */
/* Gives the lease back if this node leads, and frees the keeper. Everything that only a leader may do must have ended before. &NULL is
   fine; leaves NULL. */
void lease_keeper_destroy(struct lease_keeper **keeper);
bool lease_keeper_leads(struct lease_keeper *keeper); /* Returns whether this node leads. */

/* --- for a leader: its connected standby --- */
/* Sets the standby; "": its connection has ended. Its promises count once the row names it. The row still names it for 10 s after its
   connection has ended: if the database is lost at the moment of a reload, the standby's promises are all that is left. follows: the
   standby has this core's version and configuration; otherwise it only votes, and does not count as a standby in the metrics. */
void lease_keeper_set_standby(struct lease_keeper *keeper, const char *node, bool follows);
/* Returns the sequence number of a question for the standby; the caller sends it now. */
uint64_t lease_keeper_ask(struct lease_keeper *keeper);
/* Processes the standby's promise as the answer to that question. */
void lease_keeper_promised(struct lease_keeper *keeper, const char *node, uint64_t number);

/* --- for a follower --- */
const char *lease_keeper_id(const struct lease_keeper *keeper); /* Returns the ID part of this node's name; lives as long as the keeper. */
/* Promises the leader, on its request, not to bid for LEASE_NS. Returns false if this node cannot promise that. */
bool lease_keeper_promise(struct lease_keeper *keeper);

#endif
