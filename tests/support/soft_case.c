/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws frames in software and with GL, and compares them. */
#include "tests/support/soft_case.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "render/render_backend.h"
#include "render/render_job.h"
#include "tests/support/planned.h"

struct view soft_view(const struct stand *stand, enum tier tier, int width_px, int height_px)
{
    struct view view;
    view_default(&stand->toy->scene, width_px, height_px, &view);
    view.tier = tier;
    return view;
}

void soft_lines_every(struct view *view, double step)
{
    for (double line = step; line < 100 && view->color_scale.line_count < VIEW_LINES; line += step)
        view->color_scale.lines[view->color_scale.line_count++] = line;
}

void soft_cut_at(struct view *view, int plane, double x, double y, double z, double d)
{
    memcpy(view->visibility.clip.planes[plane], (double[4]){ x, y, z, d }, 4 * sizeof(double));
    view->visibility.clip.plane_count = plane + 1;
}

struct frame *soft_draw_anew(struct stand *stand, const struct view *view)
{
    struct render_job *job = planned_begin(stand->renderer, view, stand->snapshot);
    assert_non_null(job);
    assert_ptr_equal(job->backend, &render_backend_soft);
    struct frame *frame = renderer_end(stand->renderer, &job);
    assert_non_null(frame);
    return frame;
}

struct frame *soft_draw_by_gl(struct stand *stand, const struct view *view)
{
    renderer_use_gl(stand->renderer, true);
    struct frame *frame = stand_draw(stand, view);
    renderer_use_gl(stand->renderer, false);
    return frame;
}

int soft_difference(const struct frame *a, const struct frame *b, int pixel)
{
    int most = 0;
    for (int c = 0; c < 3; c++)
        most = abs(a->bgrx[4 * pixel + c] - b->bgrx[4 * pixel + c]) > most ? abs(a->bgrx[4 * pixel + c] - b->bgrx[4 * pixel + c]) : most;
    return most;
}

void soft_assert_same_pixels(const struct frame *soft, const struct frame *gl, double may_differ)
{
    bool refined = soft->view.tier == TIER_REFINED;
    int far = 0, pixels = gl->width_px * gl->height_px;
    double sum = 0;
    for (int i = 0; i < pixels; i++) {
        int by = soft_difference(soft, gl, i);
        far += by > (refined ? 8 : 3);
        sum += by;
    }
    bool same = far <= may_differ * pixels && (!refined || sum <= (1 + 20 * may_differ) * pixels);
    if (!same)
        print_message("# %d of %d pixels differ by more than %d, all by %.2f on average\n", far, pixels, refined ? 8 : 3, sum / pixels);
    assert_true(same);
}

static void assert_same_markers(const struct frame *soft, const struct frame *gl)
{
    assert_int_equal(soft->marker_count, gl->marker_count);
    for (size_t i = 0; i < gl->marker_count; i++) {
        assert_int_equal(soft->markers[i].tag, gl->markers[i].tag);
        assert_int_equal(soft->markers[i].occluded, gl->markers[i].occluded);
        assert_true(fabsf(soft->markers[i].x_px - gl->markers[i].x_px) < 0.01f);
        assert_true(fabsf(soft->markers[i].y_px - gl->markers[i].y_px) < 0.01f);
    }
}

void soft_assert_like_gl(struct stand *stand, const struct view *view, double may_differ)
{
    struct frame *soft = view->tier == TIER_REFINED ? soft_draw_anew(stand, view) : stand_draw(stand, view);
    struct frame *gl = soft_draw_by_gl(stand, view);
    soft_assert_same_pixels(soft, gl, may_differ);
    assert_true(soft->marker_count > 0 || view->visibility.clip.plane_count > 0);
    assert_same_markers(soft, gl);
    assert_int_equal(soft->label_count, gl->label_count);
    for (size_t i = 0; i < gl->label_count; i++) {
        assert_true(soft->labels[i].value == gl->labels[i].value);
        assert_true(fabsf(soft->labels[i].x_px - gl->labels[i].x_px) < 0.11f);
        assert_true(fabsf(soft->labels[i].y_px - gl->labels[i].y_px) < 0.11f);
    }
    assert_int_equal(soft->content, gl->content);
    assert_int_equal(soft->triangles, gl->triangles);
    frame_unref(&soft);
    frame_unref(&gl);
}

int soft_run(const char *name, struct rig *rig, struct stand *stand, struct toy *(*make_toy)(void))
{
    if (!rig_init(rig, name))
        return 0;
    if (!rig->gl->software) {
        printf("TAP version 13\n1..1\nok 1 - %s # SKIP a GPU draws by itself\n", name);
        rig_finish(rig);
        return 0;
    }
    stand_init(stand, rig, make_toy());
    toy_fill(stand->snapshot, 0);
    int failed = tests_run(name);
    stand_finish(stand);
    rig_finish(rig);
    return failed;
}
