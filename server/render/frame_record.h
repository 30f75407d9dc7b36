/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A frame record: copies of all readings that a frame was drawn from, used to report later what the frame showed. Immutable
   once made; reference-counted; may be released on any thread. */
#ifndef RENDER_FRAME_RECORD_H
#define RENDER_FRAME_RECORD_H
#include "loopcheck/loop_checks.h"
#include "render/view.h"
#include "value/baselines.h"

/* maximum number of baselines in a record: one for each half of a split view (two pictures side by side) */
enum { FRAME_RECORD_BASELINES = 2 };
struct frame_record {
    _Atomic int refs;
    struct snapshot *readings;
    bool *unproven; /* by tag: true if no loop check has proven the tag's wiring; markers show this */
    struct {
        struct baseline what;
        struct snapshot *readings;
    /* baselines (saved readings) that the frame's halves subtract from the readings; if both halves use the same baseline, it
       is stored once */
    } baselines[FRAME_RECORD_BASELINES];
    int baseline_count;
};

/* Creates a record: copies the readings and the baselines that the view subtracts from them, and stores which tags no loop check has
   proven. baselines NULL: there are no baselines; loop_checks NULL: there are no loop checks. The caller owns the record
   (frame_record_unref). */
struct frame_record *frame_record_create(const struct view *view, const struct snapshot *readings, struct baselines *baselines,
                                         const struct loop_checks *loop_checks);
/* Returns a record in which no tag has a reading. The caller fills it in before other threads see it. */
struct frame_record *frame_record_empty(size_t tag_count);
struct frame_record *frame_record_ref(struct frame_record *record); /* NULL is allowed and returned */
/* releases the record and sets *record to NULL; accepts a pointer to NULL */
void frame_record_unref(struct frame_record **record);

#endif
