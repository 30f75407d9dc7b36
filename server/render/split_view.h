/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws views that may be split into two halves under one camera. Each half is planned and drawn as a frame of its own; then
   the two are joined side by side. A view that is not split has one half. Call only in the thread that owns the GL context. */
#ifndef RENDER_SPLIT_VIEW_H
#define RENDER_SPLIT_VIEW_H
#include "render/renderer.h"

struct split_plan { /* immutable */
    struct view view;
    int half_count;
    struct frame_plan *halves[2];
    uint64_t content; /* hash of the contents of all halves' frame plans; frames with the same hash look the same */
};
struct split_view; /* a frame that is being drawn, with one render job for each half of the view */

/* Plans a frame of this view: one frame plan per half. Computes the field of each half for about budget_ns (INT64_MAX: until it is ready).
   The caller owns the plan (split_plan_destroy). Returns NULL if a field is not ready yet. */
struct split_plan *split_view_plan(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot, int64_t budget_ns);
void split_plan_destroy(struct split_plan **plan); /* frees the plan and sets *plan to NULL; accepts a pointer to NULL */

/* The functions below apply the renderer.h function with the same suffix to all halves. */
bool split_view_is_quick(struct renderer *renderer, const struct split_plan *plan);
struct frame *split_view_draw(struct renderer *renderer, const struct split_plan *plan);
struct split_view *split_view_begin(struct renderer *renderer, const struct split_plan *plan);
struct split_view *split_view_submit(struct renderer *renderer, const struct split_plan *plan);
bool split_view_is_complete(const struct split_view *split);
bool split_view_keeps(const struct split_view *split);
bool split_view_step(struct renderer *renderer, struct split_view *split, int64_t budget_ns);
struct frame *split_view_end(struct renderer *renderer, struct split_view **split);
/* abandons all jobs and sets *split to NULL; accepts a pointer to NULL */
void split_view_abandon(struct renderer *renderer, struct split_view **split);

/* Plans and draws a frame of the view; waits until its fields are computed. The caller owns the frame. NULL on failure, after
   logging the reason. */
struct frame *split_view_draw_now(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot);

#endif
