/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the render thread alone touches. Private to drawing.c, turns.c and sharing.c. */
#ifndef NET_DRAWING_IMPL_H
#define NET_DRAWING_IMPL_H
#include "net/paint/flying.h"
#include "net/paint/held.h"
#include "net/paint/painter_impl.h"
#include "net/paint/recent.h"
#include "render/memory.h"

struct resting {
    counter *stores[RENDER_STORES], *fields, *frames, *bound;
    int64_t looked_ns, alone_since_ns; /* alone: 0: somebody is there */
    bool rests;                        /* nothing was drawn since all was given back */
};

struct slow { /* a picture that takes long and is drawn step by step */
    struct canvas *canvas; /* NULL: none */
    struct batch batch;
    struct snapshot *snapshot;   /* of what it shows, unless */
    const struct moment *moment; /* it is of an instant */
    enum urgency urgency;
    int64_t asked_ns, field_ns;
    int64_t px, spent_ns;    /* so far, of time */
    uint64_t payer;          /* whose */
    int64_t payer_spent_ns;  /* by that, before */
    bool keeps; /* when it is done, new readings are quick to show: they need not wait for it, nor it be given up for them */
};

struct drawing {
    struct painter *painter;
    struct gl *gl;
    struct field *field;
    struct renderer *renderer;
    struct snapshot *snapshot;
    struct batch same;
    struct recent recent;
    struct slow slow;   /* one at a time */
    struct slow parked; /* a large one, while a small one of another address is drawn */
    bool warm; /* what only the first pictures cost was paid */
    struct flying flying;
    struct held held; /* pictures whose field takes long: worked on step by step, each in its turn */
    struct resting resting;
};

/* --- sharing.c: one picture for all who want the same, whenever they ask --- */

/* The frame, encoded, to all of the batch that are still there; empties it. cost_ns: what it took to draw, which they share. */
void sharing_submit(struct painter *painter, struct frame *frame, struct batch *batch, int64_t cost_ns);
/* Answers those for whom nothing changed, and those for whom another's frame does, or will when it comes; takes them out of the batch.
   Returns the content (canvas_content). */
uint64_t sharing_leave_out_same(struct drawing *drawing, const struct snapshot *snapshot, struct batch *batch);
/* Likewise who asks a moment later than others for the same view: what was drawn for them will do, if all that changed since is readings
   that he has yet to be told of. Before the field is brought up to date. */
void sharing_take_recent(struct drawing *drawing, struct batch *batch);

/* --- resting.c: memory --- */

void resting_init(struct resting *resting, struct painter *painter);
void drawing_bound(struct drawing *drawing); /* what is kept is counted, and brought under its bound */
void drawing_stir(struct drawing *drawing);  /* something was worked out: it may rest, but not now */
void drawing_look(struct drawing *drawing);  /* after each turn: that, once a second */
/* Under the painter's lock: nobody was there for some time, and something is kept. False: not before *wait_until_ns, if it was later. */
bool drawing_may_rest(struct drawing *drawing, int64_t *wait_until_ns);
void drawing_rest(struct drawing *drawing); /* all of it is given back; no picture may be under way */

/* --- turns.c --- */

/* Under lock. Its small picture that takes long need not wait for the end of another address's large one. */
bool drawing_overtakes(const struct drawing *drawing, const struct client *client);

/* Under nobody's lock, while nobody wants a picture: some of what the first still one will cost. */
void drawing_idle(struct drawing *drawing);
/* Waits for work. False: stop. An empty batch: the slow picture may go on by a step, or a flying one is waited for. */
bool drawing_next(struct drawing *drawing, const struct schedule *schedule, struct batch *batch);
/* The newest readings, if they changed or are some time old. */
void drawing_refresh(struct drawing *drawing);
/* What a view is of: an instant, held in *moment until it is given back (moments_give), or the newest readings. NULL: the instant is not
   at hand (any more): who asked for it has gone on. */
const struct snapshot *drawing_readings(struct drawing *drawing, const struct view *view, const struct moment **moment);
/* Under the painter's lock: until somebody wakes it, or then. */
void drawing_wait(struct painter *painter, int64_t mono_ns);

#endif
