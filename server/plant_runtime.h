/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A plant that is loaded, and all of the daemon that depends on it: what a reload makes anew. Thread: one at a time. */
#ifndef PLANT_RUNTIME_H
#define PLANT_RUNTIME_H
#include "alarm/alarm_service.h"
#include "base/workers.h"
#include "history/historian.h"
#include "net/net.h"
#include "placing/placing.h"
#include "server_params.h"
#include "value/derived.h"
#include "value/source.h"

struct plant_runtime_context { /* what outlives it */
    const struct server_params *params;
    struct log *log;
    struct counters *counters;
    struct workers *workers;
    void (*notify)(void *arg); /* pictures, or changes of alarms, are there; any thread */
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
    struct alarm_service *alarm_service;
    struct source **sources; /* by index in plant->sources */
    struct source *derived;  /* computes tags from tags; NULL: there are none */
    struct render_service *painter;
    char *history; /* folder; NULL: none */
    struct placing *placing;
    struct loop_checks *loop_checks; /* NULL: nothing is recorded */
    char *tag_list;                  /* the text; NULL: it could not be read a second time */
};

/* Plant and scene, from disk, and the store; nothing runs yet. Findings go to diag. NULL: with an error there, or in the log. */
struct plant_runtime *plant_runtime_read(const struct plant_runtime_context *context, struct diag *diag);
void plant_runtime_destroy(struct plant_runtime **loaded); /* ends what runs, against the flow of data; &NULL is fine; leaves NULL */

/* Each false: logged. before: whose history, alarms and readings go on (plant_runtime_hand_over); NULL: none. */
bool plant_runtime_start_recording(struct plant_runtime *loaded, struct plant_runtime *before);
bool plant_runtime_start_sources(struct plant_runtime *loaded);
/* first: pictures that it shall be quick to draw from the beginning (painter.h). */
bool plant_runtime_start_render_service(struct plant_runtime *loaded, const struct view *first, size_t first_count);
/* Nothing is read, recorded or evaluated any more; pictures are still drawn of what there was. */
void plant_runtime_hand_over(struct plant_runtime *loaded, const struct plant *next);
struct net_plant plant_runtime_net_plant(const struct plant_runtime *loaded);

const char *plant_runtime_h264_library(const struct server_params *params);
char *plant_runtime_prepared_folder(const struct server_params *params, const struct plant *plant); /* mem_free */
struct scene *plant_runtime_open_scene(struct log *log, const struct server_params *params, const struct plant *plant);

#endif
