/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Legend, markers, labels, clock and data age drawn into a frame, for snapshots, clips and walls (streams leave it to the client). */
#ifndef RENDER_OVERLAY_H
#define RENDER_OVERLAY_H
#include <cairo.h>

#include "loopcheck/loop_checks.h"
#include "plant/walls/burn_shift.h"
#include "render/frame.h"

/* Draws over frame->bgrx. The frame must not be shared yet. The clock is shown in the time zone of the process (TZ), which its main
   file sets to the plant's. loop_checks: tags that are unproven are marked as such; NULL: none is. Where the
   frame has a record, that says it. */
void overlay_draw(struct frame *frame, const struct scene *scene, const struct snapshot *snapshot, const struct loop_checks *loop_checks);

/* Draws as overlay_draw() does, but no markers, sensor labels and alarms: for those who may see the picture and no reading. */
void overlay_draw_bare(struct frame *frame, const struct scene *scene, const struct snapshot *snapshot,
                       const struct loop_checks *loop_checks);

/* Draws markers, labels and legend over a surface, which may be transparent, as a pane of a wall has them: only what has an alarm or is bad
   has a label, and what the pane says itself (what plant, when, how old) is left out. Of the frame, pixels are not looked at. unit: pixels
   of the surface that are one at 1280x720. legend: by how much the legend is moved; NULL: not. */
void overlay_draw_pane(cairo_surface_t *surface, const struct frame *frame, const struct scene *scene, const struct snapshot *snapshot,
                       double unit, const struct burn_shift *legend);

/* Computes the part of the view, or of each half of a split view, that legend and clock leave free. Pure. */
void overlay_window(const struct scene *scene, const struct view *view, struct camera_window *out);
/* Likewise of such a pane. */
void overlay_pane_window(const struct scene *scene, const struct view *view, double unit, struct camera_window *out);

#endif
