/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Refined frames without a GPU: lines, slivers and poles compared with GL, and recoloured frames compared with newly drawn ones. */
#include "tests/support/test.h"

#include "tests/support/planned.h"
#include "tests/support/soft_case.h"
#include "value/quality.h"

static struct rig rig;
static struct stand stand;

/* Software frames with isolines, colour bands and logarithmic scales equal those of GL, except at the edges of lines: GL
   computes slopes differently. */
TEST(test_lines_and_scales)
{
    for (int i = 0; i < 8; i++) {
        struct view view = soft_view(&stand, TIER_REFINED, 400, 300);
        stand_look(&stand, i, &view);
        view.camera.height_m = i == 7 ? 6 : 0;
        if (i % 4 != 1)
            soft_lines_every(&view, 10);
        view.ramp_interval = i % 4 == 1 ? 20 : 0;
        if (i % 4 == 2) {
            view.range_min = 10;
            view.color_scale.log = true;
        }
        view.look = i % 4 == 3 ? LOOK_FLAT : i >= 5 ? LOOK_GLOSSY : LOOK_DEFAULT;
        soft_assert_like_gl(&stand, &view, 0.02);
    }
}

/* Makes a floor of 8 m cut into strips that share edges. */
static void make_floor(struct test_shape *shape, uint32_t strips)
{
    shape->vertex_count = 2 * (strips + 1);
    shape->index_count = 6 * strips;
    shape->primitive_count = 1;
    shape->positions = mem_array(shape->vertex_count, sizeof(*shape->positions));
    shape->normals = mem_array(shape->vertex_count, sizeof(*shape->normals));
    shape->indices = mem_array(shape->index_count, sizeof(*shape->indices));
    shape->primitives = mem_array(1, sizeof(*shape->primitives));
    *shape->primitives = (struct asset_primitive){ .index_count = (uint32_t)shape->index_count, .material = TOY_CONCRETE };
    for (uint32_t v = 0; v < shape->vertex_count; v++) {
        memcpy(shape->positions[v], (float[3]){ v % 2 ? 4 : -4, -4 + 8 * (float)(v / 2) / (float)strips, 0 }, 3 * sizeof(float));
        memcpy(shape->normals[v], (float[3]){ 0, 0, 1 }, sizeof(shape->normals[v]));
    }
    for (uint32_t i = 0; i < strips; i++)
        memcpy(shape->indices + 6 * i, (uint32_t[6]){ 2 * i, 2 * i + 1, 2 * i + 2, 2 * i + 1, 2 * i + 3, 2 * i + 2 }, 6 * sizeof(uint32_t));
}

static struct frame *draw_box_over_floor(uint32_t strips, const double light[3])
{
    struct toy *toy = toy_create();
    struct test_shape floor = { 0 }, box = { 0 };
    struct stand others = stand;
    struct view view;
    make_floor(&floor, strips);
    shape_box(&box, TOY_STEEL, (double[3]){ -1, -1, 0 }, (double[3]){ 1, 1, 1 });
    toy_add(toy, "FLOOR", &floor, (double[3]){ 0, 0, 0 }, NULL, 0);
    toy_add(toy, "BOX", &box, (double[3]){ 0, 0, 0.5 }, NULL, 0);
    stand_init(&stand, &rig, toy);
    view = soft_view(&stand, TIER_REFINED, 400, 300);
    memcpy(view.light_dir, light, sizeof(view.light_dir));
    struct frame *frame = soft_draw_anew(&stand, &view);
    stand_finish(&stand);
    stand = others;
    return frame;
}

/* A view in which nothing is visible, drawn while another frame is still being drawn in steps, so that a new job has to be made
   for it. */
TEST(test_nothing_in_sight)
{
    struct view view = soft_view(&stand, TIER_REFINED, 320, 180);
    for (int c = 0; c < 3; c++)
        view.camera.target_m[c] = 2 * view.camera.eye_m[c] - view.camera.target_m[c];
    struct render_job *first = planned_begin(stand.renderer, &view, stand.snapshot);
    assert_non_null(first);
    soft_assert_like_gl(&stand, &view, 0);
    struct frame *frame = test_frame(renderer_end(stand.renderer, &first));
    assert_non_null(frame);
}

/* A sliver is a very thin triangle. The centre of a pixel that shows one may lie outside it; the shadow there must be that of
   the sliver itself, not of a point on its extended plane. */
TEST(test_shadows_on_slivers)
{
    for (int light = 0; light < sweep(3, 1); light++) {
        const double towards[3] = { 0.6 * cos(2 * light), 0.6 * sin(2 * light), 0.8 };
        struct frame *slivers = draw_box_over_floor(1000, towards), *whole = draw_box_over_floor(1, towards);
        int far = 0, pixels = slivers->width_px * slivers->height_px;
        for (int i = 0; i < pixels; i++)
            far += soft_difference(slivers, whole, i) > 8;
        assert_in_range(far, 0, pixels / 1000);
        frame_unref(&slivers);
        frame_unref(&whole);
    }
}

