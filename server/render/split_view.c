/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws the halves of a split view (two pictures side by side) one after the other and copies them into one frame. */
#include "render/split_view.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "render/depth_grid.h"
#include "render/plan/frame_planner.h"

enum { DIVIDER_PX = 2 };
static const uint64_t CONTENT_FACTOR = 0x9e3779b97f4a7c15u;
static const uint8_t divider_bgrx[4] = { 48, 40, 34, 255 };

struct split_view {
    struct view view;
    /* half_count: number of halves of the view (1: it is not split; 2); done: number of halves that are drawn completely */
    int half_count, done;
    struct render_job *jobs[2];
};

static int count_halves(const struct view *view)
{
    return view->split ? 2 : 1;
}

void split_plan_destroy(struct split_plan **plan)
{
    if (!*plan)
        return;
    frame_plan_destroy(&(*plan)->halves[0]);
    frame_plan_destroy(&(*plan)->halves[1]);
    mem_free(*plan);
    *plan = NULL;
}

struct split_plan *split_view_plan(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot, int64_t budget_ns)
{
    const struct frame_planner *planner = renderer_planner(renderer);
    struct split_plan *plan = mem_new(sizeof(*plan));
    bool ready = true;
    plan->view = *view;
    plan->half_count = count_halves(view);
    for (int half = 0; half < plan->half_count && ready; half++) {
        struct view one;
        view_half(view, half, &one);
        plan->halves[half] = frame_plan_create(planner, &one);
        ready = frame_plan_prepare(plan->halves[half], planner, snapshot, budget_ns);
    }
    for (int half = 0; half < plan->half_count && ready; half++) {
        frame_plan_complete(plan->halves[half], planner, snapshot);
        plan->content = plan->content * CONTENT_FACTOR + plan->halves[half]->content;
    }
    if (!ready)
        split_plan_destroy(&plan);
    return plan;
}

bool split_view_is_quick(struct renderer *renderer, const struct split_plan *plan)
{
    bool quick = true;
    for (int half = 0; half < plan->half_count && quick; half++)
        quick = renderer_is_quick(renderer, plan->halves[half]);
    return quick;
}

static void copy_pixels(struct frame *whole, const struct frame *part, int x_px)
{
    for (int y = 0; y < part->height_px; y++)
        memcpy(whole->bgrx + (size_t)y * (size_t)whole->stride_bytes + (size_t)x_px * 4,
               part->bgrx + (size_t)y * (size_t)part->stride_bytes, (size_t)part->width_px * 4);
}

static void draw_divider(struct frame *frame, int x_px)
{
    for (int y = 0; y < frame->height_px; y++)
        for (int x = x_px - DIVIDER_PX / 2; x < x_px + DIVIDER_PX / 2; x++)
            memcpy(frame->bgrx + (size_t)y * (size_t)frame->stride_bytes + (size_t)x * 4, divider_bgrx, 4);
}

/* Copies a half's markers into the whole frame. x_px: left edge of the half. Markers outside their half are left out, because they would
   appear in the other half. */
static void copy_markers(struct frame *whole, const struct frame *part, int half, int x_px)
{
    size_t capacity = whole->marker_count;
    mem_grow(&whole->markers, &capacity, whole->marker_count + part->marker_count, sizeof(*whole->markers));
    for (size_t i = 0; i < part->marker_count; i++) {
        struct frame_marker marker = part->markers[i];
        if (marker.x_px < 0 || marker.x_px >= (float)part->width_px)
            continue;
        marker.half = (uint8_t)half;
        marker.x_px += (float)x_px;
        whole->markers[whole->marker_count++] = marker;
    }
}

static void copy_labels(struct frame *whole, const struct frame *part, int half, int x_px)
{
    size_t capacity = whole->label_count;
    mem_grow(&whole->labels, &capacity, whole->label_count + part->label_count, sizeof(*whole->labels));
    for (size_t i = 0; i < part->label_count; i++) {
        struct frame_label label = part->labels[i];
        label.half = (uint8_t)half;
        label.x_px += (float)x_px;
        whole->labels[whole->label_count++] = label;
    }
}

