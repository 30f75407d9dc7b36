/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The render service: a thread that takes frame requests of many clients, draws the most urgent one, has workers encode the
   frame, and hands the encoded frames back. Each client has at most one waiting request; a newer one replaces it. Call from any
   thread, unless said otherwise. */
#ifndef SERVICE_RENDER_SERVICE_H
#define SERVICE_RENDER_SERVICE_H
#include "base/metrics/counters.h"
#include "gpu/gl.h"
#include "loopcheck/loop_checks.h"
#include "service/encoded_frame.h"
#include "service/pick_queue.h"
#include "value/snapshot_cache.h"
#include "value/store.h"

struct render_service;
struct render_service_params {
    struct log *log;
    enum gl_kind gl;
    bool per_fragment; /* true: computes the field at each fragment instead of at each vertex, so that tests can compare both */
    bool by_gl;        /* true: draws all frames with GL, even if GL runs on the processor, so that tests can compare both ways */
    const struct gl_device *gl_device; /* GPU to use; NULL: the first hardware GPU that works */
    const struct scene *scene;
    struct store *store;
    const struct plant_clock *clock;       /* clock of the readings */
    struct baselines *baselines;           /* store of baselines (saved readings); NULL: differences from baselines cannot be shown */
    struct snapshot_cache *snapshot_cache; /* cache of readings of past instants; NULL: past instants cannot be shown */
    /* registry of trials (sets of sensor positions that users try out, field/trials.h); NULL: trials cannot be shown */
    struct trials *trials;
    struct workers *workers;
    size_t memory_bytes;      /* limit on the daemon's memory in bytes, models included; 0: chosen for the machine */
    const char *h264_library; /* name of the libavcodec encoder; NULL: the default one */
    struct counters *counters;
    /* true: frames with overlays (texts and signs) include the record of what they were drawn from (render/frame_record.h), for signing */
    bool keeps_records;
    /* views to draw once in render_service_create(), so that their caches and shaders are ready for requests; read only during that call */
    const struct view *first;
    size_t first_count;
    /* callback, on any thread, when encoded frames or answers to picks (what is at a pixel) can be collected */
    void (*notify)(void *arg);
    void *notify_arg;
};

/* Starts the thread and waits until it has created GL and the renderer. Returns NULL on failure, already logged. Everything that params
   point to must outlive the service. */
struct render_service *render_service_create(const struct render_service_params *params);
/* Ends the thread and all jobs that it gave to the workers, and sets *service to NULL; accepts a pointer to NULL. */
void render_service_destroy(struct render_service **service);

enum request_outcome { REQUEST_ADDED, REQUEST_REPLACED, REQUEST_REFUSED };
/* Queues a client's request. REQUEST_ADDED: one encoded frame will be ready for collection, unless the client is forgotten.
   REQUEST_REPLACED: the request replaced one whose drawing had not begun; one frame answers both. REQUEST_REFUSED: the request
   may only replace another (only_replace), but none was waiting. Drawing begins with render_service_wake(). */
enum request_outcome render_service_request(struct render_service *service, uint64_t client, const struct frame_request *request);
/* Queues requests of several clients in one call. Requests for equal views are begun together, so that one frame answers them. */
void render_service_request_all(struct render_service *service, size_t count, const uint64_t *clients, const struct frame_request *requests,
                                enum request_outcome *outcomes);
/* Wakes the render thread if requests were queued since the last call. Call it after all requests of one event, so that equal requests
   share a frame. */
void render_service_wake(struct render_service *service);
/* Answers the client's waiting request, if any, without a frame (FRAME_SKIPPED), and gives up the frame that is being drawn in
   steps for the client. Call it for clients that show no pictures for a while. */
void render_service_withdraw(struct render_service *service, uint64_t client);
/* Drops all waiting requests and encoded frames of the client. */
void render_service_forget(struct render_service *service, uint64_t client);
/* Makes all later frames mark each tag without a successful loop check, if the server draws the sensor markers. loop_checks
   must outlive the service; NULL: no tag is marked. */
void render_service_set_loop_checks(struct render_service *service, const struct loop_checks *loop_checks);
/* Copies the event loop's newest snapshot of readings to the service, so that later frames show the readings that the loop
   sends as text. */
void render_service_set_readings(struct render_service *service, const struct snapshot *readings);
/* Returns false while a lost GL context is being rebuilt; frame requests wait meanwhile. */
bool render_service_ready(struct render_service *service);
/* Returns whether the render thread is stuck: it has not answered a check for 12 s, or for 2 minutes while it rebuilds a lost
   GL context. Each call starts the next check, so call it every few seconds. */
bool render_service_is_stuck(struct render_service *service, int64_t now_ns);
/* Destroys the GL context in the middle of the next frame, like a GPU reset. For tests. */
void render_service_lose_context(struct render_service *service);
/* Queues a pick query. It gets one answer, unless the client sends another query or is forgotten. Picks are answered between frames. */
void render_service_pick(struct render_service *service, const struct pick_query *query);
/* Returns all finished pick answers, oldest first; the caller frees each with mem_free. NULL: none. */
struct pick_answer *render_service_collect_picks(struct render_service *service);
/* Returns all finished encoded frames, oldest first; the caller owns them (encoded_frame_destroy). NULL: none. */
struct encoded_frame *render_service_collect(struct render_service *service);

#endif
