/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the render thread alone touches. Private to drawing.c, turns.c and sharing.c. */
#ifndef SERVICE_RENDER_THREAD_IMPL_H
#define SERVICE_RENDER_THREAD_IMPL_H
#include "service/awaited_frames.h"
#include "service/deferred_requests.h"
#include "service/render_service_impl.h"
#include "service/recent_frames.h"
#include "render/memory.h"

struct thread_memory {
    counter *stores[RENDER_STORES], *fields, *frames, *bound;
    int64_t looked_ns, alone_since_ns; /* alone: 0: somebody is there */
    bool rests;                        /* nothing was drawn since all was given back */
};

struct slow {                 /* a picture that takes long and is drawn step by step */
    struct split_view *split; /* NULL: none */
    struct request_group batch;
    struct snapshot *snapshot;                    /* of what it shows, unless */
    const struct historical_snapshot *historical; /* it is of an instant */
    enum urgency urgency;
    int64_t asked_ns, field_ns;
    int64_t px, spent_ns;   /* so far, of time */
    uint64_t payer;         /* whose */
    int64_t payer_spent_ns; /* by that, before */
    bool keeps;             /* when it is done, new readings are quick to show: they need not wait for it, nor it be given up for them */
};

struct render_thread {
    struct render_service *painter;
    struct gl *gl;
    struct field *field;
    struct renderer *renderer;
    struct snapshot *snapshot;
    struct request_group same;
    struct recent_frames recent;
    struct slow slow;   /* one at a time */
    struct slow parked; /* a large one, while a small one of another address is drawn */
    bool warm;          /* what only the first pictures cost was paid */
    struct awaited_frames flying;
    struct deferred_requests held; /* pictures whose field takes long: worked on step by step, each in its turn */
    struct thread_memory resting;
};

/* --- sharing.c: one picture for all who want the same, whenever they ask --- */

/* The frame, encoded, to all of the batch that are still there; empties it. cost_ns: what it took to draw, which they share. */
void frame_sharing_submit(struct render_service *painter, struct frame *frame, struct request_group *batch, int64_t cost_ns);
/* Answers those for whom nothing changed, and those for whom another's frame does, or will when it comes; takes them out of the batch.
   Returns the content (split_view_content). */
uint64_t frame_sharing_answer_unchanged(struct render_thread *drawing, const struct snapshot *snapshot, struct request_group *batch);
/* Likewise who asks a moment later than others for the same view: what was drawn for them will do, if all that changed since is readings
   that he has yet to be told of. Before the field is brought up to date. */
void frame_sharing_answer_from_recent(struct render_thread *drawing, struct request_group *batch);

/* --- resting.c: memory --- */

void render_thread_memory_init(struct thread_memory *resting, struct render_service *painter);
void render_thread_bound_memory(struct render_thread *drawing); /* what is kept is counted, and brought under its bound */
void render_thread_note_work(struct render_thread *drawing);    /* something was worked out: it may rest, but not now */
void render_thread_check_memory(struct render_thread *drawing); /* after each turn: that, once a second */
/* Under the painter's lock: nobody was there for some time, and something is kept. False: not before *wait_until_ns, if it was later. */
bool render_thread_may_release_memory(struct render_thread *drawing, int64_t *wait_until_ns);
void render_thread_release_memory(struct render_thread *drawing); /* all of it is given back; no picture may be under way */

/* --- turns.c --- */

/* Under lock. Its small picture that takes long need not wait for the end of another address's large one. */
bool render_thread_overtakes(const struct render_thread *drawing, const struct render_client *client);

/* Under nobody's lock, while nobody wants a picture: some of what the first still one will cost. */
void render_thread_warm_up(struct render_thread *drawing);
/* Waits for work. False: stop. An empty batch: the slow picture may go on by a step, or a flying one is waited for. */
bool render_thread_next(struct render_thread *drawing, const struct scheduler *schedule, struct request_group *batch);
/* The newest readings, if they changed or are some time old. */
void render_thread_refresh(struct render_thread *drawing);
/* What a view is of: an instant, held in *historical until it is given back (snapshot_cache_give), or the newest readings. NULL: the instant is not
   at hand (any more): who asked for it has gone on. */
const struct snapshot *render_thread_readings(struct render_thread *drawing, const struct view *view,
                                              const struct historical_snapshot **historical);
/* Under the painter's lock: until somebody wakes it, or then. */
void render_thread_wait(struct render_service *painter, int64_t mono_ns);

#endif
