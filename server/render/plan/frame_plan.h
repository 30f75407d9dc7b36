/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What one frame shows, decided once: what is in sight, on which levels, in what light, with which fields, and the hash of all that.
   Immutable once it is complete; whoever prepares, shares, draws or keeps the frame takes it. Thread: the one of the GL context. */
#ifndef RENDER_PLAN_FRAME_PLAN_H
#define RENDER_PLAN_FRAME_PLAN_H
#include "render/light/light.h"
#include "render/plan/fields.h"
#include "render/view.h"

struct frame_plan {
    const struct gpu_scene *gpu_scene;
    struct view view; /* one that is not split */
    struct view_constants constants;
    struct light_key lit_by; /* what it is drawn with: what the view asks for, or the most alike */
    double error_px;         /* of levels of detail, at most (lod_selection.h); 0: no coarser ones */
    int *visible;            /* assets, nearest first */
    size_t visible_count;
    size_t *vertex_counts;   /* of these: so many of the first vertices are drawn, or looked at for labels */
    /* --- once it is complete --- */
    const struct fields_entry **fields; /* per asset; NULL: context. Good until a plan of newer readings is complete */
    int64_t data_utc_ns;                /* of the snapshot */
    uint64_t content, shape;            /* content_hash.h */
    int64_t field_ns;                   /* what it took to bring the fields up to date */
};

#endif
