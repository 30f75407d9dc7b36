/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Interface of a render backend: GL or software. On machines without a GPU, renderer.c asks the software backend first; GL
   draws the frames that the software backend cannot draw. Call only in the thread that owns the GL context. */
#ifndef RENDER_RENDER_BACKEND_H
#define RENDER_RENDER_BACKEND_H
#include <stdbool.h>
#include <stdint.h>

struct frame_context;
struct frame_plan;
struct render_job;
struct renderer;

struct render_backend {
    const char *name;
    /* true: the backend reads fields from GPU memory, so render jobs copy fields there; false: they copy fields in main memory */
    bool draws_from_gpu;
    /* Creates the resources that the backend needs for its first frame; later calls do nothing. On failure, logs the reason and
       returns false. */
    bool (*init)(struct renderer *renderer);
    void (*finish)(struct renderer *renderer);
    /* Returns whether the backend can draw this frame; if not, another backend must. */
    bool (*can)(const struct frame_context *context);
    /* Returns whether the backend draws this frame about as fast as a preview. */
    bool (*is_quick)(struct renderer *renderer, const struct frame_context *context);
    /* Begins to draw the job's frame. at_once true: the caller calls end or submit next; false: the caller may draw other frames in
       between. On failure, logs the reason and returns false; the caller then calls abandon. */
    bool (*begin)(struct renderer *renderer, struct render_job *job, const struct frame_plan *plan, bool at_once);
    /* Draws at least one step of the job's frame, and more steps for about budget_ns. The job's light must be ready. Returns true when only
       end() is left to call. */
    bool (*step)(struct renderer *renderer, struct render_job *job, int64_t budget_ns);
    /* Completes job->frame: its pixels, markers and labels. On failure, logs the reason and returns false. */
    bool (*end)(struct renderer *renderer, struct render_job *job);
    /* Frees what the backend has stored in the job (render_job.of). Call it once the job is done or abandoned. */
    void (*abandon)(struct renderer *renderer, struct render_job *job);
    /* Submits all remaining work to the GPU without waiting; end() waits for the result. On failure, logs the reason and
       returns false. NULL where there is no GPU. */
    bool (*submit)(struct renderer *renderer, struct render_job *job);
    /* Returns whether the GPU has finished a submitted job, so that end() returns without waiting. NULL where submit is NULL. */
    bool (*is_complete)(const struct render_job *job);
};
extern const struct render_backend render_backend_gl, render_backend_soft;

#endif
