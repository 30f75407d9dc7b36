/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Refined frames on machines without a GPU, drawn in small steps on all cores by the rasterizer that draws previews
   (render/soft/soft.h): four samples to a pixel say which triangles it shows, then each surface in a pixel is shaded once, as
   shaders/refined.frag does. Thread: the one of the GL context; it spreads its work over the workers.
   */
#ifndef RENDER_SOFT_REFINED_H
#define RENDER_SOFT_REFINED_H
#include "render/soft/soft.h"
#include "render/light/environments.h"
#include "render/soft/visibility_buffer.h"

struct refiner; /* what they share */
struct refined; /* one picture */

/* All must outlive it. */
struct refiner *refiner_create(struct workers *workers, const struct gpu_scene *gpu_scene, const struct sky *sky, struct soft *soft,
                               const struct environments *environments);
void refiner_destroy(struct refiner **refiner); /* &NULL is fine; leaves NULL */

/* NULL: the GL context is lost. */
struct refined *refined_begin(struct refiner *refiner);
/* A bit of it. picture: the same at each step, with its light and colormap. True: nothing is left to do. */
bool refined_step(struct refined *refined, const struct frame_context *context, const struct light *light, struct frame *frame);
/* When nothing is left to do: labels its isolines, whose points these are, and keeps what it takes to colour the picture again. False: the
   picture failed, for want of memory, or the GL context is lost; logged. */
bool refiner_keep(struct refiner *refiner, struct refined *refined, const struct frame_context *context,
                  const struct isoline_points *points, struct frame *frame);
void refined_end(struct refiner *refiner, struct refined **refined); /* &NULL is fine; leaves NULL */

void refiner_bound(struct refiner *refiner, size_t bytes); /* of what is kept to colour pictures again */
size_t refiner_kept_bytes(const struct refiner *refiner);  /* of that */
size_t refiner_room_bytes(const struct refiner *refiner);  /* to draw in, but for a picture that is under way */
size_t refiner_light_bytes(const struct refiner *refiner); /* read back */
void refiner_drop_spare(struct refiner *refiner);          /* room to draw in, likewise */
void refiner_rest(struct refiner *refiner);                /* all three */

/* A picture that differs in values and colours only was drawn, and is kept. */
bool refiner_know(struct refiner *refiner, const struct frame_context *context);
/* Colours it again: picture with its colormap, points of its isolines. False: it is not kept. */
bool refiner_resolve_again(struct refiner *refiner, const struct frame_context *context, const struct isoline_points *points,
                           struct frame *frame);

#endif
