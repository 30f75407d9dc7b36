/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decides when a renderer that has lost all cores moves its sessions to other nodes. They move only while the load balancer
   says that it sends users to other nodes. If all renderers have lost the cores, the sessions stay. Call from one thread at a
   time; takes the time as a parameter. */
#ifndef NET_CORE_LOSS_H
#define NET_CORE_LOSS_H
#include <stdbool.h>
#include <stdint.h>

struct core_loss {   /* zero-initialise; zero means that a core sends readings and that no load balancer has checked this node */
    /* monotonic time since which this renderer has had readings from no core (daemon that reads the devices); 0: a core sends
       readings */
    int64_t lost_ns;
    /* monotonic time when a load balancer last said that it sends users only to other nodes; 0: its last check did not say so */
    int64_t elsewhere_ns;
    int64_t moves_ns; /* monotonic time when this daemon began to move its sessions to other nodes; 0: they stay */
};

/* Takes the header X-Haproxy-Server-State of a load balancer's check of this node, such as "DOWN 2/2; ...; weight=0/100; ...". The balancer
   sends users only to other nodes if this node is DOWN and the second number of `weight`, the sum of the weights of all nodes in use, is
   above 0. */
void core_loss_on_check(struct core_loss *loss, const char *state, int64_t now_ns);
/* Decides from the loss of the core and the load balancer's last report whether this daemon's sessions move to other nodes.
   Call it at each tick. Returns true once when they start to move. */
bool core_loss_on_tick(struct core_loss *loss, bool has_core, int64_t now_ns);

#endif
