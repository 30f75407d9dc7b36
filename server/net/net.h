/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The loop: HTTP and WebSocket on one port, sessions, timers. Thread: the one that calls net_run, for functions that say "in the loop";
   net_wake, net_stop and net_call from any. */
#ifndef NET_NET_H
#define NET_NET_H
#include "net/net_params.h"

struct net;
/* Returns whether the port can be bound now; if not, the reason is logged. For before the slow part of starting. */
bool net_port_free(struct log *log, const char *address, int port);
/* Returns whether the configured tokens and certificate can be used; if not, the reason is logged. */
bool net_access_good(struct log *log, const struct access_params *access);
/* Binds the port. Returns NULL on failure, already logged. What params point at must outlive it. */
struct net *net_create(const struct net_params *params);
/* Closes all. &NULL is fine; leaves NULL. */
void net_destroy(struct net **net);
/* Returns the port that is bound. */
int net_port(const struct net *net);
/* Serves until net_stop, then closes the connections of clients. */
void net_run(struct net *net);
/* Lets the loop collect frames and answers. Any thread. */
void net_wake(struct net *net);
/* Ends net_run. Any thread; safe in a signal handler. */
void net_stop(struct net *net);
/* Sends all sessions elsewhere from now on, one after the other: each is closed at some instant of 10 s, after a load balancer had 2 s
   to hear of it (net_status.drains). Any thread; safe in a signal handler. */
void net_drain(struct net *net);
/* Has the loop call what(arg), and returns once that is done. Any thread but the loop. Returns false if the loop has ended. */
bool net_call(struct net *net, void (*what)(void *arg), void *arg);
/* Has the files of tokens and certificate read again soon, and the plant reloaded. Any thread; safe in a signal handler. */
void net_check_credentials(struct net *net);

/* --- in the loop, while the plant is loaded anew --- */

/* Lets go of the plant's historian and notifier, which end before the rest of it. */
void net_release_recording(struct net *net);
/* Releases all that belongs to the plant, which is to be destroyed. Sessions stay. */
void net_release_plant(struct net *net);
/* The core that was followed is gone, and its link halted: takes what is there of the same plant without it. */
void net_lead(struct net *net, const struct net_plant *plant);
/* Takes another plant, in which sessions look at what is still there by the same name. Returns false if history cannot be read any more,
   already logged. */
bool net_take_plant(struct net *net, const struct net_plant *plant);
/* Writes the views that sessions will have in the next plant, each once, into out. Returns how many. next->render_service may be NULL. */
size_t net_views(struct net *net, const struct net_plant *next, struct view *out, size_t most);
/* Tells those who asked for a reload what came of it. */
void net_report_reload(struct net *net, bool good, const char *text);
/* Sends a client the text that says what became of the tag list it saved. */
void net_report_save(struct net *net, uint64_t client, const char *text);

#endif
