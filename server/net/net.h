/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The loop: HTTP and WebSocket on one port, sessions, timers. Thread: the one that calls net_run; net_wake and net_stop from any. */
#ifndef NET_NET_H
#define NET_NET_H
#include <stdbool.h>

#include "alarm/alarm_service.h"
#include "base/counters.h"
#include "base/log.h"
#include "access/access.h"
#include "service/render_service.h"
#include "placing/tag_file.h"
#include "loopcheck/loop_checks.h"

struct net;
struct net_plant { /* what is another once the plant is loaded anew */
    const struct scene *scene;
    struct store *store;
    struct render_service *painter;
    struct baselines *baselines;
    struct snapshot_cache *snapshot_cache;
    struct alarm_service *alarm_service;
    struct placing *placing;         /* NULL: sensors cannot be placed */
    struct loop_checks *loop_checks; /* NULL: nothing can be proven */
    const char *tag_list;            /* the text in force; NULL: not known */
    const char *history_folder;      /* NULL: nothing is recorded */
};

struct net_params {
    struct log *log;
    struct net_plant plant;
    struct counters *counters;
    const char *address; /* numeric */
    int port;            /* 0: any that is free */
    struct access_params access;
    unsigned codecs;        /* a bit, 1 << enum wire_codec, for each that works here */
    const char *web_folder; /* NULL: no client is served */
    const char *version;
    void (*reload)(void *arg);                      /* load the plant anew: somebody asks for it; in the loop. NULL: cannot be done */
    void (*save)(void *arg, struct tag_save *save); /* put another tag list in force: takes it; likewise, NULL: cannot be done */
    void *reload_arg;
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
/* Has the loop do something; returns once it is done. Any thread but the loop. False: the loop has ended. */
bool net_call(struct net *net, void (*what)(void *arg), void *arg);
/* In the loop: lets go of all that is of the plant, before any of it is destroyed; then takes another. Sessions stay, and look at what
   is still there by the same name. False: history cannot be read any more (logged). */
void net_release_plant(struct net *net);
bool net_take_plant(struct net *net, const struct net_plant *plant);
/* In the loop, before: what sessions look at, as they will in that plant, each view once. Its painter need not be there. Their number. */
size_t net_views(struct net *net, const struct net_plant *next, struct view *out, size_t most);
void net_report_reload(struct net *net, bool good, const char *text); /* in the loop: to those who asked for it */
/* In the loop: what became of a list that somebody wanted in force. */
void net_report_save(struct net *net, uint64_t client, const char *text);
void net_check_credentials(struct net *net); /* at the files of tokens and certificate, now; likewise safe */

#endif
