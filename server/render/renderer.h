/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws views of the scene. Thread: the one that made the GL context. */
#ifndef RENDER_RENDERER_H
#define RENDER_RENDERER_H
#include <stdbool.h>

#include "field/field.h"
#include "gpu/gl.h"
#include "render/frame.h"

struct renderer;

/* NULL on failure, logged. All must outlive it. */
struct renderer *renderer_create(struct log *log, struct gl *gl, const struct scene *scene, struct field *field);
void renderer_destroy(struct renderer **renderer);

/* Works towards the field of this view for about that long. True: it is there, and what is below does not wait for it. */
bool renderer_prepare(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot, int64_t budget_ns);
/* What the picture of this view would show now; equal to frame->content of an earlier frame if drawing it again would give the
   same picture (camera, parameters, size and every field value in view, to a colour step). Brings the field up to date; cheap. */
uint64_t renderer_content(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot);
/* renderer_draw draws it in about the time of a moving picture: it is one, or differs in values and colours only from a still one that
   was drawn lately, or there is a GPU that is fast enough. Its field is prepared. */
bool renderer_is_quick(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot);
/* The caller owns the frame (frame_unref). NULL on failure, logged. view is already checked. */
struct frame *renderer_draw(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot);
/* Without a GPU most moving pictures are drawn by other means (render/draft/draft.h), unless GL shall draw them always: to compare. */
void renderer_use_gl(struct renderer *renderer, bool always);
/* What other assets hide is left out of pictures of so many triangles. INT_MAX: of none, but clusters that are not seen. From the
   beginning: what pays. */
void renderer_set_occlusion_least(struct renderer *renderer, int least_triangles);
/* By GL each asset is drawn by calls of its own, not with all that are alike: to compare. */
void renderer_set_batching_off(struct renderer *renderer, bool one_by_one);
/* So many assets were left out of the last picture that GL drew; waits for it. */
size_t renderer_occluded_count(const struct renderer *renderer);

/* A light that is not baked yet: pictures of the moving tier show the one most like it for now, and bake on for about that long each.
   Where none is, a rough one is made for now. Without this, and in the still tier, a picture takes the time that its light takes.
   False: out of GPU memory, logged. */
bool renderer_set_bake_budget(struct renderer *renderer, int64_t bake_ns);
/* Nobody wants a picture: bakes the light that most views have, for about that long. True: there is nothing more to do. */
bool renderer_bake_idle(struct renderer *renderer, int64_t budget_ns);

/* From now on the field is worked out at each fragment, over all sensors, on the finest level (renderer_measure: on the one it is asked
   for; render/reference/reference.h): slow, for comparison. */
void renderer_set_per_fragment(struct renderer *renderer, bool per_fragment);
/* What the pixels of the view's tier stand for, at one sample each, rows from the top: the field's place in the range (unclamped,
   never on a logarithmic scale), no data (0..1; MEASURE_CONTEXT: an asset without a field; MEASURE_NOTHING), uncertain (0..1), depth
   (1 near, 0 far). finest: without coarser levels of detail. False: logged. */
enum { MEASURE_CONTEXT = -1, MEASURE_NOTHING = -2 };
bool renderer_measure(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot, bool finest, float (*out)[4]);

/* The same picture drawn bit by bit, so that others can be drawn in between; it shows what there was to see when it was begun.
   As many as fit in memory may be under way. NULL on failure, logged. */
struct render_job *renderer_begin(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot);
bool renderer_keeps(const struct render_job *job); /* when it is ended, the same with other readings is quick (renderer_is_quick) */
/* Draws on for about that long, and a bit at least. True: nothing is left to do but renderer_end. */
bool renderer_step(struct renderer *renderer, struct render_job *job, int64_t budget_ns);
/* Draws what is left. The caller owns the frame. NULL on failure, logged. The job is gone in either case. */
struct frame *renderer_end(struct renderer *renderer, struct render_job **job);
/* With a GPU: gives it the whole picture and does not wait; renderer_end does. A few may be under way, so that one is drawn while
   another one's pixels come. NULL on failure, logged. */
bool renderer_submits(const struct renderer *renderer);
struct render_job *renderer_submit(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot);
bool renderer_is_complete(const struct render_job *job);                   /* renderer_end would not wait */
void renderer_abandon(struct renderer *renderer, struct render_job **job); /* &NULL is fine; leaves NULL */

#endif
