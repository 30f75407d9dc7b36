/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Moving pictures on machines without a GPU: from triangles to pixels on all cores, with SIMD, where a software GL would bring every
   triangle through one thread. Shows what shaders/moving.* show, within rounding. What it cannot show is left to GL.

   Vertices are placed in the picture; triangles that can be seen are sorted into bands of rows; each band is drawn (a depth and a
   32-bit mark per pixel) and then coloured by marks: what is hidden is never coloured. The order of bands and threads does not matter
   to the result.
   Thread: the one of the GL context; it spreads its work over `workers`. */
#ifndef RENDER_DRAFT_H
#define RENDER_DRAFT_H
#include "base/workers.h"
#include "render/frame.h"
#include "render/pick/isolines.h"
#include "render/light/sky.h"
#include "render/frame_context.h"

struct draft;

/* NULL: the GL context is lost. workers and gpu_scene must outlive it. */
struct draft *draft_create(struct workers *workers, const struct gpu_scene *gpu_scene, const struct sky *sky);
void draft_destroy(struct draft **draft);            /* &NULL is fine; leaves NULL */
void draft_bound(struct draft *draft, size_t bytes); /* of pictures of cameras that stand still */
size_t draft_kept_bytes(const struct draft *draft);  /* of these */
size_t draft_room_bytes(const struct draft *draft);  /* to draw in */
size_t draft_light_bytes(const struct draft *draft); /* read back */
void draft_rest(struct draft *draft);                /* drops all three */
bool draft_can(const struct draft *draft, const struct view *view);
/* Pixels, markers and labels. False: out of memory, or the GL context is lost; logged. */
bool draft_draw(struct draft *draft, const struct frame_context *context, const struct light *light, struct isolines *isolines,
                struct frame *frame);

#endif
