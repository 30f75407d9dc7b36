/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Wall displays of control rooms: which are connected and how old their pictures are, for desks and for /metrics. Call only in
   the event loop. */
#ifndef NET_WALL_DISPLAYS_H
#define NET_WALL_DISPLAYS_H
#include "net/server_context.h"

/* Updates the list of displays and their ages. Call it about once a second. */
void wall_displays_count(struct server_context *server, int64_t now_ns);

#endif
