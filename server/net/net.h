/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The loop: HTTP and WebSocket on one port, sessions, timers. Thread: the one that calls net_run; net_wake and net_stop from any. */
#ifndef NET_NET_H
#define NET_NET_H
#include <stdbool.h>

#include "alarm/alarming.h"
#include "base/counters.h"
#include "base/log.h"
#include "net/access.h"
#include "net/painter.h"

struct net;
struct net_params {
    struct log *log;
    const struct scene *scene;
    struct store *store;
    struct painter *painter;
    struct baselines *baselines;
    struct alarming *alarming;
    struct moments *moments;
    struct counters *counters;
    const char *address;    /* numeric */
    int port;               /* 0: any that is free */
    struct access_params access;
    unsigned codecs;        /* a bit, 1 << enum wire_codec, for each that works here */
    const char *history_folder; /* NULL: nothing is recorded */
    const char *web_folder; /* NULL: no client is served */
    const char *version;
};

/* Whether the port could be bound now; if not, the reason is logged. For before the slow part of starting. */
bool net_port_free(struct log *log, const char *address, int port);
/* Whether its tokens and certificate can be used; likewise. */
bool net_access_good(struct log *log, const struct access_params *access);
/* Binds the port. NULL on failure, logged. All in params must outlive it. */
struct net *net_create(const struct net_params *params);
void net_destroy(struct net **net); /* &NULL is fine; leaves NULL */
int net_port(const struct net *net);
/* Serves until net_stop, then says good-bye to the clients. */
void net_run(struct net *net);
void net_wake(struct net *net); /* pictures are there */
void net_stop(struct net *net); /* safe in a signal handler */
void net_look(struct net *net); /* at the files of tokens and certificate, now; likewise safe */

#endif
