/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The plant runtime: a loaded plant and all parts of the daemon that depend on it. A reload creates a new one. Thread: one at a time. */
#ifndef PLANT_RUNTIME_H
#define PLANT_RUNTIME_H
#include "alarm/alarm_service.h"
#include "base/workers.h"
#include "history/historian.h"
#include "net/net.h"
#include "notify/notifier.h"
#include "notify/publisher.h"
#include "placing/placing.h"
#include "server_params.h"
#include "value/derived.h"
#include "value/source.h"
#include "views/other_plants.h"

struct plant_runtime_context { /* parts that a reload keeps */
    const struct server_params *params;
    struct log *log;
    struct counters *counters;
    struct audit *audit; /* the audit trail; NULL: nothing is recorded */
    struct workers *workers;
    struct lease_keeper *keeper; /* leadership lease of a core that has a standby, or is one; NULL: none */
    bool *follows;               /* true: another core polls devices and owns the alarms; plant_runtime_lead() sets it to false */
    void (*notify)(void *arg);   /* called when frames, or changes of alarms, can be collected; by any thread */
    void *notify_arg;
};

struct plant_runtime {
    const struct plant_runtime_context *context;
    struct plant *plant;
    struct scene *scene;
    struct store *store;
    struct baselines *baselines;
    struct snapshot_cache *snapshot_cache;
    struct historian *historian; /* NULL: nothing is recorded */
    /* samples not yet written to PostgreSQL when a reload replaces the plant; the next runtime's historian writes them */
    struct postgres_owed owed;
    struct alarm_service *alarm_service;
    struct notifier *notifier;   /* sends alarm notifications; NULL: none are sent */
    struct publisher *publisher; /* NULL: nothing is published */
    struct source **sources;     /* sources by index in plant->sources */
    struct core_link *core_link; /* on a renderer or a standby core: link to the core, in place of sources; otherwise NULL */
    struct source *derived;      /* computes derived tags; NULL: there are none */
    struct render_service *render_service;
    char *history; /* folder of the history; NULL: nothing is recorded */
    struct placing *placing;
    struct named_views *named_views;
    struct notes *notes;
    struct wall_remote *wall_remote;
    struct other_plants *other_plants; /* NULL: the plant file names none */
    struct pairings *pairings;
    struct loop_checks *loop_checks; /* NULL: nothing is recorded */
    char *tag_list;                  /* text of the tag list; NULL: it could not be read */
};

/* Reads plant and scene from disk and creates the store; starts nothing. Findings are added to diag. Returns NULL on failure; the error
   is in diag or in the log. */
struct plant_runtime *plant_runtime_read(const struct plant_runtime_context *context, struct diag *diag);
/* Ends the running parts in the order consumers before producers, and frees everything. &NULL is allowed; sets *runtime to NULL. */
void plant_runtime_destroy(struct plant_runtime **runtime);

/* Opens the files that users change: named views, notes, desks' messages to walls. After a reload, call it in the event loop when the
   runtimes are switched: the old runtime changes these files until then. */
void plant_runtime_open_lists(struct plant_runtime *runtime);
/* Starts historian and alarms; without an earlier runtime also opens the lists. before: the runtime whose history, alarms and readings
   are continued, on which plant_runtime_hand_over() was called; the caller still destroys it. NULL: none. Returns false on failure,
   already logged. */
bool plant_runtime_start_recording(struct plant_runtime *runtime, struct plant_runtime *before);
/* Starts the field devices' sources and derived tags. Returns false on failure, already logged. */
bool plant_runtime_start_sources(struct plant_runtime *runtime);
/* Ends the link to the core that led. Afterwards call net_lead() in the event loop, which drops the link, and then plant_runtime_lead(). */
void plant_runtime_stop_following(struct plant_runtime *runtime);
/* Polls devices and owns the alarms from now on, in place of the core that was followed. Returns false on failure, already logged. */
bool plant_runtime_lead(struct plant_runtime *runtime);
/* Starts the render service. first: views to draw in advance, so that later frames of these views are quick. Returns false on failure,
   already logged. */
bool plant_runtime_start_render_service(struct plant_runtime *runtime, const struct view *first, size_t first_count);
/* Stops reading, recording and evaluating, so that `next` can take over. Frames are still drawn, with the last readings. */
void plant_runtime_hand_over(struct plant_runtime *runtime, const struct plant *next);
/* Returns the parts of the runtime that the event loop needs. */
struct net_plant plant_runtime_net_plant(const struct plant_runtime *runtime);

/* Returns the libavcodec encoder for H.264; NULL: none. */
const char *plant_runtime_h264_library(const struct server_params *params);
/* Returns the folder of prepared assets; the caller frees it with mem_free. */
char *plant_runtime_prepared_folder(const struct server_params *params, const struct plant *plant);
/* Opens the prepared scene. Returns NULL on failure, already logged. */
struct scene *plant_runtime_open_scene(struct log *log, const struct server_params *params, const struct plant *plant);

#endif
