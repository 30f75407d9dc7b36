/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The renderer: draws frames of a plant's scene, each in a single call or in steps (a render job). Call only in the thread that
   made the GL context. */
#ifndef RENDER_RENDERER_H
#define RENDER_RENDERER_H
#include <stdbool.h>

#include "field/field.h"
#include "gpu/gl.h"
#include "render/frame.h"

struct renderer;
struct frame_plan;    /* render/plan/frame_plan.h */
struct frame_planner; /* render/plan/frame_planner.h */

/* Creates a renderer. On failure, logs the reason and returns NULL. All arguments must outlive the renderer. */
struct renderer *renderer_create(struct log *log, struct gl *gl, const struct scene *scene, struct field *field);
void renderer_destroy(struct renderer **renderer);

/* Returns the pool of the pixel buffers of this renderer's frames. Owned by the renderer; frames that outlive it hold references. */
struct frame_pool *renderer_frames(const struct renderer *renderer);
/* Returns the planner that makes this renderer's frame plans (render/plan/frame_planner.h). Owned by the renderer. */
const struct frame_planner *renderer_planner(const struct renderer *renderer);

/* Returns whether renderer_draw() is about as fast as for a preview. True for previews, on a fast GPU, and for frames that
   differ only in values and colours from a recent refined frame. */
bool renderer_is_quick(struct renderer *renderer, const struct frame_plan *plan);
/* Draws the frame in a single call. The caller owns it (frame_unref). NULL on failure, after logging the reason. */
struct frame *renderer_draw(struct renderer *renderer, const struct frame_plan *plan);

/* Begins a job that draws the frame in steps; other frames can be drawn in between. The job copies everything it needs from the
   plan. Any number of jobs may be in progress. renderer_end() or renderer_abandon() frees the job. NULL on failure, after
   logging the reason. */
struct render_job *renderer_begin(struct renderer *renderer, const struct frame_plan *plan);
/* Returns whether a frame of the same view with other readings will be quick (renderer_is_quick) once this job has ended. */
bool renderer_keeps(const struct render_job *job);
/* Draws at least one step of the job's frame, and more steps for about budget_ns. Returns true when only renderer_end() is left to call. */
bool renderer_step(struct renderer *renderer, struct render_job *job, int64_t budget_ns);
/* Completes the frame and destroys the job. The caller owns the frame. NULL on failure, after logging the reason. */
struct frame *renderer_end(struct renderer *renderer, struct render_job **job);
/* destroys the job without a frame and sets *job to NULL; accepts a pointer to NULL */
void renderer_abandon(struct renderer *renderer, struct render_job **job);
/* Returns whether there is a GPU, so that renderer_submit() works. */
bool renderer_submits(const struct renderer *renderer);
/* Submits the whole frame to the GPU without waiting; renderer_end() waits. A few jobs may be submitted at a time: the GPU then
   draws one frame while the pixels of another are read back. NULL on failure, after logging the reason. */
struct render_job *renderer_submit(struct renderer *renderer, const struct frame_plan *plan);
/* Returns whether the GPU has finished a job of renderer_submit(), so that renderer_end() returns without waiting. */
bool renderer_is_complete(const struct render_job *job);

/* Sets how long (ns) each preview spends on baking the light set of its view while that is not ready. Meanwhile previews use
   the most similar light set that is ready; if none is ready, this call bakes a rough one. With 0, the initial value, a preview
   waits until its light is baked. Refined frames always wait. Logs and returns false when the GPU is out of memory. */
bool renderer_set_bake_budget(struct renderer *renderer, int64_t bake_ns);
/* Computes the light set of the default view (renderer_usual_light) for about budget_ns; call while no client waits for a frame. Returns
   true when it is complete. */
bool renderer_bake_idle(struct renderer *renderer, int64_t budget_ns);

/* Sets whether frames begun from now on get depth grids, with which clients warp pictures (render/depth_grid.h); initially they do not. */
void renderer_set_depth(struct renderer *renderer, bool gives_depth);
bool renderer_gives_depth(const struct renderer *renderer);
/* Sets whether GL draws all frames (true), including those that the software backend would draw on machines without a GPU. */
void renderer_use_gl(struct renderer *renderer, bool always);
/* Sets how the field is computed. per_fragment true: at each fragment, from all sensors, on the finest level
   (render/reference/reference.h), which is slow; false: interpolated between vertices. */
void renderer_set_per_fragment(struct renderer *renderer, bool per_fragment);

#endif
