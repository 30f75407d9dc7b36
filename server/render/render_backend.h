/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A way to draw frames: with GL, or in software. renderer.c asks the software one first, if there is one; GL draws all the rest.
   Thread: the one of the GL context. */
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
    bool draws_from_gpu; /* fields, and so copies of them */
    /* Makes what it draws with, unless it is made: before the first frame that it draws. Returns false on failure, logged. */
    bool (*init)(struct renderer *renderer);
    void (*finish)(struct renderer *renderer);
    /* Returns whether it draws such frames. */
    bool (*can)(const struct frame_context *context);
    /* Returns whether it draws this frame in about the time of a preview. */
    bool (*is_quick)(struct renderer *renderer, const struct frame_context *context);
    /* Begins to draw the job's frame. at_once: begin is followed by end or submit, and by nothing else; otherwise other frames may be
       drawn in between. Returns false on failure, logged; abandon frees the rest. */
    bool (*begin)(struct renderer *renderer, struct render_job *job, const struct frame_plan *plan, bool at_once);
    /* Draws on for about that long, and one step at least; the job has its light. Returns true when nothing is left to do but end. */
    bool (*step)(struct renderer *renderer, struct render_job *job, int64_t budget_ns);
    /* Draws what is left: the frame is complete. Returns false on failure, logged. */
    bool (*end)(struct renderer *renderer, struct render_job *job);
    /* Frees what the job holds of the backend's. */
    void (*abandon)(struct renderer *renderer, struct render_job *job);
    /* Gives all that is left to the GPU and does not wait; end does. Returns false on failure, logged. NULL: there is no GPU. */
    bool (*submit)(struct renderer *renderer, struct render_job *job);
    /* Returns whether end would not wait for a job that was submitted. NULL where submit is. */
    bool (*is_complete)(const struct render_job *job);
};
extern const struct render_backend render_backend_gl, render_backend_soft;

#endif
