/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the loop is given: the plant that it serves, where it listens, and who is let in. */
#ifndef NET_NET_PARAMS_H
#define NET_NET_PARAMS_H
#include <stdbool.h>

#include "access/pairings.h"
#include "alarm/alarm_service.h"
#include "audit/audit.h"
#include "base/metrics/counters.h"
#include "base/log/log.h"
#include "corelink/core_link.h"
#include "history/historian.h"
#include "notify/notifier.h"
#include "importing/plant_import.h"
#include "loopcheck/loop_checks.h"
#include "views/named_views.h"
#include "views/notes.h"
#include "views/wall_remote.h"
#include "placing/tag_file.h"
#include "service/render_service.h"

struct net_plant { /* what belongs to one loaded plant; a reload brings another */
    const struct scene *scene;
    struct store *store;
    struct render_service *render_service;
    struct baselines *baselines;
    struct snapshot_cache *snapshot_cache;
    struct alarm_service *alarm_service;
    struct placing *placing;         /* NULL: sensors cannot be placed */
    struct notes *notes;
    struct wall_remote *wall_remote;
    struct other_plants *other_plants; /* NULL: the plant file names none */
    struct pairings *pairings;
    struct named_views *named_views;
    struct core_link *core_link;     /* of a renderer; NULL: this daemon reads its devices itself */
    struct historian *historian;     /* NULL: nothing is recorded */
    struct notifier *notifier;       /* NULL: nobody is told of alarms */
    struct loop_checks *loop_checks; /* NULL: loops cannot be checked */
    const char *tag_list;            /* the text in force; NULL: not known */
    const char *history_folder;      /* NULL: nothing is recorded */
};

struct net_status { /* what the loop says of itself with each tick */
    struct render_service *render_service;
    size_t sessions;
    int busy_percent;            /* of the render thread's time, for moving pictures */
    bool has_core;               /* readings come; true without --role render */
    bool lacks_standby;          /* this core leads one of two, and the other does not follow */
    bool drains;                 /* sessions are being sent elsewhere */
    int64_t certificate_ends_s; /* seconds of UTC since 1970; 0: there is none */
};

struct net_params {
    struct log *log;
    struct net_plant plant;
    struct counters *counters;
    struct audit *audit; /* NULL: nothing is recorded */
    const char *address; /* to listen on, numeric */
    int port;            /* 0: any that is free */
    int socket_fd;       /* which listens there already (net/handed_socket.h); -1: none */
    int64_t begun_ns;    /* monotonic: when the daemon began to start */
    struct access_params access;
    const struct signing_key *signing_key; /* NULL: pictures are not signed */
    unsigned codecs;        /* a bit, 1 << enum wire_codec, for each that works here */
    const char *web_folder; /* the page's files; NULL: no page is served */
    const char *version;
    const char *node;       /* as in struct session_context */
    bool is_core;           /* renderers may connect */
    const char *node_name;  /* this daemon's among others */
    struct lease_keeper *keeper; /* of a core that has a standby, or is one; NULL: none */
    void (*reload)(void *arg, const char *who);     /* called in the loop: load the plant anew, as who asks. NULL: it cannot be */
    void (*save)(void *arg, struct tag_save *save); /* called in the loop: put another tag list in force; takes it. NULL: it cannot be */
    struct plant_import *import;                    /* NULL: plants are not brought in here */
    void (*import_ordered)(void *arg, const char *who); /* called in the loop: an order was taken. Only with import */
    void (*tick)(void *arg, const struct net_status *status); /* called in the loop, once a second or more often. NULL: nobody asks */
    void *reload_arg;                                         /* of these four */
};

#endif
