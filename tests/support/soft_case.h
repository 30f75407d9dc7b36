/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compares frames of the software renderer with the same frames drawn with GL. */
#ifndef TESTS_SUPPORT_SOFT_CASE_H
#define TESTS_SUPPORT_SOFT_CASE_H
#include "tests/support/rig.h"
#include "tests/support/test.h"

/* Returns a view that shows the whole scene of the stand. */
struct view soft_view(const struct stand *stand, enum tier tier, int width_px, int height_px);
void soft_lines_every(struct view *view, double step);
/* adds a clip plane: sets the view's plane number `plane`, with the normal (x, y, z) and the distance d, and makes it the last
   one */
void soft_cut_at(struct view *view, int plane, double x, double y, double z, double d);
/* soft_draw_anew() draws a frame with the software renderer without cached results; soft_draw_by_gl() draws the same frame with
   GL. */
struct frame *soft_draw_anew(struct stand *stand, const struct view *view);
struct frame *soft_draw_by_gl(struct stand *stand, const struct view *view);
/* returns the largest difference between the two frames' colour channels at a pixel (0 to 255) */
int soft_difference(const struct frame *a, const struct frame *b, int pixel);
/* Asserts that at most the fraction may_differ of the pixels differs clearly. Such pixels lie at edges, shadow borders and thin
   lines. */
void soft_assert_same_pixels(const struct frame *soft, const struct frame *gl, double may_differ);
/* Draws the view in software and with GL, and asserts that markers and labels are the same and pixels differ at most as in
   soft_assert_same_pixels(). */
void soft_assert_like_gl(struct stand *stand, const struct view *view, double may_differ);
/* To be called by main(): sets up the rig and a stand with the plant that make_toy() returns, and runs the tests of group
   `name`. Skips them on machines with a GPU. Returns the exit code. */
int soft_run(const char *name, struct rig *rig, struct stand *stand, struct toy *(*make_toy)(void));

#endif
