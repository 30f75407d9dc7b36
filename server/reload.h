/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reload: loads the plant anew while the daemon runs, completely or not at all, on a thread of its own. */
#ifndef RELOAD_H
#define RELOAD_H
#include "importing/plant_import.h"
#include "plant_runtime.h"
#include "supervision.h"

struct reload;
/* Starts the thread, and one that leads where another core may. *runtime is replaced by each reload. import: NULL: plants are not
   brought in here. Returns NULL if it cannot start, already logged. */
struct reload *reload_create(const struct plant_runtime_context *context, struct plant_runtime **runtime, struct net *net,
                             struct supervision *supervision, struct plant_import *import);
/* Ends the thread; the loop must have ended. &NULL is fine; leaves NULL. */
void reload_destroy(struct reload **reload);
/* Asks for a reload and does not wait; if one is under way, another follows it. who: asks; copied. Any thread. */
void reload_ask(struct reload *reload, const char *who);
/* Has this core take the place of the one that it followed, beside a reload that is being read or prepared; does not wait. Any thread. */
void reload_lead(struct reload *reload);
/* Puts another tag list in force: the file takes the list's name, plantcast-prep runs, and the plant is loaded anew; if any of that fails,
   the old list is put back. Takes save; one at a time. Any thread. */
void reload_save(struct reload *reload, struct tag_save *save);
/* Has the order that was taken (plant_import_order) carried out, as who gave it, and does not wait. Any thread. */
void reload_import(struct reload *reload, const char *who);
/* Sets the counter that says which configuration is in force. */
void reload_count(struct counters *counters, const char *hash, bool in_force);

#endif
