/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws frames of the scene, at once or as jobs in steps. Thread: the one that made the GL context. */
#ifndef RENDER_RENDERER_H
#define RENDER_RENDERER_H
#include <stdbool.h>

#include "field/field.h"
#include "gpu/gl.h"
#include "render/frame.h"

struct renderer;
struct frame_plan;    /* render/plan/frame_plan.h */
struct frame_planner; /* render/plan/frame_planner.h */

/* Returns NULL on failure, logged. All arguments must outlive it. */
struct renderer *renderer_create(struct log *log, struct gl *gl, const struct scene *scene, struct field *field);
void renderer_destroy(struct renderer **renderer);

/* Returns what frames of this renderer are planned with (render/plan/frame_planner.h). Owned by the renderer. */
const struct frame_planner *renderer_planner(const struct renderer *renderer);

/* Returns whether renderer_draw() takes about the time of a preview: it is one, or differs in values and colours only from a refined frame
   that was drawn lately, or there is a GPU that is fast enough. */
bool renderer_is_quick(struct renderer *renderer, const struct frame_plan *plan);
/* Draws the frame at once. The caller owns it (frame_unref). NULL on failure, logged. */
struct frame *renderer_draw(struct renderer *renderer, const struct frame_plan *plan);

/* Begins a job that draws the frame in steps, so that others can be drawn in between; it keeps what the plan shows, and the plan is not
   needed any more. As many as fit in memory may be under way. renderer_end() or renderer_abandon() frees the job. NULL on failure,
   logged. */
struct render_job *renderer_begin(struct renderer *renderer, const struct frame_plan *plan);
/* Returns whether a frame of other readings will be quick (renderer_is_quick) once this job has ended. */
bool renderer_keeps(const struct render_job *job);
/* Draws on for about that long, and one step at least. Returns true when nothing is left to do but renderer_end(). */
bool renderer_step(struct renderer *renderer, struct render_job *job, int64_t budget_ns);
/* Draws what is left, and destroys the job. The caller owns the frame. NULL on failure, logged. */
struct frame *renderer_end(struct renderer *renderer, struct render_job **job);
/* Destroys the job without a frame. &NULL is fine; leaves NULL. */
void renderer_abandon(struct renderer *renderer, struct render_job **job);
/* Returns whether renderer_submit() is of use: there is a GPU. */
bool renderer_submits(const struct renderer *renderer);
/* Gives the whole frame to the GPU and does not wait; renderer_end() does. A few may be under way, so that one is drawn while another one's
   pixels come. NULL on failure, logged. */
struct render_job *renderer_submit(struct renderer *renderer, const struct frame_plan *plan);
/* Returns whether renderer_end() would not wait for a job that was submitted. */
bool renderer_is_complete(const struct render_job *job);

/* Sets how long each preview bakes on at a light that is not there yet. Until it is there, previews show the ready light most like it; if
   no light is ready, this call makes a rough one. With 0, the value at first, a preview waits until its light is baked. Refined frames
   always wait. Returns false when the GPU is out of memory, logged. */
bool renderer_set_bake_budget(struct renderer *renderer, int64_t bake_ns);
/* Bakes the light that most views have, for about that long, while nobody wants a frame. Returns true when there is nothing more to do. */
bool renderer_bake_idle(struct renderer *renderer, int64_t budget_ns);

/* Draws by GL what is drawn in software where there is no GPU. */
void renderer_use_gl(struct renderer *renderer, bool always);
/* per_fragment true: works the field out at each fragment from now on, over all sensors, on the finest level
   (render/reference/reference.h): slow. false: interpolates it between vertices again. */
void renderer_set_per_fragment(struct renderer *renderer, bool per_fragment);

#endif
