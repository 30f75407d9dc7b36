/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A picture under way: all that it shows is held fast when it is begun, and it is drawn tile by tile with the camera of the whole,
   so that tiles fit without a seam. Thread: the one of the GL context. */
#ifndef RENDER_RENDER_JOB_H
#define RENDER_RENDER_JOB_H
#include "render/gl/frames_in_flight.h"
#include "render/frame.h"
#include "render/pick/isolines.h"
#include "render/frame_context.h"
#include "render/soft/refined.h"

struct render_job {
    struct frame_context context; /* view, target, fields and visible point into this struct */
    struct view view;
    struct target target;
    struct refined *refined; /* it is drawn without GL, and there is no target; NULL: by GL */
    struct frame *frame;
    struct frame_in_flight *in_flight;  /* it is given to the GPU, whole; NULL: not yet */
    struct light_set *light;            /* held from when it is ready; NULL: not yet */
    const struct fields_entry **fields; /* per asset */
    struct fields_entry *copies;        /* per asset; the slices are held fast; NULL: drawn at once, no copies needed */
    int *visible, *in_tile;
    struct isoline_points isolines;
    int block_px, columns, rows; /* blocks of cells; in a block the cells follow a Z, so that tiles of any size follow one another */
    int next, span;              /* the next cell, counted through all passes, and how many cells its tile has; 0: not chosen yet */
    size_t drawn;                /* of the tile's assets, nearest first */
    bool short_of_memory;        /* the GPU was, while it was drawn: it shows anything */
};

/* Takes the frame and the target over, copies the lists of the picture and its view. whole: one tile holds all. */
void render_job_init(struct render_job *job, const struct frame_context *context, const struct target *target, struct frame *frame,
                     bool whole);
/* Others may draw before this is done: their fields must not show here. False: out of GPU memory, logged. */
bool render_job_hold_fields(struct render_job *job);
void render_job_finish(struct render_job *job); /* the target is the caller's again; the frame goes unless it was taken */

struct tile {
    int x_px, y_px, width_px, height_px; /* from the top left */
};
int render_job_cells(const struct render_job *job); /* of one pass */
/* The largest tile that begins with the next cell and has at most so many pixels, or the smallest. Of no size: outside the picture. */
struct tile render_job_choose_tile(struct render_job *job, double most_px);
/* The picture with only those assets that the tile shows. Valid until the next call. */
struct frame_context render_job_tile_context(struct render_job *job, const struct tile *tile);

#endif
