/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The event loop: HTTP and WebSocket on one port, sessions, timers. Call only in the thread that calls net_run(), unless a
   function's comment says otherwise. */
#ifndef NET_NET_H
#define NET_NET_H
#include "net/net_params.h"

struct net;
/* Returns whether the port can be bound now; if not, the reason is logged. Call it before the slow part of the start. */
bool net_port_free(struct log *log, const char *address, int port);
/* Returns whether the configured tokens and certificate can be used; if not, the reason is logged. */
bool net_access_good(struct log *log, const struct access_params *access);
/* Binds the port. Returns NULL on failure, already logged. Everything to which params point must outlive the loop. */
struct net *net_create(const struct net_params *params);
/* Closes all connections, frees the event loop and sets *net to NULL; accepts a pointer to NULL. */
void net_destroy(struct net **net);
/* Returns the number of the TCP port on which the server listens. */
int net_port(const struct net *net);
/* Serves until net_stop() is called, then closes the clients' connections. */
void net_run(struct net *net);
/* Wakes the event loop to collect frames and answers that other threads have finished. Any thread. */
void net_wake(struct net *net);
/* Makes net_run() end. A leading core that has a standby first hands the lead to the standby. Any thread; safe in a signal handler. */
void net_stop(struct net *net);
/* Drains the daemon, so that clients move to other daemons: each session is closed at some instant within 10 s, after load balancers had 2
   s to notice (net_status.drains). Any thread; safe in a signal handler. */
void net_drain(struct net *net);
/* Makes the event loop call what(arg), and returns once that is done. Any thread but the event loop's. Returns false if the event loop
   has ended. */
bool net_call(struct net *net, void (*what)(void *arg), void *arg);
/* Makes the event loop soon reload the plant and read the files of tokens and certificate again. Any thread; safe in a signal handler. */
void net_check_credentials(struct net *net);

/* Tells the event loop of a stopping core that all leader-only work has ended, so that the shutdown continues. Call it only
   after net_params.end_leading was called. Any thread. */
void net_on_lead_ended(struct net *net);

/* --- plant reload; call these functions in the event loop --- */

/* Drops the pointer to the plant's historian, which is about to be destroyed. */
void net_release_historian(struct net *net);
/* Drops the pointers to the plant's historian and notifier, which the caller is about to destroy before the rest of the plant. */
void net_release_recording(struct net *net);
/* Tells this core's renderers that the core begins to load the plant, so that they do the same. configuration: hash of the plant
   file and tag list that the core loads. */
void net_announce_reload(struct net *net, const char *configuration);
/* Releases everything that belongs to the plant, which is about to be destroyed. Sessions stay. */
void net_release_plant(struct net *net);
/* Called when this standby takes over: the core that it followed is gone, and the link to that core has stopped. plant: services of the
   same plant, without core_link. */
void net_lead(struct net *net, const struct plant_services *plant);
/* Switches to another plant. Sessions keep their views, except for items whose names the new plant lacks. Returns false if
   history cannot be read any more, already logged. */
bool net_take_plant(struct net *net, const struct plant_services *plant);
/* Writes to `out` up to `most` distinct views that sessions will show after the switch to the next plant, so that they can be
   drawn in advance. Returns their number. next->render_service may be NULL. */
size_t net_views(struct net *net, const struct plant_services *next, struct view *out, size_t most);
/* Answers the HTTP requests for a reload up to this number (net_params.reload) with the reload's result. */
void net_report_reload(struct net *net, uint64_t number, bool good, const char *text);
/* Sends a client the result (as text) of saving the client's tag list. */
void net_report_save(struct net *net, uint64_t client, const char *text);

#endif
