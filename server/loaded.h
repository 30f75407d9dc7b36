/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A plant that is loaded, and all of the daemon that depends on it: what a reload makes anew. Thread: one at a time. */
#ifndef LOADED_H
#define LOADED_H
#include "alarm/alarming.h"
#include "base/workers.h"
#include "history/historian.h"
#include "net/net.h"
#include "placing/placing.h"
#include "server.h"
#include "value/derived.h"
#include "value/source.h"

struct loaded_context { /* what outlives it */
    const struct server_params *params;
    struct log *log;
    struct counters *counters;
    struct workers *workers;
    void (*notify)(void *arg); /* pictures, or changes of alarms, are there; any thread */
    void *notify_arg;
};

struct loaded {
    const struct loaded_context *context;
    struct plant *plant;
    struct scene *scene;
    struct store *store;
    struct baselines *baselines;
    struct moments *moments;
    struct historian *historian; /* NULL: nothing is recorded */
    struct alarming *alarming;
    struct source **sources; /* by index in plant->sources */
    struct source *derived;  /* computes tags from tags; NULL: there are none */
    struct painter *painter;
    char *history; /* folder; NULL: none */
    struct placing *placing;
    struct proofs *proofs; /* NULL: nothing is recorded */
    char *tag_list;        /* the text; NULL: it could not be read a second time */
};

/* Plant and scene, from disk, and the store; nothing runs yet. Findings go to diag. NULL: with an error there, or in the log. */
struct loaded *loaded_read(const struct loaded_context *context, struct diag *diag);
void loaded_destroy(struct loaded **loaded); /* ends what runs, against the flow of data; &NULL is fine; leaves NULL */

/* Each false: logged. before: whose history, alarms and readings go on (loaded_hand_over); NULL: none. */
bool loaded_start_recording(struct loaded *loaded, struct loaded *before);
bool loaded_start_sources(struct loaded *loaded);
/* first: pictures that it shall be quick to draw from the beginning (painter.h). */
bool loaded_start_painter(struct loaded *loaded, const struct view *first, size_t first_count);
/* Nothing is read, recorded or evaluated any more; pictures are still drawn of what there was. */
void loaded_hand_over(struct loaded *loaded, const struct plant *next);
struct net_plant loaded_net_plant(const struct loaded *loaded);

const char *loaded_h264_library(const struct server_params *params);
char *loaded_prepared_folder(const struct server_params *params, const struct plant *plant); /* mem_free */
struct scene *loaded_open_scene(struct log *log, const struct server_params *params, const struct plant *plant);

#endif
