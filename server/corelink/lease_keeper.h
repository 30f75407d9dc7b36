/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Holds the lease (corelink/lease.h) for one of two cores, on a thread of its own. It reads the row in PostgreSQL, bids for it
   and renews it. It lets the kernel kill the process at the moment from which it may no longer act as leader. Call from any
   thread, unless stated otherwise. */
#ifndef CORELINK_LEASE_KEEPER_H
#define CORELINK_LEASE_KEEPER_H
#include "base/log/log.h"
#include "base/metrics/counters.h"
#include "corelink/lease.h"
#include "plant/plant.h"

/* help text of the metric plantcast_core_up, set by core_link and lease_keeper */
#define CORE_UP_HELP                                                                                                                       \
    "1 while the core in the label is the leading core and sends readings to this daemon; core=\"this\": this daemon itself leads."
#define LEASE_MAINTENANCE_FILE "standby-maintenance" /* file in the history folder whose existence means that the standby is in
                                                        maintenance; `plantcast standby` creates it */

struct lease_keeper_params {
    struct log *log;
    struct counters *counters;
    const struct plant_postgres *postgres; /* database that contains the row of the lease; the settings are copied */
    const char *plant, *node;              /* plant: name of the plant; node: unique name of this node (lease_name()). Both are copied */
    /* while this file exists, the leader names itself as standby, so that no other core may bid (path is copied; NULL: no such file) */
    const char *maintenance_path;
    void (*won)(void *arg);  /* called once on the keeper's thread: this core leads from now on */
    /* called once on the keeper's thread: this core no longer leads, so the process must end; the kernel soon kills it */
    void (*lost)(void *arg);
    void *arg;
};

/* Writes the core's unique name "NODE ID", which differs even from that of another core with the same NODE
   (corelink/node_id.h). Returns false if the name is too long. */
bool lease_name(char out[LEASE_NODE_BYTES], const char *node, const char *id);

struct lease_keeper;
/* Creates a keeper. This node cannot lead before lease_keeper_start(). Returns NULL if the kernel provides no timer (logged). */
struct lease_keeper *lease_keeper_create(const struct lease_keeper_params *params);
bool lease_keeper_start(struct lease_keeper *keeper); /* starts the thread. Returns false if it cannot be started (logged) */
/* If this node still leads, gives the lease to any node; then frees the keeper. The caller must have stopped all work that only
   a leader may do. Sets *keeper to NULL; accepts a pointer to NULL. */
void lease_keeper_destroy(struct lease_keeper **keeper);
bool lease_keeper_leads(struct lease_keeper *keeper); /* Returns true if this core is the leader at the moment. */
/* Returns how long ago, in nanoseconds, this node last heard from another leader; -1: it never has. */
int64_t lease_keeper_heard_age_ns(struct lease_keeper *keeper);

bool lease_keeper_is_alone(struct lease_keeper *keeper); /* Returns true if this node leads and no other core may take over. */

/* --- functions of a leader, about its connected standby --- */
/* Sets the name of the connected standby; "": its connection has ended. The standby's promises count once the row names it. The
   row names it for another 10 s after its connection has ended: if the database is lost while a reload interrupts the
   connection, only the standby's promises can keep this node leading. follows: the standby has this core's version and
   configuration; otherwise it only makes promises, and the metrics do not count it as a standby. */
void lease_keeper_set_standby(struct lease_keeper *keeper, const char *node, bool follows);
/* Returns a new sequence number for asking the standby to promise not to bid; the caller must send the question now. */
uint64_t lease_keeper_ask(struct lease_keeper *keeper);
/* Returns how long ago, in nanoseconds, this core was certainly the leader: the time since it sent the newest request confirmed
   by the database or the standby. */
int64_t lease_keeper_confirmed_age_ns(struct lease_keeper *keeper);
/* Extends the lease because the standby answered the question with that number by promising not to bid. */
void lease_keeper_promised(struct lease_keeper *keeper, const char *node, uint64_t number);
/* Gives the lease to the node `standby`, which may lead at once; "": to any node, which must wait for LEASE_NS. Call it once
   all work that only a leader may do has ended: from then on, the kernel does not kill the process. Returns at once; the
   keeper's thread changes the row. */
void lease_keeper_give(struct lease_keeper *keeper, const char *standby);
/* Returns true if another node has taken the lease that this node gave away. */
bool lease_keeper_is_taken(struct lease_keeper *keeper);

/* --- for a follower --- */
/* Returns the ID part of this core's name "NODE ID"; valid as long as the keeper exists. */
const char *lease_keeper_id(const struct lease_keeper *keeper);
/* Sets why the leader refuses this core as its standby, which keeps this core from taking over. NULL: the leader does not
   refuse it, or this node has loaded its plant since. Copies the text. */
void lease_keeper_set_refused(struct lease_keeper *keeper, const char *why);
/* Promises the leader, on its request, not to bid for the lease for LEASE_NS. Returns false if this node cannot promise that. */
bool lease_keeper_promise(struct lease_keeper *keeper);

#endif
