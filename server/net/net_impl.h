/* SPDX-License-Identifier: GPL-3.0-or-later */
/* State of the event loop as a whole. Private to net*.c. */
#ifndef NET_NET_IMPL_H
#define NET_NET_IMPL_H
#include <pthread.h>
#include <stdatomic.h>

#include "net/server_context.h"

#define HANDED_PROTOCOL "plantcast-handed-socket"

/* minimum time in nanoseconds between two snapshots of the readings, however often readings change */
#define READINGS_INTERVAL_NS (100 * NS_PER_MS)

enum hand_over_step { HAND_OVER_NONE, HAND_OVER_ENDS_POLLING, HAND_OVER_SENDS, HAND_OVER_GIVES, HAND_OVER_DONE };

struct net {
    struct server_context server;
    struct lws_vhost *vhost;
    lws_sorted_usec_list_t timer; /* timer of libwebsockets that wakes the event loop at the monotonic time timer_ns */
    int64_t timer_ns;
    int64_t ticked_ns;   /* monotonic time when the event loop last called session_on_tick() (timed work) for its sessions */
    int64_t readings_ns; /* monotonic time when the next snapshot of readings is due (reading_updates.c) */
    struct cpu_meter cpu;
    int64_t cpu_ns; /* monotonic time when the event loop last measured how busy the processors are */
    _Atomic bool stopping, look, drain, readings_changed, lead_ended;
    struct { /* steps of the shutdown in which this core hands the lead to its standby (hand_over.c) */
        enum hand_over_step step;
        int64_t until_ns; /* monotonic time at which the current step of handing the lead to the standby core is given up */
    } hand_over;
    struct {
        pthread_mutex_t turn; /* lock held by the thread that is in net_call(), so that only one thread calls at a time */
        pthread_mutex_t lock;
        pthread_cond_t done;
        /* --- below: protected by `lock` */
        void (*what)(void *arg); /* function that net_call() has queued for the event loop; NULL: none */
        void *arg;
        bool closed; /* true: the event loop has ended, so net_call() fails */
    } call;
};

/* --- net.c; thread: the event loop --- */

/* Answers users' actions that have reached the disk or could not be written. Returns whether other actions still wait for the disk. */
bool net_settle_answers(struct net *net);

/* --- hand_over.c; thread: the event loop --- */

/* After net_stop() was called on a leading core: takes the next step of handing the lead to the standby core. Returns false
   once all steps are done. */
bool net_hand_over(struct net *net);

/* --- net_calls.c --- */

void net_calls_init(struct net *net);
void net_calls_finish(struct net *net);
/* Runs the waiting call (net_call), if any. Call only in the event loop. */
void net_calls_run(struct net *net);
/* Releases the threads that wait in net_call(); their calls are not run. Call only in the event loop. */
void net_calls_close(struct net *net);

/* --- net_plant.c; thread: the event loop --- */

/* Creates the parts of the event loop that depend on server.params.plant, except history. */
void net_bind_plant(struct net *net);
/* Starts the readers of the plant's history, if there is one. Returns false if they cannot start, already logged. */
bool net_open_history(struct net *net);
/* Sets those services in server->params.plant to NULL that this daemon cannot offer: snapshot_cache if nothing is recorded,
   placing if this daemon cannot save tag lists. Call after each change of params.plant. */
void net_limit_services(struct server_context *server);
/* Starts the thread that signs pictures, if there is a key. Returns false if it cannot start, already logged. */
bool net_open_signer(struct net *net);

/* --- readings.c, reading_updates.c; thread: the event loop --- */

/* Takes a new snapshot of the readings into server->readings. Returns whether readings changed since the last call. */
bool net_take_snapshot(struct server_context *server);
/* Updates which data sources are connected and whether this machine's clock is set. Returns whether any of these changed. */
bool net_check_links(struct server_context *server);
/* Takes a snapshot of the readings, checks the connections to data sources, and notes in server->readings what changed. */
void net_note_changes(struct server_context *server);
/* From now on, changes in the plant's store of readings wake the event loop. Takes a first snapshot. */
void net_watch_readings(struct net *net);
/* Undoes net_watch_readings(); the store of readings may be destroyed afterwards. */
void net_unwatch_readings(struct net *net);
/* Takes a snapshot of the readings if one is due, and tells streams and renderers what changed since the last call. Returns when the next
   snapshot is due; INT64_MAX: not before a reading changes or a client connects. */
int64_t net_update_readings(struct net *net, int64_t now_ns);

#endif