static int darkest(const struct frame *frame, int y)
{
    const uint8_t *row = frame->bgrx + (size_t)y * (size_t)frame->stride_bytes;
    int level = 255;
    for (int x = 0; x < frame->width_px; x++)
        level = row[4 * x + 1] < level ? row[4 * x + 1] : level;
    return level;
}

/* A leaning pole is alternately 3 and 4 pixels wide. Its dark outlines must not vary with that, which would look like beads. */
TEST(test_thin_poles_have_no_beads)
{
    enum { FIRST = 80, LAST = 220 };
    struct toy *toy = toy_create();
    struct test_shape pole = { 0 };
    struct stand others = stand;
    struct view view;
    shape_box(&pole, TOY_STEEL, (double[3]){ -0.056, -0.056, 0 }, (double[3]){ 0.056, 0.056, 8 });
    toy_add(toy, "POLE", &pole, (double[3]){ 0, 0, 0 }, NULL, 0);
    stand_init(&stand, &rig, toy);
    view = soft_view(&stand, TIER_REFINED, 200, 300);
    view.camera = (struct camera){ .eye_m = { 0, -30, 4 }, .target_m = { 0, 0, 4 }, .up = { 0.05, 0, 1 }, .fov_deg = 17.6 };
    struct frame *frames[] = { soft_draw_anew(&stand, &view), soft_draw_by_gl(&stand, &view) };
    for (int by_gl = 0; by_gl < 2; by_gl++) {
        int least = 255, most = 0;
        for (int y = FIRST; y < LAST; y++) {
            int level = darkest(frames[by_gl], y);
            least = level < least ? level : least;
            most = level > most ? level : most;
        }
        print_message("# beside a pole of 3.6 pixels%s: levels of %d to %d\n", by_gl ? ", by GL" : "", least, most);
        assert_true(most < 210 && most - least <= 35);
        frame_unref(&frames[by_gl]);
    }
    stand_finish(&stand);
    stand = others;
}

/* A refined frame drawn in steps must show the readings of its first step, also where the field is evaluated per pixel,
   although other frames drawn between its steps show newer ones. */
TEST(test_readings_change_between_steps)
{
    struct view view = soft_view(&stand, TIER_REFINED, 160, 90), moving;
    bool done = false;
    view.field.distance = DISTANCE_EUCLIDEAN;
    moving = view;
    moving.tier = TIER_PREVIEW;
    struct frame *expected = test_frame(soft_draw_anew(&stand, &view));
    for (int steps = 0; !done; steps++) {
        struct render_job *job = planned_begin(stand.renderer, &view, stand.snapshot);
        assert_non_null(job);
        for (int i = 0; i < steps && !done; i++)
            done = renderer_step(stand.renderer, job, 0);
        for (int way = 0; way < 2; way++) {
            toy_fill(stand.snapshot, way ? -30 : 20);
            struct frame *between = stand_draw(&stand, &moving);
            frame_unref(&between);
        }
        struct frame *frame = renderer_end(stand.renderer, &job);
        assert_non_null(frame);
        assert_memory_equal(frame->bgrx, expected->bgrx, (size_t)frame->height_px * (size_t)frame->stride_bytes);
        frame_unref(&frame);
        toy_fill(stand.snapshot, 0);
    }
}

/* --- reuse ----------------------------------------------------------------------------------------------------------------------- */

static bool is_quick(const struct view *view)
{
    return planned_is_quick(stand.renderer, view, stand.snapshot);
}

static void assert_same_anew(const struct view *view)
{
    assert_true(is_quick(view));
    struct frame *again = stand_draw(&stand, view), *anew = soft_draw_anew(&stand, view);
    assert_memory_equal(again->bgrx, anew->bgrx, (size_t)again->height_px * (size_t)again->stride_bytes);
    assert_int_equal(again->content, anew->content);
    assert_int_equal(again->label_count, anew->label_count);
    for (size_t i = 0; i < anew->label_count; i++)
        assert_true(again->labels[i].x_px == anew->labels[i].x_px && again->labels[i].value == anew->labels[i].value);
    assert_int_equal(again->marker_count, anew->marker_count);
    for (size_t i = 0; i < anew->marker_count; i++) {
        assert_int_equal(again->markers[i].tag, anew->markers[i].tag);
        assert_int_equal(again->markers[i].occluded, anew->markers[i].occluded);
    }
    frame_unref(&again);
    frame_unref(&anew);
}

TEST(test_new_readings_are_a_new_picture)
{
    struct view view = soft_view(&stand, TIER_REFINED, 501, 300);
    view.selected_asset = 0;
    struct frame *first = test_frame(soft_draw_anew(&stand, &view));
    toy_set(stand.snapshot, 0, 75, QUALITY_GOOD);
    toy_set(stand.snapshot, 3, 20, QUALITY_GOOD);
    assert_same_anew(&view);
    toy_set(stand.snapshot, 3, 20, QUALITY_UNCERTAIN_LAST_USABLE);
    toy_set(stand.snapshot, 6, 45, QUALITY_GOOD);
    assert_same_anew(&view);
    for (int i = 0; i < 8; i++)
        toy_set(stand.snapshot, i, 50, QUALITY_BAD_SENSOR_FAILURE);
    assert_same_anew(&view);
    toy_fill(stand.snapshot, 0);
    struct frame *last = test_frame(stand_draw(&stand, &view));
    assert_memory_equal(first->bgrx, last->bgrx, (size_t)first->height_px * (size_t)first->stride_bytes);
}

