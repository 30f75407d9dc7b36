/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What of the render thread's time each address has had: it is shared among them first, and then among their clients. Pure. Thread: under
   its owner's lock. */
#ifndef SERVICE_TIME_ACCOUNTS_H
#define SERVICE_TIME_ACCOUNTS_H
#include <stddef.h>

#include "service/scheduler.h"

struct time_account {
    uint64_t id;
    int clients;
    int64_t spent_ns[SCHEDULER_SHARES]; /* see schedule.h */
};

struct time_accounts {         /* zero-initialise */
    struct time_account **all; /* as many as addresses that draw */
    size_t count, capacity;
    int64_t served_ns[SCHEDULER_SHARES]; /* what the one that was served last had spent before */
};

struct time_account *time_accounts_join(struct time_accounts *payers, uint64_t id); /* one client more; made if need be */
/* One client less; leaves NULL. What it spent is remembered until the others have caught up: who comes anew owes it still. */
void time_accounts_leave(struct time_accounts *payers, struct time_account **payer);
/* It asks; it is served. */
void time_accounts_asked(const struct time_accounts *payers, struct time_account *payer, int share);
void time_accounts_served(struct time_accounts *payers, const struct time_account *payer, int share);
void time_accounts_finish(struct time_accounts *payers); /* nobody is in it any more */

#endif
