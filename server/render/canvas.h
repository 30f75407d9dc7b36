/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A picture as it was asked for: one view, or two sets of parameters beside each other under one camera. The halves are pictures of
   their own, of half the width (view_half), so all that holds for a picture holds for each. Thread: the one of the GL context. */
#ifndef RENDER_CANVAS_H
#define RENDER_CANVAS_H
#include "render/renderer.h"

struct canvas;

/* As the functions of renderer.h that are called likewise. */
bool canvas_prepare(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot, int64_t budget_ns);
uint64_t canvas_content(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot);
struct frame *canvas_draw(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot);
bool canvas_is_quick(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot);
struct canvas *canvas_begin(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot);
bool canvas_step(struct renderer *renderer, struct canvas *canvas, int64_t budget_ns);
bool canvas_keeps(const struct canvas *canvas); /* renderer_keeps */
/* On a GPU, as renderer_launch. */
struct canvas *canvas_launch(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot);
bool canvas_landed(const struct canvas *canvas);
struct frame *canvas_end(struct renderer *renderer, struct canvas **canvas);
void canvas_abandon(struct renderer *renderer, struct canvas **canvas); /* &NULL is fine; leaves NULL */

#endif
