/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Time accounts: how much of the render thread's time each client address was charged for drawing. Time is shared among
   addresses first, then among the clients of each address. Pure. Call only under the lock of the render service. */
#ifndef SERVICE_TIME_ACCOUNTS_H
#define SERVICE_TIME_ACCOUNTS_H
#include <stddef.h>

#include "service/scheduler.h"

struct time_account {
    uint64_t id; /* id of the account: each client address has one */
    int clients;
    int64_t spent_ns[SCHEDULER_SHARES]; /* drawing time charged so far, by kind of frame (scheduler_share()) */
};

struct time_accounts { /* zero-initialise; free with time_accounts_finish() */
    struct time_account **all;
    size_t count, capacity;
    /* by kind of frame (scheduler_share()): drawing time already charged to the account served last, before it was served */
    int64_t served_ns[SCHEDULER_SHARES];
};

/* Adds a client to the account with that id; creates the account if needed. Returns the account; time_accounts_leave() removes
   the client again. */
struct time_account *time_accounts_join(struct time_accounts *accounts, uint64_t id);
/* Removes a client from the account and sets *account to NULL. An account without clients is kept until other accounts were
   charged as much drawing time, so that a client cannot clear its charge by reconnecting. */
void time_accounts_leave(struct time_accounts *accounts, struct time_account **account);
/* Call it when a client of the account makes a request. It raises the account's charge to that of the account served last, so
   that unused time gives no advantage. */
void time_accounts_asked(const struct time_accounts *accounts, struct time_account *account, int share);
/* Call it when a request of the account is drawn next. Other accounts then enter the queue with at least this account's charge. */
void time_accounts_served(struct time_accounts *accounts, const struct time_account *account, int share);
/* Charges drawing time to the account with that id. The account may have no clients any more, for example if the last client left while its
   frame was drawn. */
void time_accounts_charge(struct time_accounts *accounts, uint64_t id, int share, int64_t ns);

struct time_claim { /* claim of a client to be served: how much drawing time the client was charged, and how long its request has waited */
    const struct time_account *account;
    /* spent_ns: drawing time charged to the client, not to its address; asked_ns: when the client made the request */
    int64_t spent_ns, asked_ns;
};
/* Returns whether `a` is served before `b`. The address that was charged less goes first; within one address, the client that
   was charged less; if these are equal, the older request. Only drawing is charged, not waiting. So other addresses, and other
   clients of the same address, can go before a request only until they were charged as much. */
bool time_claim_before(const struct time_claim *a, const struct time_claim *b, int share);
/* Frees all accounts; they must have no clients. */
void time_accounts_finish(struct time_accounts *accounts);

#endif
