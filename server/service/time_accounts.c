/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Drawing time by address: who has spent how much, for as long as it has clients or is ahead of the others. */
#include "service/time_accounts.h"

#include "base/mem.h"

static bool owes(const struct time_accounts *payers, const struct time_account *payer)
{
    bool any = false;
    for (int share = 0; share < SCHEDULER_SHARES; share++)
        any |= payer->spent_ns[share] > payers->served_ns[share];
    return any;
}

static void forget_old(struct time_accounts *payers)
{
    size_t kept = 0;
    for (size_t i = 0; i < payers->count; i++) {
        struct time_account *payer = payers->all[i];
        if (payer->clients > 0 || owes(payers, payer))
            payers->all[kept++] = payer;
        else
            mem_free(payer);
    }
    payers->count = kept;
}

struct time_account *time_accounts_join(struct time_accounts *payers, uint64_t id)
{
    size_t i = 0;
    while (i < payers->count && payers->all[i]->id != id)
        i++;
    if (i == payers->count) {
        forget_old(payers);
        i = payers->count;
        mem_grow(&payers->all, &payers->capacity, payers->count + 1, sizeof(*payers->all));
        struct time_account *payer = payers->all[payers->count++] = mem_new(sizeof(*payer));
        payer->id = id;
    }
    payers->all[i]->clients++;
    return payers->all[i];
}

void time_accounts_leave(struct time_accounts *payers, struct time_account **payer)
{
    (*payer)->clients--;
    *payer = NULL;
    forget_old(payers);
}

void time_accounts_asked(const struct time_accounts *payers, struct time_account *payer, int share)
{
    payer->spent_ns[share] = scheduler_asked(payer->spent_ns[share], payers->served_ns[share]);
}

void time_accounts_served(struct time_accounts *payers, const struct time_account *payer, int share)
{
    payers->served_ns[share] = scheduler_asked(payer->spent_ns[share], payers->served_ns[share]);
}

void time_accounts_finish(struct time_accounts *payers)
{
    for (size_t i = 0; i < payers->count; i++)
        mem_free(payers->all[i]);
    mem_free(payers->all);
    *payers = (struct time_accounts){ 0 };
}
