/* SPDX-License-Identifier: GPL-3.0-or-later */
/* State and functions of the render thread. Private to render_thread*.c and frame_sharing.c. Thread: the render thread, in all of them. */
#ifndef SERVICE_RENDER_THREAD_IMPL_H
#define SERVICE_RENDER_THREAD_IMPL_H
#include "render/memory.h"
#include "service/deferred_requests.h"
#include "service/awaited_frames.h"
#include "service/recent_frames.h"
#include "service/render_service_impl.h"

struct thread_memory { /* what drawing keeps in caches (render_thread_memory.c) */
    counter *stores[RENDER_STORES], *fields, *frames, *bound;
    size_t other;           /* peak of what the process held beside models and caches, fading */
    int64_t looked_ns;      /* when it was last counted */
    int64_t trimmed_ns;     /* when free heap was last returned to the system */
    int64_t alone_since_ns; /* since when there has been no client; 0: there is one */
    bool released;          /* nothing was drawn since the caches were released */
};

struct long_job {                                 /* a frame that is drawn in steps, between the frames of others */
    struct split_view *split;                     /* NULL: no such frame is being drawn */
    struct request_group group;                   /* whose requests it answers */
    const struct historical_snapshot *historical; /* its readings, a reference; NULL: they are `snapshot` */
    struct snapshot *snapshot;
    enum urgency urgency;
    int64_t asked_ns;
    int64_t px, spent_ns;     /* its pixels; time spent so far */
    uint64_t account;         /* who pays that time */
    int64_t account_spent_ns; /* spent on that account before */
    bool keeps;               /* once it is done, new readings are quick to show: it is not given up for them */
};

struct render_thread {
    struct render_service *service;
    struct gl *gl;
    struct field *field;
    struct renderer *renderer;
    struct snapshot *snapshot; /* the newest readings that were taken, unless: */
    bool stale;                /* a frame took them over: take new ones before the next use */
    struct request_group same; /* scratch: requests that are answered without drawing */
    struct recent_frames recent;
    struct long_job long_job;
    struct long_job parked; /* a large one that waits for a small one of another address */
    bool warm;              /* the warm-up is complete */
    int64_t turn_began_ns;  /* when the thread last had waited, or had done something else than what it now does */
    struct awaited_frames in_flight;
    struct deferred_requests deferred; /* whose field is not computed yet; each is worked on in its turn */
    struct thread_memory memory;
};

/* --- frame_sharing.c: one frame for all who ask for the same, whenever they ask --------------------------------------- */

/* Submits the frame for encoding, for all clients of the group that are still connected, and empties the group. cost_ns, the time that
   drawing took, is charged to them in equal parts. Takes its own reference on the frame. */
void frame_sharing_submit(struct render_service *service, struct frame *frame, struct request_group *group, int64_t cost_ns);
/* Answers the requests of the group that need no drawing and removes them: clients that already show this content get no frame; others
   share a recent frame, or one in flight, of the same content. content: of the plan. */
void frame_sharing_answer_unchanged(struct render_thread *thread, uint64_t content, struct request_group *group);
/* Answers the requests of the group with a recent frame of the same view, if its readings are as new as those clients know of; then the
   group is empty. To be called before the field is updated. */
void frame_sharing_answer_from_recent(struct render_thread *thread, struct request_group *group);

/* --- render_thread_memory.c: the memory that drawing keeps ------------------------------------------------------------ */

/* Adds the memory counters to the service's. */
void render_thread_memory_init(struct thread_memory *memory, struct render_service *service);
/* Counts what the caches hold and shrinks them to their bound. */
void render_thread_bound_memory(struct render_thread *thread);
/* Notes that caches were filled, so that they are released only after another idle time. */
void render_thread_note_work(struct render_thread *thread);
/* Does both of the above; the counting at most once a second. To be called after each turn. */
void render_thread_check_memory(struct render_thread *thread);
/* Returns true when there has been no client for 10 s and caches still hold something. Otherwise lowers *wait_until_ns to the time at
   which to ask again. Under the service's lock. */
bool render_thread_may_release_memory(struct render_thread *thread, int64_t *wait_until_ns);
/* Empties all caches. No frame may be under way. */
void render_thread_release_memory(struct render_thread *thread);

/* --- render_thread_warm_up.c: what only the first frames cost, paid in advance ---------------------------------------- */

/* Draws the views of params.first, so that the first frames find their fields, buffers and shaders. */
void render_thread_draw_first(struct render_thread *thread);
/* Draws a small frame of that tier for nobody, which compiles its shaders. */
void render_thread_warm_tier(struct render_thread *thread, enum tier tier);
/* Does some milliseconds of the warm-up; sets thread->warm once it is complete. To be called while nobody asks. Not under lock. */
void render_thread_warm_up(struct render_thread *thread);

/* --- render_thread_next.c: what is drawn next ------------------------------------------------------------------------- */

/* Returns whether the client's small frame goes before the end of another address's large one. Under the service's lock. */
bool render_thread_overtakes(const struct render_thread *thread, const struct render_client *client);
/* Waits for work and moves the requests to be answered next into the group. It stays empty when a step of the long job, or a frame in
   flight, is due instead. Returns false when the thread is to end. */
bool render_thread_next(struct render_thread *thread, const struct scheduler *scheduler, struct request_group *group);
/* Brings thread->snapshot up to date, if readings changed or it is too old. */
void render_thread_refresh(struct render_thread *thread);
/* Returns the readings that a view shows: those of its instant, with the reference in *historical (snapshot_cache_give), or the newest,
   with *historical NULL. Returns NULL if the instant is not in the cache any more; then nobody waits for that view. */
const struct snapshot *render_thread_readings(struct render_thread *thread, const struct view *view,
                                              const struct historical_snapshot **historical);

#endif
