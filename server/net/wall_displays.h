/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Displays of control rooms: which are connected, and how old what they show is, for desks and for /metrics. Thread: the loop. */
#ifndef NET_WALL_DISPLAYS_H
#define NET_WALL_DISPLAYS_H
#include "net/server_context.h"

/* Counts them. To be called every second or so. */
void wall_displays_count(struct server_context *server, int64_t now_ns);

#endif
