/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Loading the plant anew while the daemon runs: all of it, or nothing. A thread of its own. */
#ifndef RELOAD_H
#define RELOAD_H
#include "plant_runtime.h"

struct reload;
/* Works on *loaded, which is another one after a reload. NULL: no thread, logged. */
struct reload *reload_create(const struct plant_runtime_context *context, struct plant_runtime **loaded, struct net *net);
void reload_destroy(struct reload **reload); /* once the loop has ended; &NULL is fine; leaves NULL */
void reload_ask(void *reload);               /* any thread; soon */
/* Puts another tag list in force: it takes the name, plantcast-prep runs, the plant is loaded anew. All of it, or the list is put back.
   Takes it; one at a time. Any thread. */
void reload_save(struct reload *reload, struct tag_save *save);
/* Says which configuration is in force, in the counters. */
void reload_count(struct counters *counters, const char *hash, bool in_force);

#endif
