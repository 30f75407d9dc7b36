/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The render service: a thread that takes frame requests of many clients, draws the most urgent one, has the frame encoded by the workers
   and hands the encoded frames back. Each client has at most one request waiting; a newer one replaces it. Thread: any, unless said
   otherwise. */
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
    bool per_fragment;                 /* compute the field at each fragment, for comparison */
    bool by_gl;                        /* draw all frames with GL, even where GL runs on a processor; for comparison */
    const struct gl_device *gl_device; /* NULL: the first with hardware that works */
    const struct scene *scene;
    struct store *store;
    struct baselines *baselines;           /* NULL: no differences can be shown */
    struct snapshot_cache *snapshot_cache; /* readings of past instants; NULL: none can be shown */
    struct trials *trials;                 /* sensors moved on trial; NULL: none can be shown */
    struct workers *workers;
    size_t memory_bytes;      /* bound on what the daemon takes, models included; 0: chosen for the machine */
    const char *h264_library; /* an encoder of libavcodec; NULL: the default one */
    struct counters *counters;
    bool keeps_records;       /* frames with overlays come with their readings (render/frame_record.h), for whoever signs them */
    const struct view *first; /* views drawn once in render_service_create, so that they are quick later; copied from for that call only */
    size_t first_count;
    void (*notify)(void *arg); /* called when frames or pick answers can be collected; any thread */
    void *notify_arg;
};

/* Starts the thread and waits until it has made GL and the renderer. Returns NULL on failure, already logged. What params point at must
   outlive the service. */
struct render_service *render_service_create(const struct render_service_params *params);
/* Ends the thread and all jobs it gave to the workers. &NULL is fine; leaves NULL. */
void render_service_destroy(struct render_service **service);

enum request_outcome { REQUEST_ADDED, REQUEST_REPLACED, REQUEST_REFUSED };
/* Puts a client's request in line. REQUEST_ADDED: one encoded frame will be collected for it, unless the client is forgotten.
   REQUEST_REPLACED: it took the place of one that had not been begun, and shares its answer. REQUEST_REFUSED: it was only good as a
   replacement (only_replace), and there was none to replace. Drawing begins with render_service_wake. */
enum request_outcome render_service_request(struct render_service *service, uint64_t client, const struct frame_request *request);
/* Does the same for several clients at once: requests for equal views are begun together, so that one frame answers all of them. */
void render_service_request_all(struct render_service *service, size_t count, const uint64_t *clients, const struct frame_request *requests,
                                enum request_outcome *outcomes);
/* Lets the render thread begin with the requests that came since the last call, if any did. To be called after all requests of one event,
   so that equal ones share a frame. */
void render_service_wake(struct render_service *service);
/* Drops all that is waiting or encoded for the client. */
void render_service_forget(struct render_service *service, uint64_t client);
/* Has tags whose loop was not checked marked in all frames drawn from now on, where the server draws markers. loop_checks must outlive the
   service; NULL: none is marked. */
void render_service_set_loop_checks(struct render_service *service, const struct loop_checks *loop_checks);
/* Says that readings changed: a new snapshot is taken before the next frame. */
void render_service_on_data(struct render_service *service);
/* Returns false while a lost GL context is being made again; requests wait meanwhile. */
bool render_service_ready(struct render_service *service);
/* Returns whether the render thread has given no sign of life for 12 s, or 2 minutes while a lost GL context is made again, and asks it for
   one. To be called every few seconds. */
bool render_service_is_stuck(struct render_service *service, int64_t now_ns);
/* Destroys the GL context in the middle of the next frame, as a GPU reset does. For tests. */
void render_service_lose_context(struct render_service *service);
/* Asks what is at a pixel. Each question brings one answer, unless the client asks another or is forgotten. Answered between frames. */
void render_service_pick(struct render_service *service, const struct pick_query *query);
/* Returns all answers so far, oldest first; the caller frees each with mem_free. NULL: none. */
struct pick_answer *render_service_collect_picks(struct render_service *service);
/* Returns all encoded frames so far, oldest first; the caller owns them (encoded_frame_destroy). NULL: none. */
struct encoded_frame *render_service_collect(struct render_service *service);

#endif
