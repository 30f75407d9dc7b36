/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The rules of the lease (lease.h) as a state machine: until when the leading core may act as leader, and when a promise to the
   leader forbids another core to bid for the lease. */
#include "corelink/lease.h"

#include <stdio.h>
#include <string.h>

void lease_init(struct lease *lease, const char *node, int64_t instance)
{
    *lease = (struct lease){ .instance = instance };
    snprintf(lease->node, sizeof(lease->node), "%s", node);
}

bool lease_acts(const struct lease *lease, int64_t now_ns)
{
    return lease->leads && !lease->lost && now_ns < lease->until_ns;
}

static bool is_ours(const struct lease *lease, const struct lease_row *row)
{
    return row->instance == lease->instance && !strcmp(row->leader, lease->node);
}

static bool is_same(const struct lease_row *a, const struct lease_row *b)
{
    return a->epoch == b->epoch && a->beat == b->beat;
}

/* Makes this node the leader. It must not act as leader until a renewal is confirmed. */
static void lead(struct lease *lease)
{
    lease->leads = true;
    lease->bids = false;
    lease->counts[0] = 0;
}

void lease_saw(struct lease *lease, const struct lease_row *row, int64_t now_ns)
{
    bool same = lease->known && is_same(row, &lease->row);
    /* a row without a leader that names this node as standby is the last leader's offer of the lease to this node. It counts
       only if the row's `epoch` equals the one that this node saw last: a row with another epoch may come from a restored, old
       copy of the database */
    if (!same)
        lease->offered = lease->known && row->epoch == lease->row.epoch && !row->leader[0] && !strcmp(row->standby, lease->node);
    if (lease->leads && (!is_ours(lease, row) || row->epoch != lease->row.epoch))
        lease->lost = true;
    /* the lease's database row names this node as leader, so its bid succeeded, although the database's answer got lost */
    else if (!lease->leads && lease->bids && is_ours(lease, row))
        lead(lease);
    else if (!same)
        /* the row has changed since this node sent its bid. A bid succeeds only while the row is unchanged, so a bid that
           reaches the database late would fail: this node stops waiting for its outcome */
        lease->bids = false;
    if (!same && lease->known && !lease->leads)
        lease->heard_ns = now_ns;
    if (!same)
        lease->seen_ns = now_ns;
    lease->row = *row;
    lease->known = true;
}

static void take_until(struct lease *lease, int64_t sent_ns)
{
    if (sent_ns + LEASE_HOLD_NS > lease->until_ns)
        lease->until_ns = sent_ns + LEASE_HOLD_NS;
}

/* --- a follower --------------------------------------------------------------------------------------------------------------- */

static bool may_bid_unless_refused(const struct lease *lease, int64_t now_ns)
{
    const struct lease_row *row = &lease->row;
    if (!lease->known || lease->leads || lease->lost || lease->gave)
        return false;
    bool named = !row->leader[0] || !row->standby[0] || !strcmp(row->standby, lease->node) || !strcmp(row->leader, lease->node);
    return lease->offered || (named && now_ns - lease->seen_ns >= LEASE_NS && now_ns >= lease->bound_ns);
}

bool lease_may_bid(const struct lease *lease, int64_t now_ns)
{
    return !lease->refused && may_bid_unless_refused(lease, now_ns);
}

bool lease_is_barred(const struct lease *lease, int64_t now_ns)
{
    return lease->refused && may_bid_unless_refused(lease, now_ns);
}

void lease_bid(struct lease *lease)
{
    lease->bids = true;
}

void lease_won(struct lease *lease, int64_t sent_ns)
{
    lead(lease);
    lease->row.epoch++;
    lease->row.beat++;
    lease->row.instance = lease->instance;
    memcpy(lease->row.leader, lease->node, sizeof(lease->row.leader));
    lease->row.standby[0] = 0;
    take_until(lease, sent_ns);
}

bool lease_promise(struct lease *lease, int64_t now_ns)
{
    if (!lease->leads)
        lease->heard_ns = now_ns;
    if (lease->leads || lease->bids)
        return false;
    lease->bound_ns = now_ns + LEASE_NS;
    return true;
}

/* --- a leader ----------------------------------------------------------------------------------------------------------------- */

void lease_renew(struct lease *lease, const char *standby)
{
    /* from now on, promises of the previous standby not to bid no longer extend the lease, because the renewal may already have
       made another core the standby in the database row */
    if (strcmp(lease->counts, standby) != 0)
        lease->counts[0] = 0;
}

void lease_renewed(struct lease *lease, const char *standby, int64_t sent_ns)
{
    lease->row.beat++;
    snprintf(lease->row.standby, sizeof(lease->row.standby), "%s", standby);
    snprintf(lease->counts, sizeof(lease->counts), "%s", standby);
    take_until(lease, sent_ns);
}

void lease_promised(struct lease *lease, const char *standby, int64_t sent_ns)
{
    if (lease->leads && !lease->lost && standby[0] && !strcmp(lease->counts, standby))
        take_until(lease, sent_ns);
}

void lease_give(struct lease *lease)
{
    lease->leads = false;
    lease->gave = true;
}
