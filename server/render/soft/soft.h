/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Frames on machines without a GPU: from triangles to pixels on all cores, with SIMD, where a software GL would bring every triangle
   through one thread. Previews show what shaders/preview.* show, refined frames what shaders/refined.frag shows, within rounding.

   Parts of models that can be seen are drawn into tiles, nearest first, and pixels are then coloured by the triangles that they show: what
   is hidden is never coloured. The order of tiles and threads does not matter to the result.
   Thread: the one of the GL context; it spreads its work over `workers`. */
#ifndef RENDER_SOFT_H
#define RENDER_SOFT_H
#include "base/workers.h"
#include "render/frame.h"
#include "render/light/environments.h"
#include "render/light/sky.h"
#include "render/frame_context.h"
#include "render/pick/isolines.h"

struct soft;    /* what all frames share */
struct refined; /* a refined frame that is drawn in steps */

/* Returns NULL when out of memory, logged. All arguments must outlive it. */
struct soft *soft_create(struct workers *workers, const struct gpu_scene *gpu_scene, const struct sky *sky,
                         const struct environments *environments);
void soft_destroy(struct soft **soft); /* &NULL is fine; leaves NULL */

void soft_bound(struct soft *soft, enum tier tier, size_t bytes); /* of frames of that tier from cameras that stand still */
size_t soft_kept_bytes(const struct soft *soft);                  /* of all these */
size_t soft_room_bytes(const struct soft *soft);                  /* to draw in, but for refined frames that are under way */
size_t soft_light_bytes(const struct soft *soft);                 /* read back */
void soft_drop_spare(struct soft *soft);                          /* room to draw in, of refined frames */
void soft_rest(struct soft *soft);                                /* drops all of these */

/* Draws pixels, markers and labels. Returns false when out of memory; logged. */
bool preview_draw(struct soft *soft, const struct frame_context *context, const struct light *light, const struct isoline_points *points,
                  struct frame *frame);

struct refined *refined_begin(struct soft *soft);
/* Draws a bit of it: four samples to a pixel say which triangles it shows, then each surface in a pixel is shaded once. context: the same
   at each step, with its light and colour map. Returns true when nothing is left to do. */
bool refined_step(struct refined *refined, const struct frame_context *context, const struct light *light, struct frame *frame);
/* When nothing is left to do: labels its isolines, whose points these are, and keeps what it takes to colour the frame again. Returns false
   when the frame failed, for want of memory; logged. */
bool refined_keep(struct refined *refined, const struct frame_context *context, const struct isoline_points *points, struct frame *frame);
void refined_end(struct refined **refined); /* &NULL is fine; leaves NULL */

/* Returns whether a refined frame that differs in values and colours only was drawn, and is kept. */
bool soft_has_refined(struct soft *soft, const struct frame_context *context);
/* Colours a frame that is kept again: pixels, markers and labels. points: of its isolines. Returns false when it is not kept. */
bool soft_resolve_again(struct soft *soft, const struct frame_context *context, const struct isoline_points *points, struct frame *frame);

#endif
