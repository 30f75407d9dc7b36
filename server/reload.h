/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reload: loads the plant again while the daemon runs, completely or not at all, on a thread of its own. */
#ifndef RELOAD_H
#define RELOAD_H
#include "corelink/core_identity.h"
#include "importing/plant_import.h"
#include "plant_runtime.h"
#include "supervision.h"

struct reload;
/* Starts the reload thread, and a second thread that can make this core the leader or end its lead. Each reload replaces
   *runtime. import NULL: imports are off. Returns NULL if a thread cannot start, already logged. */
struct reload *reload_create(const struct plant_runtime_context *context, struct plant_runtime **runtime, struct net *net,
                             struct supervision *supervision, struct plant_import *import);
/* Ends the threads; the event loop must have ended. Accepts a pointer to NULL; sets *reload to NULL. */
void reload_destroy(struct reload **reload);
/* Requests a reload without waiting for it; if one is running, another follows. who: the requesting user, copied. Returns the number
   of the request, by which net_report_reload() says that it is answered. Call from any thread. */
uint64_t reload_ask(struct reload *reload, const char *who);
/* On a renderer or a standby core, requests a reload because its core loads the plant. The new plant is activated once the core
   has ended the connection follow->session, which it does to switch to its own new plant; if the core does not switch, the new
   plant is dropped. A plant without the hash follow->expects is dropped. If this node's files on disk are not the ones that the
   core loads (follow->loads), nothing is loaded: once the core has switched, it refuses this node, and reload_match() gets the
   files. Does not wait. Call from any thread. */
void reload_follow(struct reload *reload, const struct core_follow *follow);
/* On a renderer or a standby core that its core refused because of its configuration: makes this node's files equal to the
   core's. Loads the files again if they are equal on disk already; otherwise gets the core's tag list, and saves it like
   reload_save(). Tries again, after 5 s at first and 5 min at last, until this succeeds or the core accepts this node; a standby
   tells its leader the reason. Does not replace a plant file or models, nor a tag list that was edited on this machine. files,
   configuration: the core's hashes. Does not wait. Call from any thread. */
void reload_match(struct reload *reload, const struct core_files *files, const char *configuration);
/* Records that this node and its core have the tag list with this hash, and cancels the order of reload_match(). Does not wait. Call
   from any thread. */
void reload_agree(struct reload *reload, const char *tags_hash);
/* Makes this core take the lead from the core that it followed, even while a reload is reading or preparing; does not wait. Call
   from any thread. */
void reload_lead(struct reload *reload);
/* Ends permanently everything that only the leader of two cores may do (plant_runtime_end_leading()), and then calls
   net_on_lead_ended(); does not wait. Call from any thread. */
void reload_end_leading(struct reload *reload);
/* Saves another tag list: replaces the file, runs plantcast-prep, and reloads the plant. If any of these steps fails, restores
   the old list. Takes ownership of `save`; one save at a time. Call from any thread. */
void reload_save(struct reload *reload, struct tag_save *save);
/* Carries out the import order accepted by plant_import_order(), on behalf of user `who`, without waiting for it. Call from any thread. */
void reload_import(struct reload *reload, const char *who);
/* Sets the metric that shows the hash of the configuration in use. in_force: true: the daemon uses this configuration. */
void reload_count(struct counters *counters, const char *hash, bool in_force);

#endif