static void add_meaning(struct frame *whole, const struct frame *part, int half)
{
    whole->data_utc_ns = part->data_utc_ns;
    if (half == 0 || whole->oldest_age_ns == INT64_MAX)
        whole->oldest_age_ns = part->oldest_age_ns;
    else if (part->oldest_age_ns != INT64_MAX && part->oldest_age_ns > whole->oldest_age_ns)
        whole->oldest_age_ns = part->oldest_age_ns;
    whole->drawn_error[half] = part->drawn_error[0];
    whole->baseline[half] = part->baseline[0];
    whole->field_ns += part->field_ns;
    whole->render_ns += part->render_ns;
    whole->readback_ns += part->readback_ns;
    whole->content = whole->content * CONTENT_FACTOR + part->content;
    whole->triangles += part->triangles;
}

/* Joins the frames of two halves into one frame. Takes ownership of both frames. Returns NULL if one is NULL, or out of memory. */
static struct frame *join(const struct renderer *renderer, const struct view *view, struct frame *parts[2])
{
    struct frame *whole = parts[0] && parts[1] ? frame_create(renderer_frames(renderer), view->width_px, view->height_px) : NULL;
    for (int half = 0; half < 2 && whole; half++) {
        int x_px = half ? view_left_px(view) : 0;
        copy_pixels(whole, parts[half], x_px);
        copy_markers(whole, parts[half], half, x_px);
        copy_labels(whole, parts[half], half, x_px);
        add_meaning(whole, parts[half], half);
        whole->depth[half] = depth_grid_ref(parts[half]->depth[0]);
    }
    if (whole) {
        whole->view = *view;
        draw_divider(whole, view_left_px(view));
    }
    frame_unref(&parts[0]);
    frame_unref(&parts[1]);
    return whole;
}

struct frame *split_view_draw(struct renderer *renderer, const struct split_plan *plan)
{
    struct frame *parts[2] = { NULL };
    for (int half = 0; half < plan->half_count; half++)
        parts[half] = renderer_draw(renderer, plan->halves[half]);
    return plan->half_count == 2 ? join(renderer, &plan->view, parts) : parts[0];
}

struct frame *split_view_draw_now(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot)
{
    struct split_plan *plan = split_view_plan(renderer, view, snapshot, INT64_MAX);
    struct frame *frame = split_view_draw(renderer, plan);
    split_plan_destroy(&plan);
    return frame;
}

typedef struct render_job *begin_fn(struct renderer *renderer, const struct frame_plan *plan);

static struct split_view *begin(struct renderer *renderer, const struct split_plan *plan, begin_fn *begin_half)
{
    struct split_view *split = mem_new(sizeof(*split));
    split->view = plan->view;
    split->half_count = plan->half_count;
    for (int half = 0; half < split->half_count; half++) {
        split->jobs[half] = begin_half(renderer, plan->halves[half]);
        if (!split->jobs[half]) {
            split_view_abandon(renderer, &split);
            return NULL;
        }
    }
    return split;
}

struct split_view *split_view_begin(struct renderer *renderer, const struct split_plan *plan)
{
    return begin(renderer, plan, renderer_begin);
}

struct split_view *split_view_submit(struct renderer *renderer, const struct split_plan *plan)
{
    return begin(renderer, plan, renderer_submit);
}

bool split_view_is_complete(const struct split_view *split)
{
    return renderer_is_complete(split->jobs[0]) && (split->half_count == 1 || renderer_is_complete(split->jobs[1]));
}

bool split_view_keeps(const struct split_view *split)
{
    return renderer_keeps(split->jobs[0]) && (split->half_count == 1 || renderer_keeps(split->jobs[1]));
}

bool split_view_step(struct renderer *renderer, struct split_view *split, int64_t budget_ns)
{
    if (split->done < split->half_count && renderer_step(renderer, split->jobs[split->done], budget_ns))
        split->done++;
    return split->done == split->half_count;
}

struct frame *split_view_end(struct renderer *renderer, struct split_view **split_ptr)
{
    struct split_view *split = *split_ptr;
    struct frame *parts[2] = { NULL }, *frame;
    for (int half = 0; half < split->half_count; half++)
        parts[half] = renderer_end(renderer, &split->jobs[half]);
    frame = split->half_count == 2 ? join(renderer, &split->view, parts) : parts[0];
    split_view_abandon(renderer, split_ptr);
    return frame;
}

void split_view_abandon(struct renderer *renderer, struct split_view **split_ptr)
{
    struct split_view *split = *split_ptr;
    if (!split)
        return;
    for (int half = 0; half < split->half_count; half++)
        renderer_abandon(renderer, &split->jobs[half]);
    mem_free(split);
    *split_ptr = NULL;
}
