/* SPDX-License-Identifier: GPL-3.0-or-later */
/* State and functions of the render thread. Private to render_thread*.c and frame_sharing.c. Call only in the render thread. */
#ifndef SERVICE_RENDER_THREAD_IMPL_H
#define SERVICE_RENDER_THREAD_IMPL_H
#include "render/memory.h"
#include "service/deferred_requests.h"
#include "service/pending_readbacks.h"
#include "service/recent_frames.h"
#include "service/render_service_impl.h"

struct thread_memory { /* memory limit of the renderer's caches, and when to release them (render_thread_memory.c) */
    counter *stores[RENDER_STORES], *fields, *frames, *bound;
    size_t other;           /* peak, in bytes, of the process's memory other than models and caches; decays slowly */
    int64_t looked_ns;      /* monotonic time when the size of the caches was last measured */
    int64_t trimmed_ns;     /* monotonic time when free heap memory was last returned to the system */
    int64_t alone_since_ns; /* monotonic time since which the service has had no client; 0: there are clients */
    bool released;          /* true: the caches were released, and no frame was drawn since */
};

struct long_job {                                 /* long job: a frame that is drawn in steps, between other clients' frames */
    struct split_view *split;                     /* the frame being drawn; NULL: no long job is running */
    struct request_group group;                   /* requests that the frame answers */
    const struct historical_snapshot *historical; /* reference to the readings of a past instant; NULL: the readings are in `snapshot` */
    struct snapshot *snapshot;
    enum urgency urgency;
    int64_t asked_ns;
    int64_t px, spent_ns;     /* px: number of pixels of the frame; spent_ns: time in which the frame was drawn so far */
    uint64_t account;         /* id of the client address's time account, to which the drawing time is charged */
    int64_t account_spent_ns; /* drawing time charged to the address's account before the job began */
    /* true: later frames of the same view reuse what the job has drawn so far, so the job continues even if readings change */
    bool keeps;
};

struct render_thread {
    struct render_service *service;
    struct gl *gl;
    struct field *field;
    struct renderer *renderer;
    struct snapshot *snapshot; /* readings that the render thread took last */
    bool stale; /* true: the readings in `snapshot` went with a submitted frame, so `snapshot` must be filled again before it is used */
    struct request_group same; /* scratch memory for a group of requests answered without drawing a frame */
    struct recent_frames recent;
    struct long_job long_job;
    /* suspended long job (a frame drawn in steps) for a large frame; it continues once a smaller frame of another address,
       which may overtake it, is drawn */
    struct long_job parked;
    bool warm;             /* the warm-up is complete */
    int64_t turn_began_ns; /* monotonic time since which the thread has drawn without waiting or doing other work */
    struct pending_readbacks in_flight;
    /* groups of requests whose field (interpolated values) is not computed yet; each turn of such a group computes a part of the field */
    struct deferred_requests deferred;
    struct thread_memory memory;
};

/* --- frame_sharing.c: one frame for all clients that request the same content ----------------------------------------- */

/* Submits the frame for encoding for those clients of the group that are still connected, and empties the group. cost_ns:
   drawing time, charged to these clients in equal parts. Takes its own reference to the frame. */
void frame_sharing_submit(struct render_service *service, struct frame *frame, struct request_group *group, int64_t cost_ns);
/* Answers those requests of the group that need no drawing, and removes them. Clients that already show the picture get an
   answer without a frame; others get a cached frame, or one being drawn, with the same content hash. content: hash of what the
   planned frame shows. */
void frame_sharing_answer_unchanged(struct render_thread *thread, uint64_t content, struct request_group *group);
/* Answers the whole group with a cached frame of the same view, and empties the group. The frame's readings must be at least as
   new as those that the group's clients know; otherwise does nothing. Call it before the field (interpolated values) is
   updated. */
void frame_sharing_answer_from_recent(struct render_thread *thread, struct request_group *group);

/* --- render_thread_memory.c: memory of the caches --------------------------------------------------------------------- */

/* Registers the memory metrics with the service's counters. */
void render_thread_memory_init(struct thread_memory *memory, struct render_service *service);
/* Measures the renderer's caches, and shrinks them to the limit on memory. */
void render_thread_bound_memory(struct render_thread *thread);
/* Records that the renderer's caches have content, which is kept until 10 s have passed without clients. */
void render_thread_note_work(struct render_thread *thread);
/* Shrinks the renderer's caches to their limit (at most once a second) and records that they have content. Call it after each
   frame or step. */
void render_thread_check_memory(struct render_thread *thread);
/* Returns true if the service has had no client for 10 s and the caches are not empty. Otherwise lowers *wait_until_ns to the time of the
   next check. The caller holds the service's lock. */
bool render_thread_may_release_memory(struct render_thread *thread, int64_t *wait_until_ns);
/* Empties all caches of the renderer. No frame may be in flight. */
void render_thread_release_memory(struct render_thread *thread);

/* --- render_thread_warm_up.c: costs of the first frames, paid in advance ---------------------------------------------- */

/* Draws the views of params.first before the first requests, so that their fields, buffers and shaders exist. */
void render_thread_draw_first(struct render_thread *thread);
/* Draws and discards a small preview or refined frame (`tier`), so that the shaders for such frames are compiled. */
void render_thread_warm_tier(struct render_thread *thread, enum tier tier);
/* Warm-up: prepares caches and shaders for later frames for some milliseconds; sets thread->warm once the warm-up is complete.
   Call it while there are no requests, without the lock. */
void render_thread_warm_up(struct render_thread *thread);

/* --- render_thread_next.c: choice of what is drawn next --------------------------------------------------------------- */

/* Returns whether the client's small frame may overtake another address's large long job (a frame drawn in steps). The caller
   holds the service's lock. */
bool render_thread_overtakes(const struct render_thread *thread, const struct render_client *client);
/* Waits for work and moves the next requests to answer into the group. Leaves the group empty if the thread must instead draw a
   step of the long job (a frame drawn in steps), or deliver a submitted frame. Returns false if the thread must end. */
bool render_thread_next(struct render_thread *thread, const struct scheduler *scheduler, struct request_group *group);

/* --- render_thread_readings.c ----------------------------------------------------------------------------------------- */

/* Makes thread->snapshot a copy of the event loop's newest snapshot, or of all present readings if that snapshot is older than
   SNAPSHOT_MAX_AGE_NS. */
void render_thread_refresh(struct render_thread *thread);
/* Returns the readings that a view shows. For a past instant, *historical receives a reference to them (release it with
   snapshot_cache_give); for the newest readings, *historical is NULL. Returns NULL if the instant is no longer in the cache;
   then no client waits for that view. */
const struct snapshot *render_thread_readings(struct render_thread *thread, const struct view *view,
                                              const struct historical_snapshot **historical);

#endif
