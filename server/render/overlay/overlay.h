/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws legend, markers, labels, clock and data age into a frame, for snapshots and clips. In live streams, the client draws these. */
#ifndef RENDER_OVERLAY_H
#define RENDER_OVERLAY_H
#include "loopcheck/loop_checks.h"
#include "render/frame.h"

/* Draws legend, markers, labels, clock and data age over frame->bgrx. The frame must not be shared yet. The clock is in the time zone of
   the process (TZ), which main() sets to the plant's. loop_checks: marks unproven tags; NULL: none is marked. If the frame has a record
   (frame_record.h), the record's `unproven` flags are used instead. */
void overlay_draw(struct frame *frame, const struct scene *scene, const struct snapshot *snapshot, const struct loop_checks *loop_checks);

/* Draws legend, clock and data age over the frame, but no markers, sensor labels and alarms. For users who may see the picture
   but no readings. */
void overlay_draw_bare(struct frame *frame, const struct scene *scene, const struct snapshot *snapshot,
                       const struct loop_checks *loop_checks);

/* Computes the rectangle of the view, or of each half of a split view, that legend and clock do not cover. Pure. */
void overlay_window(const struct scene *scene, const struct view *view, struct camera_window *out);

#endif
