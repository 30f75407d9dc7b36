/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Previews on machines without a GPU: from triangles to pixels on all cores, with SIMD, where a software GL would bring every triangle
   through one thread. Shows what shaders/preview.* show, within rounding.

   Parts of models that can be seen are drawn into tiles, nearest first (a depth and a 32-bit mark per pixel), and pixels are then coloured
   by their marks: what is hidden is never coloured. The order of tiles and threads does not matter to the result.
   Thread: the one of the GL context; it spreads its work over `workers`. */
#ifndef RENDER_SOFT_H
#define RENDER_SOFT_H
#include "base/workers.h"
#include "render/frame.h"
#include "render/pick/isolines.h"
#include "render/light/sky.h"
#include "render/frame_context.h"

struct soft;

/* Returns NULL if the GL context is lost. All arguments must outlive it. keeper: keeps the parts of models for this one too; NULL: they are
   its own. */
struct soft *soft_create(struct workers *workers, const struct gpu_scene *gpu_scene, const struct sky *sky, struct soft *keeper);
void soft_destroy(struct soft **soft);            /* &NULL is fine; leaves NULL */
void soft_bound(struct soft *soft, size_t bytes); /* of pictures of cameras that stand still */
size_t soft_kept_bytes(const struct soft *soft);  /* of these */
size_t soft_room_bytes(const struct soft *soft);  /* to draw in */
size_t soft_light_bytes(const struct soft *soft); /* read back */
void soft_rest(struct soft *soft);                /* drops all three */
/* Pixels, markers and labels. False: out of memory, or the GL context is lost; logged. */
bool preview_draw(struct soft *soft, const struct frame_context *context, const struct light *light, const struct isoline_points *points,
                  struct frame *frame);

#endif
