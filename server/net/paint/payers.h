/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What of the render thread's time each address has had: it is shared among them first, and then among their clients. Pure. Thread: under
   its owner's lock. */
#ifndef NET_PAYERS_H
#define NET_PAYERS_H
#include <stddef.h>

#include "net/paint/schedule.h"

struct payer {
    uint64_t id;
    int clients;
    int64_t spent_ns[SCHEDULE_SHARES]; /* see schedule.h */
};

struct payers { /* zero-initialise */
    struct payer **all; /* as many as addresses that draw */
    size_t count, capacity;
    int64_t served_ns[SCHEDULE_SHARES]; /* what the one that was served last had spent before */
};

struct payer *payers_join(struct payers *payers, uint64_t id); /* one client more; made if need be */
/* One client less; leaves NULL. What it spent is remembered until the others have caught up: who comes anew owes it still. */
void payers_leave(struct payers *payers, struct payer **payer);
/* It asks; it is served. */
void payers_asked(const struct payers *payers, struct payer *payer, int share);
void payers_served(struct payers *payers, const struct payer *payer, int share);
void payers_finish(struct payers *payers); /* nobody is in it any more */

#endif
