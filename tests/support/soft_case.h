/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Frames drawn in software against the same ones by GL. */
#ifndef TESTS_SUPPORT_SOFT_CASE_H
#define TESTS_SUPPORT_SOFT_CASE_H
#include "tests/support/rig.h"
#include "tests/support/test.h"

/* Returns a view of the whole scene. */
struct view soft_view(const struct stand *stand, enum tier tier, int width_px, int height_px);
void soft_lines_every(struct view *view, double step);
void soft_cut_at(struct view *view, int plane, double x, double y, double z, double d); /* the last plane of the view's */
/* Draws a frame in software, whatever was drawn before. */
struct frame *soft_draw_anew(struct stand *stand, const struct view *view);
struct frame *soft_draw_by_gl(struct stand *stand, const struct view *view);
int soft_difference(const struct frame *a, const struct frame *b, int pixel); /* the largest of the three colours' */
/* Asserts that at most such a part of the pixels looks otherwise: where an edge, a shadow's rim or a thin line runs through them. */
void soft_assert_same_pixels(const struct frame *soft, const struct frame *gl, double may_differ);
/* Draws both; asserts that pixels, markers and labels are the same. */
void soft_assert_like_gl(struct stand *stand, const struct view *view, double may_differ);
/* main() of a test: makes the rig and the stand of a toy. Skipped where there is a GPU. */
int soft_run(const char *name, struct rig *rig, struct stand *stand, struct toy *(*make_toy)(void));

#endif
