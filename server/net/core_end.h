/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A renderer's or standby's end of the connection to its core (path /core): forwards users' actions to the core, and
   distributes messages that arrive from the core. Call only in the event loop. */
#ifndef NET_CORE_END_H
#define NET_CORE_END_H
#include "net/server_context.h"

/* On a renderer, makes sessions forward users' actions to the core through core_link. Does nothing on other daemons, which have
   no core_link. */
void core_end_bind(struct server_context *server);
/* Returns whether this daemon polls devices and owns alarms: it is neither a renderer nor a standby core. */
bool core_end_leads(const struct server_context *server);
/* On a renderer or standby: takes over everything that the core (the daemon that reads the devices) sent since the last call:
   readings, alarms, answers. */
void core_end_collect(struct server_context *server);

#endif
