/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws legend, markers, labels, clock and data age into a frame, for snapshots and clips. For streams the client draws them. */
#ifndef RENDER_OVERLAY_H
#define RENDER_OVERLAY_H
#include "loopcheck/loop_checks.h"
#include "render/frame.h"

/* Draws legend, markers, labels, clock and data age over frame->bgrx. The frame must not be shared yet. The clock is in the time zone of
   the process (TZ), which main() sets to the plant's. loop_checks: marks unproven tags; NULL: none is marked. A frame with a record uses
   the record's flags instead. */
void overlay_draw(struct frame *frame, const struct scene *scene, const struct snapshot *snapshot, const struct loop_checks *loop_checks);

/* Draws like overlay_draw() but without markers, sensor labels and alarms, for users who may see the picture but no readings. */
void overlay_draw_bare(struct frame *frame, const struct scene *scene, const struct snapshot *snapshot,
                       const struct loop_checks *loop_checks);

/* Computes the part of the view, or of each half of a split view, that legend and clock do not cover. Pure. */
void overlay_window(const struct scene *scene, const struct view *view, struct camera_window *out);

#endif
