/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes frame plans. Thread: the one of the GL context. */
#ifndef RENDER_PLAN_FRAME_PLANNER_H
#define RENDER_PLAN_FRAME_PLANNER_H
#include "render/plan/frame_plan.h"

struct frame_planner { /* what plans are made from; all of it outlives them */
    const struct gpu_scene *gpu_scene;
    struct fields *fields;
    struct light *light;
    bool near_light; /* previews take the light most like the one they ask for, until that is baked */
    bool finest;     /* without coarser levels of detail */
};

/* Finds what that view shows, but for the fields. view must be checked, and not split. */
struct frame_plan *frame_plan_create(const struct frame_planner *planner, const struct view *view);
void frame_plan_destroy(struct frame_plan **plan); /* &NULL is fine; leaves NULL */
/* Works towards its fields for about that long. Returns true when they are there, so that frame_plan_complete() will not take long, or at
   once where there is no limit (INT64_MAX). */
bool frame_plan_prepare(struct frame_plan *plan, const struct frame_planner *planner, const struct snapshot *snapshot, int64_t budget_ns);
/* Brings its fields up to date with the snapshot, and fills in the rest. Where there is no room for a field it shows no data; logged. Two
   plans with equal content give equal frames. */
void frame_plan_complete(struct frame_plan *plan, const struct frame_planner *planner, const struct snapshot *snapshot);
/* Returns the key of the light that the view asks for, whether it is baked or not. */
struct light_key frame_plan_wanted_light(const struct view *view);

#endif
