/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Software renderer for machines without a GPU. It rasterizes on all cores with SIMD, whereas a software GL would process
   triangles on one thread. Previews look like shaders/preview.*, refined frames like shaders/refined.frag, within rounding.
   Visible parts of models are drawn into tiles, nearest first. Pixels are coloured afterwards by the triangles they show, so
   that hidden surfaces are never shaded. The result does not depend on the order of tiles and threads. Call only in the thread
   that owns the GL context; work is spread over `workers`. */
#ifndef RENDER_SOFT_H
#define RENDER_SOFT_H
#include "base/workers.h"
#include "render/frame.h"
#include "render/light/environments.h"
#include "render/light/sky.h"
#include "render/frame_context.h"
#include "render/pick/isolines.h"

struct soft;    /* shared by all frames */
struct refined; /* state of a refined frame (camera at rest) between its drawing steps */

/* Creates the software renderer. Logs and returns NULL when out of memory. All arguments must outlive the renderer. */
struct soft *soft_create(struct workers *workers, const struct gpu_scene *gpu_scene, const struct sky *sky,
                         const struct environments *environments);
void soft_destroy(struct soft **soft); /* frees the software renderer and sets *soft to NULL; accepts a pointer to NULL */

/* sets the memory limit, in bytes, of the visibility buffers that a tier (preview or refined) keeps while cameras stand still */
void soft_bound(struct soft *soft, enum tier tier, size_t bytes);
size_t soft_kept_bytes(const struct soft *soft);  /* bytes of kept visibility buffers */
/* returns the bytes of the software renderer's working memory, excluding that of refined frames still being drawn */
size_t soft_room_bytes(const struct soft *soft);
size_t soft_light_bytes(const struct soft *soft); /* returns the bytes that copies of baked light from the GPU take */
void soft_drop_spare(struct soft *soft);          /* frees the working memory that finished refined frames left for reuse */
/* frees working memory, copied light and kept visibility buffers, for example while no clients are watching */
void soft_rest(struct soft *soft);

/* Draws a whole preview frame: pixels, visibility of markers, and points for isoline labels. Logs and returns false when out of memory. */
bool preview_draw(struct soft *soft, const struct frame_context *context, const struct light *light, const struct isoline_points *points,
                  struct frame *frame);

struct refined *refined_begin(struct soft *soft);
/* Draws one step of a refined frame: four samples per pixel find the visible triangles, then each surface in a pixel is shaded once.
   context: the frame's context with light and colour map set; the same at each step. Returns true when no step is left. */
bool refined_step(struct refined *refined, const struct frame_context *context, const struct light *light, struct frame *frame);
/* Ends a refined frame after its last step: finds the labels of its isolines among `points`, and keeps its visibility buffer
   for recolouring. Logs and returns false when the frame failed because memory ran out. */
bool refined_keep(struct refined *refined, const struct frame_context *context, const struct isoline_points *points, struct frame *frame);
void refined_end(struct refined **refined); /* frees the refined frame and sets *refined to NULL; accepts a pointer to NULL */

/* Returns whether a visibility buffer is kept from a refined frame that differs from this one only in values and colours. */
bool soft_has_refined(struct soft *soft, const struct frame_context *context);
/* Makes a frame from a kept visibility buffer: computes only its colours, markers and labels again. points: isoline points and arrows among
   which visible labels are chosen. Returns false when no buffer is kept. */
bool soft_resolve_again(struct soft *soft, const struct frame_context *context, const struct isoline_points *points, struct frame *frame);

#endif
