/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A renderer that has lost its core reports that at its agent port (agent.h), which the load balancer queries once a second. In
   its checks of the nodes, the balancer says whether it still sends users to the node. From this, core_loss decides whether
   sessions move. */
#include "net/core_loss.h"

#include <stdio.h>
#include <string.h>

#include "base/clock.h"

/* delay after the loss of a core before the load balancer's state is used. Renderers may notice the loss of the same core half
   a second apart, and the balancer queries each renderer only once a second */
static const int64_t SETTLE_NS = 2500 * NS_PER_MS;
/* The load balancer checks this node once a second and then says whether it sends users only to other nodes; its last report
   counts for this long */
static const int64_t CHECKED_NS = 3 * NS_PER_S;

static bool is_elsewhere(const char *state)
{
    const char *weight = strstr(state, "; weight=");
    int own, all;
    return !strncmp(state, "DOWN", 4) && weight && sscanf(weight, "; weight=%d/%d", &own, &all) == 2 && all > 0;
}

void core_loss_on_check(struct core_loss *loss, const char *state, int64_t now_ns)
{
    loss->elsewhere_ns = is_elsewhere(state) ? now_ns : 0;
}

bool core_loss_on_tick(struct core_loss *loss, bool has_core, int64_t now_ns)
{
    bool moved = loss->moves_ns != 0;
    if (has_core)
        loss->lost_ns = 0;
    else if (!loss->lost_ns)
        loss->lost_ns = now_ns;
    bool moves = loss->lost_ns && loss->elsewhere_ns - loss->lost_ns >= SETTLE_NS && now_ns - loss->elsewhere_ns < CHECKED_NS;
    loss->moves_ns = !moves ? 0 : moved ? loss->moves_ns : now_ns;
    return moves && !moved;
}
