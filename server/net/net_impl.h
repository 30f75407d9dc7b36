/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The loop's own state. Private to net*.c. */
#ifndef NET_NET_IMPL_H
#define NET_NET_IMPL_H
#include <pthread.h>
#include <stdatomic.h>

#include "net/server_context.h"

#define HANDED_PROTOCOL "plantcast-handed-socket"

struct net {
    struct server_context server;
    struct lws_vhost *vhost;
    lws_sorted_usec_list_t timer; /* wakes the loop at timer_ns */
    int64_t timer_ns;
    int64_t ticked_ns;   /* when sessions last acted on the time */
    int64_t readings_ns; /* when the next snapshot is due (readings.c) */
    struct cpu_meter cpu;
    int64_t cpu_ns; /* when it was last read */
    _Atomic bool stopping, look, drain, readings_changed;
    struct {
        pthread_mutex_t turn; /* of who calls: one at a time */
        pthread_mutex_t lock;
        pthread_cond_t done;
        /* --- below: under lock */
        void (*what)(void *arg); /* NULL: no call waits */
        void *arg;
        bool closed; /* the loop has ended */
    } call;
};

/* --- net_calls.c --- */

void net_calls_init(struct net *net);
void net_calls_finish(struct net *net);
/* Runs the call that waits (net_call), if any. Thread: the loop. */
void net_calls_run(struct net *net);
/* Lets callers go: no more calls are run. Thread: the loop. */
void net_calls_close(struct net *net);

/* --- net_plant.c; thread: the loop --- */

/* Makes all that depends on server.params.plant, but history. */
void net_bind_plant(struct net *net);
/* Starts the readers of the plant's history, if there is one. Returns false if they cannot start, already logged. */
bool net_open_history(struct net *net);
/* Starts the thread that signs pictures, if there is a key. Returns false if it cannot start, already logged. */
bool net_open_signer(struct net *net);

/* --- readings.c; thread: the loop --- */

/* Brings server->snapshot and next_change_ns up to date. Returns whether readings changed since the last time. */
bool net_take_snapshot(struct server_context *server);
/* Notes which sources are connected and whether the clock is set. Returns whether any of that changed. */
bool net_check_links(struct server_context *server);
/* Has the loop woken by changes in the plant's store from now on, and takes a first snapshot. */
void net_watch_readings(struct net *net);
/* Ends that: the store may be destroyed. */
void net_unwatch_readings(struct net *net);
/* Takes a snapshot if one is due. Returns when the next is; INT64_MAX: not before something changes, or a client comes. */
int64_t net_update_readings(struct net *net, int64_t now_ns);

#endif
