/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tells a load balancer how much capacity this daemon has left. Each connection to the agent's port receives one line of HAProxy's agent
   check and is closed. Uses a thread of its own. */
#ifndef AGENT_H
#define AGENT_H
#include <stdbool.h>

#include "base/log/log.h"

struct agent_state {
    int busy_percent; /* load of the render thread in percent of its time */
    bool has_core;    /* true: readings arrive; false only on a renderer that has lost its core */
    bool drains;      /* true: the daemon is being drained (it sends its sessions to other daemons) */
};

struct agent;
/* Starts the thread. address: numeric address to listen on. Returns NULL if the port cannot be bound or the thread cannot start
   (logged). */
struct agent *agent_start(struct log *log, const char *address, int port);
void agent_stop(struct agent **agent); /* ends the thread, frees the agent and sets *agent to NULL; accepts a pointer to NULL */
/* Sets the state that the agent reports from now on. Call from any thread. */
void agent_tell(struct agent *agent, const struct agent_state *state);

#endif
