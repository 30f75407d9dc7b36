/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Orderly shutdown of a leading core: it stops polling devices, sends all its state to its standby core, and gives the
   leadership lease to the standby. The event loop continues to serve meanwhile, so that the lease stays confirmed and renderers
   keep their readings until the standby leads. */
#include "base/clock.h"
#include "net/core_end.h"
#include "net/net.h"
#include "net/net_impl.h"
#include "net/renderers.h"

static const int64_t SEND_NS = 2 * NS_PER_S; /* time limit for the standby core to receive all state of this leading core */
static const int64_t TAKE_NS = NS_PER_S;     /* time limit for the standby core to take the leadership lease */

/* Carries out the present step of the handover of the lead to the standby core. Returns the next step once that is finished,
   else `step` itself. */
static enum hand_over_step next_step(struct net *net, enum hand_over_step step)
{
    struct server_context *server = &net->server;
    struct lease_keeper *keeper = server->params.keeper;
    int64_t now_ns = clock_mono_ns();
    const char *standby;
    switch (step) {
    case HAND_OVER_NONE:
        if (!keeper || !core_end_leads(server) || !renderers_have_standby(server))
            return HAND_OVER_DONE;
        server->life.hands_over = true;
        server->params.end_leading(server->params.reload_arg);
        return HAND_OVER_ENDS_POLLING;
    case HAND_OVER_ENDS_POLLING:
        if (!lease_keeper_leads(keeper))
            /* the leadership lease is lost to another core, so there is nothing to hand over: this process must end */
            return HAND_OVER_DONE;
        if (!atomic_load(&net->lead_ended))
            return step;
        server->life.lead_ended_ns = now_ns;
        net->hand_over.until_ns = now_ns + SEND_NS;
        return HAND_OVER_SENDS;
    case HAND_OVER_SENDS:
        renderers_on_change(server);
        standby = renderers_complete_standby(server);
        if (!standby && lease_keeper_leads(keeper) && now_ns < net->hand_over.until_ns)
            return step;
        if (!standby)
            log_warn(server->params.log,
                     "core: the standby did not receive all data within %d s; it takes over in %d s and may lack the latest data",
                     (int)(SEND_NS / NS_PER_S), (int)(LEASE_NS / NS_PER_S));
        lease_keeper_give(keeper, standby ? standby : "");
        net->hand_over.until_ns = now_ns + TAKE_NS;
        return HAND_OVER_GIVES;
    case HAND_OVER_GIVES: return lease_keeper_is_taken(keeper) || now_ns >= net->hand_over.until_ns ? HAND_OVER_DONE : step;
    case HAND_OVER_DONE: break;
    }
    return HAND_OVER_DONE;
}

bool net_hand_over(struct net *net)
{
    net->hand_over.step = next_step(net, net->hand_over.step);
    return net->hand_over.step != HAND_OVER_DONE;
}

void net_on_lead_ended(struct net *net)
{
    atomic_store(&net->lead_ended, true);
    net_wake(net);
}
