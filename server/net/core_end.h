/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The renderer's end of /core in the loop: sessions hand on what people do, and what comes from the core goes where it belongs.
   Thread: the loop. */
#ifndef NET_CORE_END_H
#define NET_CORE_END_H
#include "net/server_context.h"

/* Has sessions hand on to the plant's core_link, if it has one. */
void core_end_bind(struct server_context *server);
/* Returns whether this daemon polls and owns alarms: no renderer, and no core that stands by. */
bool core_end_leads(const struct server_context *server);
/* Takes what came from the core since. */
void core_end_collect(struct server_context *server);

#endif
