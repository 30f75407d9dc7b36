/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What tests and benchmarks compare a renderer's frames by. Thread: the one that made the GL context. */
#ifndef RENDER_RENDERER_COMPARE_H
#define RENDER_RENDERER_COMPARE_H
#include <stdbool.h>
#include <stddef.h>

#include "render/pick/measure_target.h"

struct renderer; /* render/renderer.h */
struct snapshot;
struct view;

/* Leaves out what other assets hide in frames of so many triangles from now on. INT_MAX: in none, but clusters that are not seen. As it
   begins: where it pays. */
void renderer_set_occlusion_least(struct renderer *renderer, int least_triangles);
/* Returns how many assets were left out of the frame that GL drew last; waits for it. */
size_t renderer_occluded_count(const struct renderer *renderer);
/* Draws each asset by GL calls of its own, not with all that are alike. */
void renderer_set_batching_off(struct renderer *renderer, bool one_by_one);
/* Fills out with what the pixels of the view's tier stand for, at one sample each, rows from the top: the field's place in the range
   (unclamped, never on a logarithmic scale), no data (0..1; MEASURE_CONTEXT: an asset without a field; MEASURE_NOTHING), uncertain (0..1),
   depth (1 near, 0 far). finest: without coarser levels of detail. Returns false on failure, logged. */
bool renderer_measure(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot, bool finest, float (*out)[4]);

#endif
