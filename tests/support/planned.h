/* SPDX-License-Identifier: GPL-3.0-or-later */
/* For tests that use a frame plan once: plan a view, then draw it, begin drawing it, or ask for its content. Call only in the
   thread that owns the GL context. */
#ifndef TESTS_SUPPORT_PLANNED_H
#define TESTS_SUPPORT_PLANNED_H
#include "render/plan/frame_planner.h"
#include "render/split_view.h"

static inline struct frame_plan *planned(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot)
{
    struct frame_plan *plan = frame_plan_create(renderer_planner(renderer), view);
    frame_plan_complete(plan, renderer_planner(renderer), snapshot);
    return plan;
}

static inline struct render_job *planned_begin(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot)
{
    struct frame_plan *plan = planned(renderer, view, snapshot);
    struct render_job *job = renderer_begin(renderer, plan);
    frame_plan_destroy(&plan);
    return job;
}

static inline struct render_job *planned_submit(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot)
{
    struct frame_plan *plan = planned(renderer, view, snapshot);
    struct render_job *job = renderer_submit(renderer, plan);
    frame_plan_destroy(&plan);
    return job;
}

static inline struct split_view *planned_split(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot,
                                               bool submit)
{
    struct split_plan *plan = split_view_plan(renderer, view, snapshot, INT64_MAX);
    struct split_view *split = submit ? split_view_submit(renderer, plan) : split_view_begin(renderer, plan);
    split_plan_destroy(&plan);
    return split;
}

/* Returns frame->content (hash of all that a frame shows) of the frame that drawing this view now would give. */
static inline uint64_t planned_content(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot)
{
    struct split_plan *plan = split_view_plan(renderer, view, snapshot, INT64_MAX);
    uint64_t content = plan->content;
    split_plan_destroy(&plan);
    return content;
}

static inline bool planned_is_quick(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot)
{
    struct split_plan *plan = split_view_plan(renderer, view, snapshot, INT64_MAX);
    bool quick = split_view_is_quick(renderer, plan);
    split_plan_destroy(&plan);
    return quick;
}

#endif
