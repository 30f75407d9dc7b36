/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Render job: a frame being drawn in steps. The job holds everything that the frame shows, until its last step. Call only in
   the thread that owns the GL context. */
#ifndef RENDER_RENDER_JOB_H
#define RENDER_RENDER_JOB_H
#include "render/frame.h"
#include "render/frame_context.h"
#include "render/pick/isolines.h"

struct gl_job;
struct soft_job;
struct render_backend;

struct render_job {
    const struct render_backend *backend;
    union { /* the backend's own state for this job; NULL: none */
        struct gl_job *gl;
        struct soft_job *soft;
    } of;
    /* frame context of the job; its pointers to view, fields and visible assets point to members of this struct */
    struct frame_context context;
    struct view view;
    struct frame *frame;
    /* reference to the light set (baked light) that lights the frame; NULL: that light set is not baked yet */
    struct light_set *light;
    const struct fields_entry **fields; /* by asset: its field; NULL: the asset shows no field */
    /* copies of the shown fields, per asset; NULL: the frame is drawn in a single call and needs no copies */
    struct fields_entry *copies;
    int *visible;
    struct isoline_points isolines;
    /* true: the backend keeps the job's visibility buffer, so that the same view with other readings is drawn about as fast as a preview */
    bool keeps;
};

/* Initialises a job: takes ownership of the frame, and copies view and lists of the frame context. */
void render_job_init(struct render_job *job, const struct frame_context *context, struct frame *frame);
/* Copies the fields into the job, so that planning later frames does not change them. on_gpu true: copies GPU buffers; false:
   vertex values in main memory. Logs and returns false when out of memory (main or GPU). */
bool render_job_hold_fields(struct render_job *job, bool on_gpu);
/* Frees the job's members, and its frame unless job->frame was set to NULL. Does not free the backend's state. */
void render_job_finish(struct render_job *job);

#endif
