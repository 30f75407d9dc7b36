/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Requests metrics and pictures from a fleet's servers, on a thread of its own and never more often than the fleet file allows.
   Call from any thread. */
#ifndef CLI_FLEET_FLEET_POLL_H
#define CLI_FLEET_FLEET_POLL_H
#include "fleet_state.h"

struct fleet_poll;
/* Starts the thread. `file` must outlive the result. Returns NULL with the reason printed. */
struct fleet_poll *fleet_poll_start(const struct fleet_file *file);
void fleet_poll_stop(struct fleet_poll **poll); /* cancels requests in progress and ends the thread; &NULL is fine; sets *poll to NULL */

/* Returns an array (mem_free) with the current state of each plant, in the fleet file's order. */
struct fleet_plant_state *fleet_poll_states(struct fleet_poll *poll);
/* Returns a copy of the newest PNG of the plant with this id (mem_free), or NULL if there is none. */
char *fleet_poll_picture(struct fleet_poll *poll, const char *id, size_t *bytes);

#endif
