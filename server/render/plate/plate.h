/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Still pictures on machines without a GPU, drawn in small steps on all cores as drafts are (render/draft/draft.h): four samples to a pixel
   say which triangles it shows, then each surface in a pixel is shaded once, as shaders/refined.frag does. What it cannot show is left
   to GL. Thread: the one of the GL context; it spreads its work over the workers. */
#ifndef RENDER_PLATE_H
#define RENDER_PLATE_H
#include "render/draft/draft.h"
#include "render/light/environments.h"
#include "render/recolor.h"

struct plates; /* what they share */
struct plate;  /* one picture */

/* All must outlive it. */
struct plates *plates_create(struct workers *workers, const struct gpu_scene *gpu_scene, const struct sky *sky, struct draft *draft,
                             const struct environments *environments);
void plates_destroy(struct plates **plates); /* &NULL is fine; leaves NULL */
/* picture: its view, fields and what is visible. */
bool plates_can(const struct plates *plates, const struct frame_context *context);

/* NULL: the GL context is lost. */
struct plate *plate_begin(struct plates *plates);
/* A bit of it. picture: the same at each step, with its light and colormap. True: nothing is left to do. */
bool plate_step(struct plate *plate, const struct frame_context *context, const struct light *light, struct frame *frame);
/* When nothing is left to do: labels its isolines, whose points these are, and keeps what it takes to colour the picture again. False: the
   picture failed, for want of memory, or the GL context is lost; logged. */
bool plates_keep(struct plates *plates, struct plate *plate, const struct frame_context *context, const struct isoline_points *points,
                 struct frame *frame);
void plate_end(struct plates *plates, struct plate **plate); /* &NULL is fine; leaves NULL */

void plates_bound(struct plates *plates, size_t bytes); /* of what is kept to colour pictures again */
size_t plates_kept_bytes(const struct plates *plates);  /* of that */
size_t plates_room_bytes(const struct plates *plates);  /* to draw in, but for a picture that is under way */
size_t plates_light_bytes(const struct plates *plates); /* read back */
void plates_drop_spare(struct plates *plates);          /* room to draw in, likewise */
void plates_rest(struct plates *plates);                /* all three */

/* A picture that differs in values and colours only was drawn, and is kept. */
bool plates_know(struct plates *plates, const struct frame_context *context);
/* Colours it again: picture with its colormap, points of its isolines. False: it is not kept. */
bool plates_recolor(struct plates *plates, const struct frame_context *context, const struct isoline_points *points, struct frame *frame);

#endif
