/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parameters of the event loop: the plant that it serves, where it listens, and how clients gain access. */
#ifndef NET_NET_PARAMS_H
#define NET_NET_PARAMS_H
#include <stdbool.h>

#include "access/pairings.h"
#include "alarm/alarm_service.h"
#include "audit/audit.h"
#include "base/metrics/counters.h"
#include "base/log/log.h"
#include "corelink/core_identity.h"
#include "corelink/core_link.h"
#include "history/historian.h"
#include "notify/notifier.h"
#include "importing/plant_import.h"
#include "loopcheck/loop_checks.h"
#include "views/named_views.h"
#include "views/notes.h"
#include "views/short_links.h"
#include "views/wall_remote.h"
#include "placing/tag_file.h"
#include "service/render_service.h"
#include "session/plant_services.h"

struct net_status { /* state of the event loop, passed to the callback net_params.tick, which is called once a second or more often */
    struct render_service *render_service;
    size_t sessions;
    int busy_percent;           /* percentage of the render thread's time spent on frames that a client waits for */
    bool has_core;              /* true: readings arrive from the core; always true without --role render */
    const char *core;           /* role of this core in a pair of cores (static text); NULL: there is no pair */
    bool drains;                /* true: the daemon is draining: it closes sessions so that their clients move to other daemons */
    int64_t certificate_ends_s; /* expiry of the active certificate, in seconds since 1970 (UTC); 0: no certificate */
};

struct net_params {
    struct log *log;
    struct plant_services plant; /* services of the loaded plant; net_limit_services() sets those to NULL that this daemon cannot use */
    struct counters *counters;
    struct audit *audit;             /* writer of the audit trail; NULL: nothing is recorded */
    struct file_writer *file_writer; /* thread that writes users' changes to disk; the event loop collects its results */
    const char *address; /* numeric address to listen on */
    int port;            /* port to listen on; 0: any free one */
    int socket_fd;       /* socket that already listens, opened by systemd (net/handed_socket.h); -1: none */
    int64_t begun_ns;    /* monotonic time when the daemon began to start */
    struct access_params access;
    const struct signing_key *signing_key; /* key that signs pictures; NULL: pictures are not signed */
    unsigned codecs;                       /* bit mask of the codecs available on this machine (1 << enum wire_codec) */
    const char *web_folder;                /* folder of the web client's files; NULL: no page is served */
    const char *version;
    const char *node;            /* this daemon's name behind a load balancer; NULL: it runs alone */
    bool is_core;                /* true: this daemon is a core, which accepts connections of renderers */
    const char *node_name;       /* name by which other daemons of the plant know this daemon */
    struct lease_keeper *keeper; /* leadership lease of a core in a pair (leader or standby); NULL: there is no pair */
    /* callback in the event loop, set only with `keeper`: starts a thread that ends everything that only a leader may do. At
       its end, that thread calls net_on_lead_ended() */
    void (*end_leading)(void *arg);
    /* callback in the event loop that reloads the plant for user `who` and returns the number of the request (reload_ask()); NULL: the
       plant cannot be reloaded */
    uint64_t (*reload)(void *arg, const char *who);
    /* callback in the event loop that reloads the plant because this daemon's core reloads it, see reload_follow(). NULL: this daemon has
       no core */
    void (*follow)(void *arg, const struct core_follow *follow);
    /* callback in the event loop that gets the leading core's tag list, see reload_match(). NULL: this daemon has no core */
    void (*match)(void *arg, const struct core_files *files, const char *configuration);
    /* callback in the event loop that records that both cores have the tag list with this hash; set only with `keeper` */
    void (*agree)(void *arg, const char *tags_hash);
    /* callback in the event loop that activates a saved tag list and takes ownership of `save`; NULL: tag lists cannot be saved */
    void (*save)(void *arg, struct tag_save *save);
    struct plant_import *import; /* service that imports plants; NULL: import is off */
    /* called in the event loop after an engineer `who` ordered an import; set only with `import` */
    void (*import_ordered)(void *arg, const char *who);
    /* callback of the main program, called in the event loop once a second or more often; NULL: not needed */
    void (*tick)(void *arg, const struct net_status *status);
    void *reload_arg; /* first argument of all callbacks above, set by the caller */
};

#endif
