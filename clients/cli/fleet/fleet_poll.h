/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Asks the servers of a fleet for their metrics and pictures, in a thread of its own, each no faster than it allows. Thread: any. */
#ifndef CLI_FLEET_FLEET_POLL_H
#define CLI_FLEET_FLEET_POLL_H
#include "fleet_state.h"

struct fleet_poll;
/* file must outlive it. Returns NULL with the reason printed. */
struct fleet_poll *fleet_poll_start(const struct fleet_file *file);
void fleet_poll_stop(struct fleet_poll **poll); /* cuts off what is under way; &NULL is fine; leaves NULL */

/* Return copies of what is known now; mem_free. */
struct fleet_plant_state *fleet_poll_states(struct fleet_poll *poll);
/* The picture (PNG) of the plant of that id; NULL: there is none. */
char *fleet_poll_picture(struct fleet_poll *poll, const char *id, size_t *bytes);

#endif
