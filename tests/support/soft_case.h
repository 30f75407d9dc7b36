/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compares frames of the software renderer with the same frames drawn with GL. */
#ifndef TESTS_SUPPORT_SOFT_CASE_H
#define TESTS_SUPPORT_SOFT_CASE_H
#include "tests/support/rig.h"
#include "tests/support/test.h"

/* Returns a view of the whole scene. */
struct view soft_view(const struct stand *stand, enum tier tier, int width_px, int height_px);
void soft_lines_every(struct view *view, double step);
void soft_cut_at(struct view *view, int plane, double x, double y, double z, double d); /* sets the last clip plane of the view */
/* soft_draw_anew() draws a frame in software without using earlier results; soft_draw_by_gl() draws it with GL. */
struct frame *soft_draw_anew(struct stand *stand, const struct view *view);
struct frame *soft_draw_by_gl(struct stand *stand, const struct view *view);
/* returns the largest difference of the three colour channels */
int soft_difference(const struct frame *a, const struct frame *b, int pixel);
/* Asserts that at most the fraction may_differ of the pixels differs; these are at edges, shadow borders or thin lines. */
void soft_assert_same_pixels(const struct frame *soft, const struct frame *gl, double may_differ);
/* Draws both frames and asserts that pixels, markers and labels are the same. */
void soft_assert_like_gl(struct stand *stand, const struct view *view, double may_differ);
/* main() of a test: makes the rig and a toy plant's stand. Skipped on machines with a GPU. */
int soft_run(const char *name, struct rig *rig, struct stand *stand, struct toy *(*make_toy)(void));

#endif
