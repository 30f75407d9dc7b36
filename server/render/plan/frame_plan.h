/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A frame plan decides once what one frame shows: visible assets and their levels of detail, light and fields. It also holds a
   hash of all these. Immutable once complete. Everything that prepares, shares, draws or caches the frame uses its plan. Call
   only in the thread that owns the GL context. */
#ifndef RENDER_PLAN_FRAME_PLAN_H
#define RENDER_PLAN_FRAME_PLAN_H
#include "render/light/light.h"
#include "render/plan/fields.h"
#include "render/view.h"

struct frame_plan {
    const struct gpu_scene *gpu_scene;
    struct view view; /* view that the frame shows; never a split one, because a split view has one plan per half */
    struct view_constants constants;
    /* key of the light set (baked light) that the frame uses: the view's own or, while that is not ready, the most similar one */
    struct light_key lit_by;
    double error_px; /* maximum surface error of a level of detail, in pixels of the frame (lod_selection.h); 0: finest levels only */
    int *visible;    /* indices of the visible assets, the nearest asset first */
    size_t visible_count;
    /* [index in `visible`]: number of the asset's vertices whose field values are needed for drawing and labels; they come
       first in the asset file */
    size_t *vertex_counts;
    /* --- set by frame_plan_complete() --- */
    /* field of each asset; NULL: the asset shows no field. Valid until a plan with newer readings is completed */
    const struct fields_entry **fields;
    int64_t data_utc_ns;     /* time of the snapshot */
    uint64_t content, shape; /* content: hash of all that the frame shows; shape: hash of its geometry and light only (content_hash.h) */
    int64_t field_ns;        /* time in nanoseconds that computing the fields of this plan has taken */
};

#endif
