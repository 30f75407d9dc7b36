/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tells a load balancer how much this daemon can still draw: whoever connects to the port is sent one line of HAProxy's agent check, and
   the connection is closed. One thread. */
#ifndef AGENT_H
#define AGENT_H
#include <stdbool.h>

#include "base/log/log.h"

struct agent_state {
    int busy_percent; /* of the render thread's time */
    bool has_core;    /* readings come */
    bool drains;      /* sessions are being sent elsewhere */
};

struct agent;
/* Returns NULL if the port cannot be had, or there is no thread (logged). address: numeric. */
struct agent *agent_start(struct log *log, const char *address, int port);
void agent_stop(struct agent **agent); /* &NULL is fine; leaves NULL */
/* Says how it is from now on. Any thread. */
void agent_tell(struct agent *agent, const struct agent_state *state);

#endif
