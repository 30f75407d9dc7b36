/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws views that may be split: two halves under one camera, each planned and drawn as a frame of its own and then laid side by side. A
   view that is not split is one half. Thread: the one of the GL context. */
#ifndef RENDER_SPLIT_VIEW_H
#define RENDER_SPLIT_VIEW_H
#include "render/renderer.h"

struct split_plan { /* immutable */
    struct view view;
    int half_count;
    struct frame_plan *halves[2];
    uint64_t content; /* of both: the content of the frame */
};
struct split_view; /* a frame that is being drawn: one job for each half */

/* Decides what a frame of this view shows now. Works towards the field of each half for about budget_ns (INT64_MAX: as long as it takes);
   NULL: one is not there yet. The caller owns the plan (split_plan_destroy). */
struct split_plan *split_view_plan(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot, int64_t budget_ns);
void split_plan_destroy(struct split_plan **plan); /* &NULL is fine; leaves NULL */

/* Each as the function of renderer.h by that name. */
bool split_view_is_quick(struct renderer *renderer, const struct split_plan *plan);
struct frame *split_view_draw(struct renderer *renderer, const struct split_plan *plan);
struct split_view *split_view_begin(struct renderer *renderer, const struct split_plan *plan);
struct split_view *split_view_submit(struct renderer *renderer, const struct split_plan *plan);
bool split_view_is_complete(const struct split_view *split);
bool split_view_keeps(const struct split_view *split);
bool split_view_step(struct renderer *renderer, struct split_view *split, int64_t budget_ns);
struct frame *split_view_end(struct renderer *renderer, struct split_view **split);
void split_view_abandon(struct renderer *renderer, struct split_view **split); /* &NULL is fine; leaves NULL */

/* Plans and draws a frame, however long its field takes. The caller owns it. NULL on failure, logged. */
struct frame *split_view_draw_now(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot);

#endif
