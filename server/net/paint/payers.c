/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Drawing time by address: who has spent how much, for as long as it has clients or is ahead of the others. */
#include "net/paint/payers.h"

#include "base/mem.h"

static bool owes(const struct payers *payers, const struct payer *payer)
{
    bool any = false;
    for (int share = 0; share < SCHEDULE_SHARES; share++)
        any |= payer->spent_ns[share] > payers->served_ns[share];
    return any;
}

static void forget_old(struct payers *payers)
{
    size_t kept = 0;
    for (size_t i = 0; i < payers->count; i++) {
        struct payer *payer = payers->all[i];
        if (payer->clients > 0 || owes(payers, payer))
            payers->all[kept++] = payer;
        else
            mem_free(payer);
    }
    payers->count = kept;
}

struct payer *payers_join(struct payers *payers, uint64_t id)
{
    size_t i = 0;
    while (i < payers->count && payers->all[i]->id != id)
        i++;
    if (i == payers->count) {
        forget_old(payers);
        i = payers->count;
        mem_grow(&payers->all, &payers->capacity, payers->count + 1, sizeof(*payers->all));
        struct payer *payer = payers->all[payers->count++] = mem_new(sizeof(*payer));
        payer->id = id;
    }
    payers->all[i]->clients++;
    return payers->all[i];
}

void payers_leave(struct payers *payers, struct payer **payer)
{
    (*payer)->clients--;
    *payer = NULL;
    forget_old(payers);
}

void payers_asked(const struct payers *payers, struct payer *payer, int share)
{
    payer->spent_ns[share] = schedule_asked(payer->spent_ns[share], payers->served_ns[share]);
}

void payers_served(struct payers *payers, const struct payer *payer, int share)
{
    payers->served_ns[share] = schedule_asked(payer->spent_ns[share], payers->served_ns[share]);
}

void payers_finish(struct payers *payers)
{
    for (size_t i = 0; i < payers->count; i++)
        mem_free(payers->all[i]);
    mem_free(payers->all);
    *payers = (struct payers){ 0 };
}
