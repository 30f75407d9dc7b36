/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes frame plans: what one frame shows, decided before it is drawn (frame_plan.h). Call only in the thread that owns the GL context. */
#ifndef RENDER_PLAN_FRAME_PLANNER_H
#define RENDER_PLAN_FRAME_PLANNER_H
#include "render/plan/frame_plan.h"

struct frame_planner { /* inputs for making frame plans; they must outlive the plans */
    const struct gpu_scene *gpu_scene;
    struct fields *fields;
    struct light *light;
    bool near_light; /* true: a preview uses the most similar light that is ready, until the light for its own view is baked */
    bool finest;     /* true: plans use the finest level of detail of each asset only */
};

/* Plans everything about the view except its fields. The view must be valid and not split. The caller owns the plan. */
struct frame_plan *frame_plan_create(const struct frame_planner *planner, const struct view *view);
void frame_plan_destroy(struct frame_plan **plan); /* frees the plan and sets *plan to NULL; accepts a pointer to NULL */
/* Computes the plan's fields for about budget_ns. Returns true when the fields are ready, which makes frame_plan_complete()
   fast. If budget_ns is INT64_MAX, returns true immediately, and frame_plan_complete() computes the fields. */
bool frame_plan_prepare(struct frame_plan *plan, const struct frame_planner *planner, const struct snapshot *snapshot, int64_t budget_ns);
/* Computes the plan's fields from the newest readings in the snapshot and fills in the remaining members. A field that does not
   fit in memory shows no data, and the failure is logged. Plans with equal content give equal frames. */
void frame_plan_complete(struct frame_plan *plan, const struct frame_planner *planner, const struct snapshot *snapshot);
/* Returns the key of the light set (baked light) that the view asks for, whether or not that set is baked. */
struct light_key frame_plan_wanted_light(const struct view *view);

#endif
