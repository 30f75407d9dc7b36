/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What net.c and reload.c share. Private to them. */
#ifndef NET_NET_IMPL_H
#define NET_NET_IMPL_H
#include <pthread.h>
#include <stdatomic.h>

#include "net/server_context.h"

struct net {
    struct server_context hub;
    struct lws_vhost *vhost;
    lws_sorted_usec_list_t tick;
    struct cpu_meter cpu;
    int64_t cpu_ns; /* when it was last read */
    _Atomic bool stopping, look;
    struct {
        pthread_mutex_t lock;
        pthread_cond_t done;
        /* --- below: under lock */
        void (*what)(void *arg); /* NULL: nothing is asked */
        void *arg;
        bool closed; /* the loop has ended */
    } call;
};

void net_calls_init(struct net *net);
void net_calls_finish(struct net *net);
void net_calls_run(struct net *net);   /* what is asked */
void net_calls_close(struct net *net); /* nobody waits any longer */
void net_bind_plant(struct net *net);  /* makes what depends on the plant of hub->params */
bool net_open_history(struct net *net);

#endif
