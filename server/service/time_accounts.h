/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Time accounts: how much of the render thread's time each address was charged. Time is shared among addresses first, then among the
   clients of each. Pure. Thread: under the lock of the render service. */
#ifndef SERVICE_TIME_ACCOUNTS_H
#define SERVICE_TIME_ACCOUNTS_H
#include <stddef.h>

#include "service/scheduler.h"

struct time_account {
    uint64_t id; /* of the address */
    int clients;
    int64_t spent_ns[SCHEDULER_SHARES]; /* by scheduler_share */
};

struct time_accounts { /* zero-initialise; time_accounts_finish */
    struct time_account **all;
    size_t count, capacity;
    int64_t served_ns[SCHEDULER_SHARES]; /* what the account served last had been charged before */
};

/* Counts one client more on the account of that id, which is added if need be. Returns it; time_accounts_leave gives it back. */
struct time_account *time_accounts_join(struct time_accounts *accounts, uint64_t id);
/* Counts one client less and leaves NULL. An account without clients is kept until the others have been charged as much, so that coming
   back does not clear it. */
void time_accounts_leave(struct time_accounts *accounts, struct time_account **account);
/* Notes that a client of the account made a request: idle time is not saved up. */
void time_accounts_asked(const struct time_accounts *accounts, struct time_account *account, int share);
/* Notes that the account's request is drawn next. */
void time_accounts_served(struct time_accounts *accounts, const struct time_account *account, int share);
/* Frees all; nobody may have joined any more. */
void time_accounts_finish(struct time_accounts *accounts);

#endif
