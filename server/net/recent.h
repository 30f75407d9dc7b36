/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pictures that were encoded lately, or are being encoded: who asks for the same one gets that. So any number of clients of one view cost
   one render and one encode, though they never ask at the same moment. Only whole pictures that stand alone. Thread: any. */
#ifndef NET_RECENT_H
#define NET_RECENT_H
#include "base/counters.h"
#include "net/batch.h"

struct recent;

struct recent *recent_create(struct counters *counters); /* never NULL */
void recent_destroy(struct recent **recent);             /* &NULL is fine; leaves NULL */

/* Takes out of the batch, into `joined`, some who can have a picture of that content, in the coding that they wish for, without a new
   one. False: nobody (more). *packet: for all of them, and the caller owns it; NULL: it is being encoded, and recent_end will say. */
bool recent_join(struct recent *recent, uint64_t content, struct batch *batch, struct batch *joined, struct packet **packet);
/* A picture for this batch goes to be encoded. */
void recent_begin(struct recent *recent, uint64_t content, const struct batch *batch);
/* It was encoded, for all of the batch in one coding; packet NULL: it could not be. `waiting`: who joined meanwhile; emptied first. */
void recent_end(struct recent *recent, uint64_t content, const struct wish *wish, struct packet *packet, struct batch *waiting);

#endif
