/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads numbers instead of colours from a renderer, and disables its optimisations. Call only in the thread that created the GL context. */
#ifndef TESTS_RENDERER_COMPARE_H
#define TESTS_RENDERER_COMPARE_H
#include <stdbool.h>
#include <stddef.h>

/* special values in the second channel (no data) of renderer_measure(): the sample shows an asset without a field; it shows no
   asset */
enum { MEASURE_CONTEXT = -1, MEASURE_NOTHING = -2 };

struct renderer; /* render/renderer.h */
struct snapshot;
struct view;

/* Occlusion culling runs only for frames with at least this many triangles; INT_MAX: never (clusters outside the frustum are
   still culled). By default this is the number from which culling saves time. */
void renderer_set_occlusion_least(struct renderer *renderer, int least_triangles);
/* Returns how many assets occlusion culling removed from the last frame drawn by GL; waits for that frame. */
size_t renderer_occluded_count(const struct renderer *renderer);
/* one_by_one true: draws each asset with GL calls of its own; false: draws equal assets together (batching), as usual. */
void renderer_set_batching_off(struct renderer *renderer, bool one_by_one);
/* Draws the field's values instead of colours: one sample per pixel, rows from the top. Channels: position in the range
   (unclamped, always linear); no data, 0 to 1, or one of the two values above; uncertain, 0 to 1; depth, 1 near to 0 far.
   finest: draws only the finest levels of detail. On failure, logs the reason and returns false. */
bool renderer_measure(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot, bool finest, float (*out)[4]);

#endif