/* When readings change, a refined frame is recoloured instead of drawn again. With isolines, their labels, a ghost and a
   section, the result must equal a newly drawn frame. */
TEST(test_lines_again)
{
    struct view view = soft_view(&stand, TIER_REFINED, 501, 300);
    soft_lines_every(&view, 10);
    asset_set_add(&view.visibility.ghosts, 2);
    soft_cut_at(&view, 0, 0, 0, -1, 1.2);
    struct frame *first = test_frame(soft_draw_anew(&stand, &view));
    assert_true(first->label_count > 0);
    toy_set(stand.snapshot, 0, 75, QUALITY_GOOD);
    toy_set(stand.snapshot, 3, 20, QUALITY_UNCERTAIN_LAST_USABLE);
    assert_same_anew(&view);
    view.color_scale.lines[2] += 5;
    assert_same_anew(&view);
    view.color_scale.line_count = 0;
    assert_same_anew(&view);
    soft_lines_every(&view, 20);
    /* the last frame had no isolines, so it cannot just be recoloured to show some */
    assert_false(is_quick(&view));
    toy_fill(stand.snapshot, 0);
}

/* Recolouring frames of the glossy look, in which field colours are mixed with light: the result must equal a newly drawn
   frame. */
TEST(test_glossy_again)
{
    for (int i = 0; i < 4; i++) {
        struct view view = soft_view(&stand, TIER_REFINED, 501, 300);
        stand_look(&stand, 2 * i, &view);
        view.look = LOOK_GLOSSY;
        view.dark = i == 1;
        view.selected_asset = i == 2 ? 0 : -1;
        if (i % 2)
            soft_lines_every(&view, 10);
        if (i == 3)
            soft_cut_at(&view, 0, 0, 0, -1, 1.2);
        struct frame *first = soft_draw_anew(&stand, &view);
        toy_set(stand.snapshot, 0, 75, QUALITY_GOOD);
        toy_set(stand.snapshot, 3, 20, QUALITY_UNCERTAIN_LAST_USABLE);
        toy_set(stand.snapshot, 5, 20, QUALITY_BAD_SENSOR_FAILURE);
        assert_same_anew(&view);
        view.range_min = 10;
        view.color_scale.log = true;
        assert_same_anew(&view);
        view.color_scale.log = false;
        view.range_min = 0;
        toy_fill(stand.snapshot, 0);
        assert_same_anew(&view);
        frame_unref(&first);
    }
}

TEST(test_new_colors_too)
{
    struct view view = soft_view(&stand, TIER_REFINED, 300, 200);
    test_frame(soft_draw_anew(&stand, &view));
    view.colormap = (int)colormap_count(NULL) - 1;
    view.range_min = 30;
    view.range_max = 70;
    assert_same_anew(&view);
    view.color_scale.log = true;
    assert_same_anew(&view);
    toy_set(stand.snapshot, 0, 75, QUALITY_GOOD);
    toy_set(stand.snapshot, 3, 20, QUALITY_UNCERTAIN_LAST_USABLE);
    assert_same_anew(&view);
    toy_fill(stand.snapshot, 0);
}

TEST(test_what_else_changes_is_drawn)
{
    struct view view, other;
    view = soft_view(&stand, TIER_REFINED, 300, 200);
    test_frame(soft_draw_anew(&stand, &view));
    assert_true(is_quick(&view));
    other = view;
    other.camera.eye_m[0] += 0.01;
    assert_false(is_quick(&other));
    other = view;
    other.width_px++;
    assert_false(is_quick(&other));
    other = view;
    other.light_dir[2] = 0.3;
    assert_false(is_quick(&other));
    other = view;
    other.selected_asset = 1;
    assert_false(is_quick(&other));
    other = view;
    asset_set_add(&other.visibility.hidden, 1);
    assert_false(is_quick(&other));
}

/* The cache of large frames is limited, and the oldest frame is evicted. */
TEST(test_few_large_ones_are_kept)
{
    struct view views[4];
    for (int i = 0; i < 4; i++) {
        views[i] = soft_view(&stand, TIER_REFINED, 3000, 2600);
        views[i].camera.eye_m[0] += i;
        struct frame *frame = soft_draw_anew(&stand, &views[i]);
        frame_unref(&frame);
    }
    assert_false(is_quick(&views[0]));
    assert_true(is_quick(&views[2]) && is_quick(&views[3]));
}

int main(void)
{
    return soft_run("soft_refined_test", &rig, &stand, toy_unit);
}
