/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The load balancer asks each renderer at its agent port (agent.h) once a second and thereby learns that a core is lost. With its next
   check it sends its own state, from which core_loss decides whether sessions move. */
#include "net/core_loss.h"

#include <stdio.h>
#include <string.h>

#include "base/clock.h"

/* delay after the loss of a core from which the balancer's statement counts: renderers that lost the same core may notice it half a second
   apart, and the balancer asks each renderer once a second */
static const int64_t SETTLE_NS = 2500 * NS_PER_MS;
static const int64_t CHECKED_NS = 3 * NS_PER_S; /* validity of a balancer's statement: three checks, of which it makes one a second */

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
