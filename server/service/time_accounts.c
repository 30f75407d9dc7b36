/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Records how much drawing time each client address was charged. An account exists while its address has clients, or has been
   charged more than the others. */
#include "service/time_accounts.h"

#include "base/mem.h"

static bool owes(const struct time_accounts *accounts, const struct time_account *account)
{
    bool any = false;
    for (int kind = 0; kind < SCHEDULER_SHARES; kind++)
        any |= account->spent_ns[kind] > accounts->served_ns[kind];
    return any;
}

static void forget_old(struct time_accounts *accounts)
{
    size_t kept = 0;
    for (size_t i = 0; i < accounts->count; i++) {
        struct time_account *account = accounts->all[i];
        if (account->clients > 0 || owes(accounts, account))
            accounts->all[kept++] = account;
        else
            mem_free(account);
    }
    accounts->count = kept;
}

struct time_account *time_accounts_join(struct time_accounts *accounts, uint64_t id)
{
    size_t i = 0;
    while (i < accounts->count && accounts->all[i]->id != id)
        i++;
    if (i == accounts->count) {
        forget_old(accounts);
        i = accounts->count;
        mem_grow(&accounts->all, &accounts->capacity, accounts->count + 1, sizeof(*accounts->all));
        struct time_account *account = accounts->all[accounts->count++] = mem_new(sizeof(*account));
        account->id = id;
    }
    accounts->all[i]->clients++;
    return accounts->all[i];
}

void time_accounts_leave(struct time_accounts *accounts, struct time_account **account)
{
    (*account)->clients--;
    *account = NULL;
    forget_old(accounts);
}

void time_accounts_asked(const struct time_accounts *accounts, struct time_account *account, int kind)
{
    account->spent_ns[kind] = scheduler_asked(account->spent_ns[kind], accounts->served_ns[kind]);
}

void time_accounts_served(struct time_accounts *accounts, const struct time_account *account, int kind)
{
    accounts->served_ns[kind] = scheduler_asked(account->spent_ns[kind], accounts->served_ns[kind]);
}

void time_accounts_charge(struct time_accounts *accounts, uint64_t id, int kind, int64_t ns)
{
    struct time_account *account = time_accounts_join(accounts, id);
    time_accounts_asked(accounts, account, kind);
    account->spent_ns[kind] += ns;
    time_accounts_leave(accounts, &account);
}

bool time_claim_before(const struct time_claim *a, const struct time_claim *b, int kind)
{
    bool own = a->account == b->account;
    return scheduler_before(own ? a->spent_ns : a->account->spent_ns[kind], a->asked_ns, own ? b->spent_ns : b->account->spent_ns[kind],
                            b->asked_ns);
}

void time_accounts_finish(struct time_accounts *accounts)
{
    for (size_t i = 0; i < accounts->count; i++)
        mem_free(accounts->all[i]);
    mem_free(accounts->all);
    *accounts = (struct time_accounts){ 0 };
}
