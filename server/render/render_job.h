/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A frame being drawn: all that it shows is held from its beginning to its end. Thread: the one of the GL context. */
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
    union { /* what the backend keeps of it; NULL: nothing */
        struct gl_job *gl;
        struct soft_job *soft;
    } of;
    struct frame_context context; /* view, fields and visible point into this struct */
    struct view view;
    struct frame *frame;
    struct light_set *light;            /* held from when it is ready; NULL: not yet */
    const struct fields_entry **fields; /* per asset */
    struct fields_entry *copies;        /* per asset, of what is shown; NULL: drawn at once, no copies needed */
    int *visible;
    struct isoline_points isolines;
    bool keeps; /* once it has ended, a frame of other readings is quick */
};

/* Takes the frame over, copies the context's lists and its view. */
void render_job_init(struct render_job *job, const struct frame_context *context, struct frame *frame);
/* Copies the fields, so that frames drawn before this one is done do not change it: on the GPU, or their values at vertices. Returns false
   when out of memory of some kind, logged. */
bool render_job_hold_fields(struct render_job *job, bool on_gpu);
/* Frees all but what the backend keeps, and the frame, if it was not taken. */
void render_job_finish(struct render_job *job);

#endif
