/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decides when a renderer that has lost all cores moves its sessions to other nodes: only while the load balancer says that it sends users
   to other nodes. If all renderers have lost the cores, the sessions stay. Thread: one at a time; takes the time as a parameter. */
#ifndef NET_CORE_LOSS_H
#define NET_CORE_LOSS_H
#include <stdbool.h>
#include <stdint.h>

struct core_loss {   /* zero-initialised: a core sends readings, and no balancer has asked */
    int64_t lost_ns; /* monotonic time since when no core sends readings; 0: a core sends readings */
    /* monotonic time when a balancer last stated that only other nodes get users; 0: its last statement was different */
    int64_t elsewhere_ns;
    int64_t moves_ns; /* monotonic time since when sessions are being moved; 0: they stay */
};

/* Takes the header X-Haproxy-Server-State of a balancer's check, such as "DOWN 2/2; ...; weight=0/100; ...". The balancer sends users only
   to other nodes if this node is DOWN and the second number of `weight`, the sum of the weights of all nodes in use, is above 0. */
void core_loss_on_check(struct core_loss *loss, const char *state, int64_t now_ns);
/* Updates the decision. Call it at each tick. Returns true when the sessions begin to be moved. */
bool core_loss_on_tick(struct core_loss *loss, bool has_core, int64_t now_ns);

#endif
