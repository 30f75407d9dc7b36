/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A picture as it was asked for: one view, or two sets of parameters beside each other under one camera. The halves are pictures of
   their own, of half the width (view_half), so all that holds for a picture holds for each. Thread: the one of the GL context. */
#ifndef RENDER_SPLIT_VIEW_H
#define RENDER_SPLIT_VIEW_H
#include "render/renderer.h"

struct split_view;

/* As the functions of renderer.h that are called likewise. */
bool split_view_prepare(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot, int64_t budget_ns);
uint64_t split_view_content(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot);
struct frame *split_view_draw(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot);
bool split_view_is_quick(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot);
struct split_view *split_view_begin(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot);
bool split_view_step(struct renderer *renderer, struct split_view *split, int64_t budget_ns);
bool split_view_keeps(const struct split_view *split); /* renderer_keeps */
/* On a GPU, as renderer_submit. */
struct split_view *split_view_submit(struct renderer *renderer, const struct view *view, const struct snapshot *snapshot);
bool split_view_is_complete(const struct split_view *split);
struct frame *split_view_end(struct renderer *renderer, struct split_view **split);
void split_view_abandon(struct renderer *renderer, struct split_view **split); /* &NULL is fine; leaves NULL */

#endif
