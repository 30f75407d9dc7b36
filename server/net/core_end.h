/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The side of a renderer or standby of its connection /core to the core, in the event loop: forwards users' actions to the
   core, and distributes what arrives from the core. Call only in the event loop. */
#ifndef NET_CORE_END_H
#define NET_CORE_END_H
#include "net/server_context.h"

/* On a renderer, makes sessions forward users' actions to the core over the plant's core_link. Does nothing on other daemons, which have no
   core_link. */
void core_end_bind(struct server_context *server);
/* Returns whether this daemon polls devices and owns alarms: it is neither a renderer nor a standby core. */
bool core_end_leads(const struct server_context *server);
/* Takes over everything that the core sent since the last call: readings, alarms, answers. */
void core_end_collect(struct server_context *server);

#endif
