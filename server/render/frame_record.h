/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A frame record: copies of all readings that a frame was drawn from, for whoever has to say later what it shows. Immutable once made;
   counted; may be released on any thread. */
#ifndef RENDER_FRAME_RECORD_H
#define RENDER_FRAME_RECORD_H
#include "loopcheck/loop_checks.h"
#include "render/view.h"
#include "value/baselines.h"

enum { FRAME_RECORD_BASELINES = 2 }; /* one for each half */
struct frame_record {
    _Atomic int refs;
    struct snapshot *readings;
    bool *unproven; /* by tag: its loop was not checked, and its marker says so */
    struct {
        struct baseline what;
        struct snapshot *readings;
    } baselines[FRAME_RECORD_BASELINES]; /* what differences are from; each once */
    int baseline_count;
};

/* Copies the readings, the baselines that the view shows differences from, and which tags are unproven. baselines, loop_checks: NULL: there
   are none. The caller owns the record (frame_record_unref). */
struct frame_record *frame_record_create(const struct view *view, const struct snapshot *readings, struct baselines *baselines,
                                         const struct loop_checks *loop_checks);
/* Makes one in which no tag has a reading, to be filled in before others see it. */
struct frame_record *frame_record_empty(size_t tag_count);
struct frame_record *frame_record_ref(struct frame_record *record); /* NULL is fine, and is returned */
void frame_record_unref(struct frame_record **record);              /* &NULL is fine; leaves NULL */

#endif
