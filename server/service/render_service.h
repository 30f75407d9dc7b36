/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The render thread: takes wishes, draws the one that is due first, has it encoded by the workers and hands pictures back.
   One wish per client, newest wins. Thread: any, unless said otherwise. */
#ifndef SERVICE_RENDER_SERVICE_H
#define SERVICE_RENDER_SERVICE_H
#include "base/counters.h"
#include "gpu/gl.h"
#include "service/pick_queue.h"
#include "service/encoded_frame.h"
#include "loopcheck/loop_checks.h"
#include "value/snapshot_cache.h"
#include "value/store.h"

struct render_service;
struct render_service_params {
    struct log *log;
    enum gl_kind gl;
    bool per_fragment;                 /* the field anew at each fragment */
    bool by_gl;                        /* all pictures, as on a GPU, where GL is on a processor too: to compare */
    const struct gl_device *gl_device; /* NULL: the first with hardware that works */
    const struct scene *scene;
    struct store *store;
    struct baselines *baselines;           /* NULL: no differences can be shown */
    struct snapshot_cache *snapshot_cache; /* where views of an instant find it; NULL: there are none */
    struct trials *trials;                 /* where views of places that are tried out find them; NULL: there are none */
    struct workers *workers;
    size_t memory_bytes;      /* what the daemon may take, models and all; 0: what suits the machine */
    const char *h264_library; /* an encoder of libavcodec; NULL: the usual one */
    struct counters *counters;
    const struct view
        *first; /* pictures that are drawn, and thrown away, in render_service_create: what only the first cost is paid. Need live
                                    for that call only */
    size_t first_count;
    void (*notify)(void *arg); /* pictures are there to be collected; called on any thread */
    void *notify_arg;
};

/* Makes the thread, GL and the renderer, and waits for them. NULL on failure, logged. All in params must outlive it. */
struct render_service *render_service_create(const struct render_service_params *params);
void render_service_destroy(
    struct render_service **painter); /* &NULL is fine; leaves NULL; ends the thread and what it gave to the workers */

enum request_outcome { REQUEST_ADDED, REQUEST_REPLACED, REQUEST_REFUSED };
/* Each wish that was added brings one picture, unless the client is forgotten. render_service_wake, after the last of those made at one time,
   so that equal ones share a picture. */
enum request_outcome render_service_request(struct render_service *painter, uint64_t client, const struct frame_request *wish);
void render_service_wake(struct render_service *painter);
void render_service_forget(struct render_service *painter, uint64_t client);
/* Tags that are unproven are marked from now on where the server draws markers. Must outlive it. */
void render_service_set_loop_checks(struct render_service *painter, const struct loop_checks *loop_checks);
void render_service_on_data(struct render_service *painter); /* readings changed: look again before the next picture */
/* A GL context is there. False while a lost one is being made again: readings, texts and connections go on, pictures wait. */
bool render_service_ready(struct render_service *painter);
/* Has the GL context destroyed in the middle of the next picture, as a reset of the GPU does; for tests. */
void render_service_lose_context(struct render_service *painter);
/* Each question brings one answer, unless the client asks another or is forgotten. Answered between pictures. */
void render_service_pick(struct render_service *painter, const struct pick_query *order);
struct pick_answer *render_service_collect_picks(struct render_service *painter); /* as pick_queue_collect */
/* All pictures made so far, oldest first; the caller owns them. NULL: none. */
struct encoded_frame *render_service_collect(struct render_service *painter);

#endif
