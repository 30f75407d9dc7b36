/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The plant runtime: a loaded plant and all parts of the daemon that depend on it. A reload creates another one. Call from one
   thread at a time. */
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
#include "session/plant_services.h"
#include "value/derived.h"
#include "value/source.h"
#include "views/other_plants.h"

struct plant_runtime_context { /* objects that a reload does not replace */
    const struct server_params *params;
    struct log *log;
    struct counters *counters;
    struct audit *audit;             /* writer of the audit trail; NULL: nothing is recorded */
    struct file_writer *file_writer; /* thread that writes files for users' changes, so that the event loop need not wait for the disk */
    struct workers *workers;
    struct plant_clock *clock;   /* the plant's clock */
    struct lease_keeper *keeper; /* lease keeper of a core in a pair (leader or standby); NULL: there is no pair */
    bool *follows;               /* true: another core polls devices and owns the alarms; plant_runtime_lead() sets it to false */
    /* called, on any thread, when encoded frames or changes of alarms wait for the event loop to collect them */
    void (*notify)(void *arg);
    void *notify_arg;
};

struct plant_runtime {
    const struct plant_runtime_context *context;
    struct plant *plant;
    /* services that sessions use; on a daemon that follows a core, core_link provides the readings instead of `sources` */
    struct plant_services services;
    struct publisher *publisher;    /* thread that publishes readings and alarms to an MQTT broker; NULL: nothing is published */
    struct source **sources;        /* sources of readings, with the same indices as plant->sources */
    struct source *derived;         /* pseudo-source that computes derived tags (from other tags' readings); NULL: the plant has none */
    /* time spans whose points were not yet read from PostgreSQL when a reload begins; the historian of the next runtime reads
       them */
    struct postgres_owed owed;
};

/* Reads plant and scene from disk and creates the store; starts nothing. Adds findings to diag. Returns NULL on failure, with
   the error in diag or in the log. */
struct plant_runtime *plant_runtime_read(const struct plant_runtime_context *context, struct diag *diag);
/* Ends all threads of the runtime, those that use data before those that produce it, and frees everything. Accepts a pointer to
   NULL; sets *runtime to NULL. */
void plant_runtime_destroy(struct plant_runtime **runtime);

/* Opens the files that users change: named views, notes, messages from desks to walls, loop checks and so on. After a reload,
   call it in the event loop at the switch to the new runtime: until then the old runtime changes these files. */
void plant_runtime_open_lists(struct plant_runtime *runtime);
/* Starts historian and alarm service; without an earlier runtime, also opens the files that users change. before: the earlier
   runtime, from which history, alarms and readings continue; NULL: none. plant_runtime_hand_over() must have been called for
   it, and the caller still destroys it. Returns false on failure, already logged. */
bool plant_runtime_start_recording(struct plant_runtime *runtime, struct plant_runtime *before);
/* Starts the sources that poll field devices, and the source of derived tags. Returns false on failure, already logged. */
bool plant_runtime_start_sources(struct plant_runtime *runtime);
/* Ends the link to the core that this daemon followed. Afterwards call net_lead() in the event loop, which drops the pointer to
   the link, and then plant_runtime_lead(). */
void plant_runtime_stop_following(struct plant_runtime *runtime);
/* Makes this daemon poll the devices and own the alarms, in place of the core that it followed. Returns false on failure, already
   logged. */
bool plant_runtime_lead(struct plant_runtime *runtime);
/* Starts the render service. first: views to draw in advance, so that the sessions that show them get their first frames
   quickly. Returns false on failure, already logged. */
bool plant_runtime_start_render_service(struct plant_runtime *runtime, const struct view *first, size_t first_count);
/* Ends polling, recording and evaluating, so that the runtime of the plant `next` can take over. The render service continues
   to draw, with the readings from before the call. */
void plant_runtime_hand_over(struct plant_runtime *runtime, const struct plant *next);

/* Ends everything that only the leader of two cores may do: polling, alarm evaluation, recording, notifying. The last samples
   are still evaluated and recorded. The caller must have dropped its pointer to the historian. */
void plant_runtime_end_leading(struct plant_runtime *runtime);

/* Returns the name of the libavcodec encoder for H.264; NULL: H.264 is off. */
const char *plant_runtime_h264_library(const struct server_params *params);
/* Returns the folder of prepared assets; the caller frees it with mem_free. */
char *plant_runtime_prepared_folder(const struct server_params *params, const struct plant *plant);
/* Opens the prepared scene. Returns NULL on failure, already logged. */
struct scene *plant_runtime_open_scene(struct log *log, const struct server_params *params, const struct plant *plant);

#endif
