/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The plant runtime: a loaded plant and all parts of the daemon that depend on it. A reload makes another one. Thread: one at a time. */
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

struct plant_runtime_context { /* what a reload keeps */
    const struct server_params *params;
    struct log *log;
    struct counters *counters;
    struct audit *audit; /* NULL: nothing is recorded */
    struct workers *workers;
    struct lease_keeper *keeper; /* of a core that has a standby, or is one; NULL: none */
    bool *follows;               /* another core polls, and owns the alarms; plant_runtime_lead() ends it */
    void (*notify)(void *arg); /* called when frames, or changes of alarms, can be collected; any thread */
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
    struct postgres_owed owed;   /* by the historian, once another plant is in force */
    struct alarm_service *alarm_service;
    struct notifier *notifier;   /* NULL: nobody is told of alarms */
    struct publisher *publisher; /* NULL: nothing is published */
    struct source **sources; /* by index in plant->sources */
    struct core_link *core_link; /* of a renderer, or a core that stands by, instead of sources; else NULL */
    struct source *derived;  /* computes derived tags; NULL: there are none */
    struct render_service *render_service;
    char *history; /* its folder; NULL: nothing is recorded */
    struct placing *placing;
    struct named_views *named_views;
    struct notes *notes;
    struct wall_remote *wall_remote;
    struct other_plants *other_plants; /* NULL: the plant file names none */
    struct pairings *pairings;
    struct loop_checks *loop_checks; /* NULL: nothing is recorded */
    char *tag_list;                  /* its text; NULL: it could not be read */
};

/* Reads plant and scene from disk and makes the store; nothing runs yet. Findings go to diag. Returns NULL after an error, which is there
   or in the log. */
struct plant_runtime *plant_runtime_read(const struct plant_runtime_context *context, struct diag *diag);
/* Ends what runs, in reverse order of the flow of data, and frees all. &NULL is fine; leaves NULL. */
void plant_runtime_destroy(struct plant_runtime **runtime);

/* Opens what people make: views, notes, what desks send to walls. In the loop, where another runtime is handed over: it keeps these files
   until then. */
void plant_runtime_open_lists(struct plant_runtime *runtime);
/* Starts historian and alarms, and opens the lists where there is no runtime before. before: the runtime whose history, alarms and readings
   are continued; plant_runtime_hand_over() must have been called on it, and the caller still destroys it. NULL: none. Returns false on
   failure, already logged. */
bool plant_runtime_start_recording(struct plant_runtime *runtime, struct plant_runtime *before);
/* Starts the field devices' sources and derived tags. Returns false on failure, already logged. */
bool plant_runtime_start_sources(struct plant_runtime *runtime);
/* Ends the link to the core that led. The loop then lets go of it (net_lead), and plant_runtime_lead() comes. */
void plant_runtime_stop_following(struct plant_runtime *runtime);
/* Polls and owns the alarms from now on, in the place of the core that was followed. Returns false on failure, already logged. */
bool plant_runtime_lead(struct plant_runtime *runtime);
/* Starts the render service. first: views that are to be quick to draw from the beginning. Returns false on failure, already logged. */
bool plant_runtime_start_render_service(struct plant_runtime *runtime, const struct view *first, size_t first_count);
/* Stops reading, recording and evaluating, for the runtime of `next` to continue. Frames are still drawn, of the last readings. */
void plant_runtime_hand_over(struct plant_runtime *runtime, const struct plant *next);
/* Returns what the loop needs of it. */
struct net_plant plant_runtime_net_plant(const struct plant_runtime *runtime);

/* Returns the H.264 encoder to use; NULL: none. */
const char *plant_runtime_h264_library(const struct server_params *params);
/* Returns the folder of prepared assets; mem_free. */
char *plant_runtime_prepared_folder(const struct server_params *params, const struct plant *plant);
/* Opens the prepared scene. Returns NULL on failure, already logged. */
struct scene *plant_runtime_open_scene(struct log *log, const struct server_params *params, const struct plant *plant);

#endif
