/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the parts of the renderer share. Private to renderer*.c. */
#ifndef RENDER_RENDERER_IMPL_H
#define RENDER_RENDERER_IMPL_H
#include "render/caps.h"
#include "render/draft/draft.h"
#include "render/flight.h"
#include "render/ghosts.h"
#include "render/isolines.h"
#include "render/light/sky.h"
#include "render/lines.h"
#include "render/markers.h"
#include "render/palettes.h"
#include "render/plate/plate.h"
#include "render/renderer.h"
#include "render/solid.h"
#include "render/targets.h"

enum { SURFACES, EDGES, PASSES }; /* of what GL draws bit by bit */

struct renderer {
    struct gl *gl;
    const struct scene *scene;
    struct stage stage;
    struct environments environments;
    struct light light;
    struct fields fields;
    struct reference reference;
    bool per_fragment;
    struct solid solid;
    struct sky sky;
    struct lines lines;
    struct ghosts ghosts;
    struct caps caps;
    struct isolines isolines;
    struct flights flights;
    GLuint frame_buffer;                      /* struct frame_block */
    struct palettes palettes;
    struct targets targets;
    double pixel_ns[PASSES]; /* as measured lately */
    int64_t hurry_ns;    /* 0: none */
    int64_t still_ns;    /* what a GPU took for the last still picture; 0: not known */
    struct draft *draft;   /* NULL: a GPU draws moving pictures too; and below */
    struct plates *plates; /* still ones */
    bool always_gl;
    const struct fields_entry **asset_fields; /* per asset, of the picture being drawn */
    int *visible;
    double *distance_m; /* per asset */
    struct visibility shown; /* by the last picture that was drawn at once */
};

/* An empty frame, and what there is to draw. NULL: out of memory, logged. */
struct frame *renderer_start(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot, struct picture *picture);
/* Light, palette and uniforms of the picture: others drew meanwhile. False: out of GPU memory, logged. */
bool renderer_take_up(struct renderer *renderer, struct picture *picture);
/* The whole picture at once by the steps of a stroke. As renderer_draw. */
struct frame *renderer_draw_stroke(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot);
/* The light that most views have. */
struct light_key renderer_usual_light(const struct renderer *renderer);
/* As renderer_launch. */
struct stroke *renderer_launch_stroke(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot);

#endif
