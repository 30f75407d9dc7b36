/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The render thread: takes wishes, draws the one that is due first, has it encoded by the workers and hands pictures back.
   One wish per client, newest wins. Thread: any, unless said otherwise. */
#ifndef NET_PAINTER_H
#define NET_PAINTER_H
#include "base/counters.h"
#include "gpu/gl.h"
#include "net/paint/picks.h"
#include "net/paint/picture.h"
#include "proving/proofs.h"
#include "value/moments.h"
#include "value/store.h"

struct painter;
struct painter_params {
    struct log *log;
    enum gl_kind gl;
    bool per_fragment; /* the field anew at each fragment */
    bool by_gl;        /* all pictures, as on a GPU, where GL is on a processor too: to compare */
    const struct gl_device *gl_device; /* NULL: the first with hardware that works */
    const struct scene *scene;
    struct store *store;
    struct baselines *baselines; /* NULL: no differences can be shown */
    struct moments *moments;     /* where views of an instant find it; NULL: there are none */
    struct trials *trials;    /* where views of places that are tried out find them; NULL: there are none */
    struct workers *workers;
    size_t memory_bytes;      /* what the daemon may take, models and all; 0: what suits the machine */
    const char *h264_library; /* an encoder of libavcodec; NULL: the usual one */
    struct counters *counters;
    const struct view *first;    /* pictures that are drawn, and thrown away, in painter_create: what only the first cost is paid. Need live
                                    for that call only */
    size_t first_count;
    void (*notify)(void *arg); /* pictures are there to be collected; called on any thread */
    void *notify_arg;
};

/* Makes the thread, GL and the renderer, and waits for them. NULL on failure, logged. All in params must outlive it. */
struct painter *painter_create(const struct painter_params *params);
void painter_destroy(struct painter **painter); /* &NULL is fine; leaves NULL; ends the thread and what it gave to the workers */

enum painter_answer { PAINTER_ADDED, PAINTER_REPLACED, PAINTER_REFUSED };
/* Each wish that was added brings one picture, unless the client is forgotten. painter_go, after the last of those made at one time,
   so that equal ones share a picture. */
enum painter_answer painter_ask(struct painter *painter, uint64_t client, const struct wish *wish);
void painter_go(struct painter *painter);
void painter_forget(struct painter *painter, uint64_t client);
/* Tags that are unproven are marked from now on where the server draws markers. Must outlive it. */
void painter_set_proofs(struct painter *painter, const struct proofs *proofs);
void painter_new_data(struct painter *painter); /* readings changed: look again before the next picture */
/* A GL context is there. False while a lost one is being made again: readings, texts and connections go on, pictures wait. */
bool painter_ready(struct painter *painter);
/* Has the GL context destroyed in the middle of the next picture, as a reset of the GPU does; for tests. */
void painter_lose_context(struct painter *painter);
/* Each question brings one answer, unless the client asks another or is forgotten. Answered between pictures. */
void painter_pick(struct painter *painter, const struct pick_order *order);
struct pick_answer *painter_collect_picks(struct painter *painter); /* as picks_collect */
/* All pictures made so far, oldest first; the caller owns them. NULL: none. */
struct picture *painter_collect(struct painter *painter);

#endif
