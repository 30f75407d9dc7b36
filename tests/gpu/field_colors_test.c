/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Field colours: on a flat plate every pixel shows the field's value by the legend's rule. */
#include "tests/support/test.h"

#include "base/color/lab.h"
#include "render/overlay/overlay.h"
#include "render/shaded_colormap.h"
#include "tests/support/no_textures.h"
#include "tests/support/planned.h"
#include "tests/support/stand_case.h"
#include "tests/support/whole_field.h"
#include "value/alarm.h"
#include "value/quality.h"

enum { CELLS = 12, SIDE_PX = 256, PLATE_TAGS = 3 };
static const double side_m = 4;

/* Makes a view from above, x to the right, y upwards, with the plate filling the image. */
static struct view look_down(void)
{
    struct view view;
    view_default(&stand.toy->scene, SIDE_PX, SIDE_PX, &view);
    view.camera = (struct camera){ .eye_m = { side_m / 2, side_m / 2, 10 }, .target_m = { side_m / 2, side_m / 2, 0 }, .up = { 0, 1, 0 } };
    view.camera.fov_deg = 2 * atan(side_m / 2 / 10) * 180 / M_PI;
    view.look = LOOK_FLAT;
    return view;
}

static int set_up(void **state)
{
    static const double sensors[PLATE_TAGS][3] = { { 0, 0, 0 }, { 4, 1, 0 }, { 2, 4, 0 } };
    struct test_shape shape = { 0 };
    struct toy *toy = toy_create();
    (void)state;
    shape_plate(&shape, TOY_STEEL, (double[3]){ 0, 0, 0 }, (double[3]){ side_m, 0, 0 }, (double[3]){ 0, side_m, 0 }, CELLS);
    toy_add(toy, "PLATE", &shape, (double[3]){ 0, 0, 0 }, sensors, PLATE_TAGS);
    stand_init(&stand, &rig, toy);
    toy_set(stand.snapshot, 0, 10, QUALITY_GOOD);
    toy_set(stand.snapshot, 1, 50, QUALITY_GOOD);
    toy_set(stand.snapshot, 2, 95, QUALITY_GOOD);
    return 0;
}

/* Returns the field at a pixel's centre, interpolated from the corners of its triangle. The plate's squares are split along the
   diagonal from (0, 0) to (1, 1). */
static double value_at(const struct scalars *scalars, int x, int y)
{
    double u = (x + 0.5) / SIDE_PX * CELLS, v = (1 - (y + 0.5) / SIDE_PX) * CELLS;
    int column = (int)u, row = (int)v, first = row * (CELLS + 1) + column;
    u -= column;
    v -= row;
    double a = scalars->at[first].value, b = scalars->at[first + (u > v ? 1 : CELLS + 1)].value, c = scalars->at[first + CELLS + 2].value;
    return u > v ? a + u * (b - a) + v * (c - b) : a + v * (b - a) + u * (c - b);
}

/* Returns whether the pixel has the map's colour for this value, give or take rounding. In refined frames, which average
   samples, its channels may differ by up to 4 levels. */
static bool is_color_of(const struct view *view, double value, const uint8_t *bgrx)
{
    struct scale scale;
    view_scale(NULL, view, &scale);
    double slack = 1e-4 * (view->range_max - view->range_min);
    int mix = view->tier == TIER_REFINED ? 4 : 0;
    for (int side = -1; side <= 1; side++) {
        uint8_t rgb[3];
        scale_look_up(&scale, value + side * slack, rgb);
        if (abs(rgb[0] - bgrx[2]) <= mix && abs(rgb[1] - bgrx[1]) <= mix && abs(rgb[2] - bgrx[0]) <= mix)
            return true;
    }
    return false;
}

/* Returns whether an isoline runs through the pixel or within two pixels of it. */
static bool near_line(const struct view *view, const struct scalars *scalars, int x, int y)
{
    double lines[VIEW_ALL_LINES], low = INFINITY, high = -INFINITY;
    int count = view_lines(view, lines);
    for (int i = 0; i < 25; i++) {
        double value = value_at(scalars, x + i % 5 - 2, y + i / 5 - 2);
        low = fmin(low, value);
        high = fmax(high, value);
    }
    for (int i = 0; i < count; i++)
        if (lines[i] >= low && lines[i] <= high)
            return true;
    return false;
}

/* Counts the pixels inside the plate whose colour differs from the legend's colour for their value. */
static int count_wrong(const struct view *view)
{
    const struct scalars *scalars = field_scalars(stand.field, 0, &view->field, stand.snapshot);
    struct frame *frame = stand_draw(&stand, view);
    int wrong = 0;
    for (int y = 2; y < SIDE_PX - 2; y++)
        for (int x = 2; x < SIDE_PX - 2; x++)
            wrong += !near_line(view, scalars, x, y) && !is_color_of(view, value_at(scalars, x, y), frame_pixel(frame, x, y));
    frame_unref(&frame);
    return wrong;
}

TEST_WITH(test_every_pixel_has_the_legends_color, set_up, stand_tear_down)
{
    struct view view = look_down();
    for (int tier = TIER_PREVIEW; tier <= TIER_REFINED; tier++)
        for (int interpolation = INTERPOLATION_SHEPARD; interpolation <= INTERPOLATION_PAPER; interpolation++)
            for (int map = 0; map < (int)colormap_count(NULL); map++) {
                view.tier = (enum tier)tier;
                view.field.interpolation = (enum interpolation)interpolation;
                view.colormap = map;
                assert_int_equal(count_wrong(&view), 0);
            }
}

TEST_WITH(test_bands, set_up, stand_tear_down)
{
    struct view view = look_down();
    for (int tier = TIER_PREVIEW; tier <= TIER_REFINED; tier++) {
        view.tier = (enum tier)tier;
        view.color_scale.break_count = 0;
        for (view.ramp_interval = 10; view.ramp_interval < 80; view.ramp_interval += 13.3)
            assert_int_equal(count_wrong(&view), 0);
        memcpy(view.color_scale.breaks, (double[]){ 20, 22, 60, 90 }, 4 * sizeof(double));
        view.color_scale.break_count = 4;
        assert_int_equal(count_wrong(&view), 0);
    }
}

TEST_WITH(test_logarithmic_scale, set_up, stand_tear_down)
{
    struct view view = look_down();
    view.range_min = 1;
    view.color_scale.log = true;
    for (int tier = TIER_PREVIEW; tier <= TIER_REFINED; tier++) {
        view.tier = (enum tier)tier;
        assert_int_equal(count_wrong(&view), 0);
    }
}

/* Isolines at 30 and 60 darken the pixels where the field has these values, and no others, and are about as wide as specified.
   */
TEST_WITH(test_isolines_run_where_the_value_is, set_up, stand_tear_down)
{
    struct view view = look_down();
    const struct scalars *scalars = field_scalars(stand.field, 0, &view.field, stand.snapshot);
    memcpy(view.color_scale.lines, (double[]){ 30, 60 }, 2 * sizeof(double));
    view.color_scale.line_count = 2;
    for (int tier = TIER_PREVIEW; tier <= TIER_REFINED; tier++) {
        int dark = 0, near = 0;
        view.tier = (enum tier)tier;
        struct frame *frame = stand_draw(&stand, &view);
        for (int y = 4; y < SIDE_PX - 4; y++)
            for (int x = 4; x < SIDE_PX - 4; x++) {
                const uint8_t *pixel = frame_pixel(frame, x, y);
                bool is_dark = pixel[1] < 90;
                near += near_line(&view, scalars, x, y);
                dark += is_dark;
                assert_true(!is_dark || near_line(&view, scalars, x, y));
            }
        assert_true(dark > near / 12 && dark < near / 2); /* an isoline covers one or two of five pixels across */
        frame_unref(&frame);
    }
    view.color_scale.lines[0] = 300; /* an isoline beyond the colour scale's range is not drawn */
    view.color_scale.line_count = 1;
    assert_int_equal(count_wrong(&view), 0);
}

/* The number written on an isoline is the field's value there, whether rendered in one step or progressively. */
TEST_WITH(test_labels_stand_on_their_lines, set_up, stand_tear_down)
{
    struct view view = look_down();
    const struct scalars *scalars = field_scalars(stand.field, 0, &view.field, stand.snapshot);
    memcpy(view.color_scale.lines, (double[]){ 30, 60 }, 2 * sizeof(double));
    view.color_scale.line_count = 2;
    for (int bits = 0; bits < 2; bits++) {
        struct render_job *job = bits ? planned_begin(stand.renderer, &view, stand.snapshot) : NULL;
        struct frame *frame = bits ? renderer_end(stand.renderer, &job) : stand_draw(&stand, &view);
        int of_each[2] = { 0 };
        for (size_t i = 0; i < frame->label_count; i++) {
            const struct frame_label *label = &frame->labels[i];
            assert_true(label->value == 30 || label->value == 60);
            of_each[label->value == 60]++;
            int x = (int)fmin(label->x_px, SIDE_PX - 1), y = (int)fmin(label->y_px, SIDE_PX - 1);
            assert_true(fabs(value_at(scalars, x, y) - label->value) < 2);
        }
        assert_in_range(of_each[0], 1, 8);
        assert_in_range(of_each[1], 1, 8);
        frame_unref(&frame);
    }
    view.color_scale.line_count = 0;
    struct frame *frame = stand_draw(&stand, &view);
    assert_int_equal(frame->label_count, 0);
    frame_unref(&frame);
}

TEST_WITH(test_beyond_the_range_has_its_own_colors, set_up, stand_tear_down)
{
    const struct colormap *map = colormap_at(NULL, 0);
    struct view view = look_down();
    view.range_min = 40;
    view.range_max = 60;
    for (int tier = TIER_PREVIEW; tier <= TIER_REFINED; tier++) {
        view.tier = (enum tier)tier;
        struct frame *frame = stand_draw(&stand, &view);
        const uint8_t *low = frame_pixel(frame, 6, SIDE_PX - 7), *high = frame_pixel(frame, SIDE_PX / 2, 6);
        for (int c = 0; c < 3; c++) {
            assert_int_equal(low[c], map->below[2 - c]);
            assert_int_equal(high[c], map->above[2 - c]);
        }
        frame_unref(&frame);
    }
}

TEST_WITH(test_readings_at_the_ends_stay_on_the_map, set_up, stand_tear_down)
{
    struct view view = look_down();
    for (int end = 0; end < 2; end++) {
        for (int tag = 0; tag < PLATE_TAGS; tag++)
            toy_set(stand.snapshot, tag, end ? 100 : 0, QUALITY_GOOD);
        struct frame *frame = stand_draw(&stand, &view);
        for (int y = 2; y < SIDE_PX - 2; y++)
            for (int x = 2; x < SIDE_PX - 2; x++)
                assert_int_equal(map_index_exact(colormap_at(NULL, 0), frame_pixel(frame, x, y)), end ? 255 : 0);
        frame_unref(&frame);
    }
}

TEST_WITH(test_no_data_is_grey_stripes, set_up, stand_tear_down)
{
    struct view view = look_down();
    for (int tag = 0; tag < PLATE_TAGS; tag++)
        toy_set(stand.snapshot, tag, 0, QUALITY_BAD_SENSOR_FAILURE);
    for (int tier = TIER_PREVIEW; tier <= TIER_REFINED; tier++) {
        view.tier = (enum tier)tier;
        stand_expect_hatched(&view);
    }
}

/* The area around a lost sensor is grey, i.e. shows no value; the other sensors' areas keep their colours. */
TEST_WITH(test_lost_sensor_leaves_its_place_empty, set_up, stand_tear_down)
{
    struct view view = look_down();
    toy_set(stand.snapshot, 2, 95, QUALITY_BAD_SENSOR_FAILURE);
    struct frame *frame = test_frame(stand_draw(&stand, &view));
    for (int y = 4; y < 40; y++)
        for (int x = SIDE_PX / 2 - 30; x < SIDE_PX / 2 + 30; x++)
            assert_true(is_grey(frame_pixel(frame, x, y)));
    assert_true(map_index_exact(colormap_at(NULL, 0), frame_pixel(frame, 6, SIDE_PX - 7)) >= 0);
}

TEST_WITH(test_uncertain_is_stippled, set_up, stand_tear_down)
{
    struct view view = look_down();
    for (int tag = 0; tag < PLATE_TAGS; tag++)
        toy_set(stand.snapshot, tag, 50.2, QUALITY_UNCERTAIN_LAST_USABLE);
    for (int tier = TIER_PREVIEW; tier <= TIER_REFINED; tier++) {
        int map = 0, dots = 0;
        view.tier = (enum tier)tier;
        struct frame *frame = stand_draw(&stand, &view);
        for (int y = 2; y < SIDE_PX - 2; y++)
            for (int x = 2; x < SIDE_PX - 2; x++) {
                map += is_color_of(&view, 50.2, frame_pixel(frame, x, y));
                dots += frame_pixel(frame, x, y)[1] < colormap_at(NULL, 0)->rgb[128][1] / 2 + colormap_uncertain[1] / 2;
            }
        assert_true(map > SIDE_PX * SIDE_PX / 2);
        assert_true(dots > SIDE_PX * SIDE_PX / 10);
        frame_unref(&frame);
    }
}

/* Returns the part, 0 to 1, that the first sensor has in the value at a pixel's centre: its Shepard weight (1 / distance^2)
   divided by all sensors' weights. */
static double part_of_first(int x, int y)
{
    static const double sensors[PLATE_TAGS][2] = { { 0, 0 }, { 4, 1 }, { 2, 4 } };
    double sum = 0, first = 0;
    for (int i = 0; i < PLATE_TAGS; i++) {
        double dx = (x + 0.5) / SIDE_PX * side_m - sensors[i][0], dy = (1 - (y + 0.5) / SIDE_PX) * side_m - sensors[i][1];
        double weight = 1 / (dx * dx + dy * dy);
        sum += weight;
        first += i == 0 ? weight : 0;
    }
    return first / sum;
}

/* The border between certain and uncertain areas crosses the triangles where the weights say, and does not follow triangle
   edges, although a triangle is a twelfth of the plate wide. */
TEST_WITH(test_the_rim_of_the_uncertain_runs_true, set_up, stand_tear_down)
{
    const double slack = 0.02;
    struct view view = look_down();
    toy_set(stand.snapshot, 0, 50.2, QUALITY_UNCERTAIN_LAST_USABLE);
    for (int i = 1; i < PLATE_TAGS; i++)
        toy_set(stand.snapshot, i, 50.2, QUALITY_GOOD);
    view.field.distance = DISTANCE_EUCLIDEAN;
    for (int tier = TIER_PREVIEW; tier <= TIER_REFINED; tier++) {
        int near_rim = 0;
        view.tier = (enum tier)tier;
        struct frame *frame = stand_draw(&stand, &view);
        for (int y = 2; y < SIDE_PX - 2; y++)
            for (int x = 2; x < SIDE_PX - 2; x++) {
                bool dot = !is_color_of(&view, 50.2, frame_pixel(frame, x, y));
                assert_true(!dot || part_of_first(x, y) > 0.5 - slack);
                near_rim += dot && part_of_first(x, y) < 0.5 + slack;
            }
        assert_true(near_rim > SIDE_PX / 8);
        frame_unref(&frame);
    }
}

/* Returns whether the pixel has the colour of alarms of priority 3, a magenta that no colour of the field resembles. */
static bool is_alarm_color(const uint8_t *bgrx)
{
    return bgrx[2] > 150 && bgrx[2] - bgrx[1] > 80 && bgrx[0] > 130;
}

static int count_alarm_colors(const struct frame *frame)
{
    int count = 0;
    for (int i = 0; i < frame->width_px * frame->height_px; i++)
        count += is_alarm_color(frame_pixel(frame, i % frame->width_px, i / frame->width_px));
    return count;
}

/* The image is wide enough for the legend to be beside the plate, and the plate's whole rim is visible. */
static void check_alarms(const struct view *view)
{
    struct view wide = *view;
    wide.width_px = 800;
    wide.height_px = 400;
    wide.camera.eye_m[2] = 14;
    for (int alarm = 0; alarm < 2; alarm++) {
        toy_set(stand.snapshot, 1, alarm ? 80 : 69, QUALITY_GOOD);
        alarm_by_limits(&stand.toy->plant, stand.snapshot);
        struct frame *frame = stand_draw(&stand, &wide);
        assert_int_equal(count_alarm_colors(frame), 0);
        frame_read_markers(frame, stand.snapshot, NULL);
        overlay_draw(frame, &stand.toy->scene, stand.snapshot, NULL);
        int x0 = 400 + (int)(200 * 10 / 14.0), y0 = 200 + (int)(100 * 10 / 14.0), around = 0, left = 0;
        for (int y = 0; y < 400; y++)
            for (int x = 0; x < 600; x++) { /* excludes the legend, which lies to the right of column 600 */
                bool near = hypot(x - x0, y - y0) < 14;
                around += near && is_alarm_color(frame_pixel(frame, x, y));
                left += !near && is_alarm_color(frame_pixel(frame, x, y));
            }
        assert_true(alarm ? around > 40 : around == 0);
        assert_int_equal(left, 0);
        frame_unref(&frame);
    }
}

TEST_WITH(test_operator_sees_limits, set_up, stand_tear_down)
{
    struct view view = look_down();
    for (int tag = 0; tag < PLATE_TAGS; tag++)
        memcpy(stand.toy->plant.tags[tag].alarms.limits, (double[]){ 0, 20, 70, 90 }, 4 * sizeof(double));
    for (int i = 0; i < LIMIT_COUNT; i++)
        stand.toy->plant.tags[2].alarms.limits[i] = NAN;
    toy_set(stand.snapshot, 0, 45, QUALITY_GOOD);
    toy_set(stand.snapshot, 1, 80, QUALITY_GOOD); /* tag 1 reads 80, above its limit H of 70 */
    view.field.show = SHOW_OPERATOR;
    view_default_scale(&stand.toy->scene, &view);
    for (int tier = TIER_PREVIEW; tier <= TIER_REFINED; tier++) {
        view.tier = (enum tier)tier;
        struct frame *frame = stand_draw(&stand, &view);
        const uint8_t *within = frame_pixel(frame, 6, SIDE_PX - 7), *beyond = frame_pixel(frame, SIDE_PX - 4, SIDE_PX * 3 / 4);
        const uint8_t *without = frame_pixel(frame, SIDE_PX / 2, 6);
        assert_true(is_grey(within) && within[0] > 180);
        /* expects the colour for values beyond H: sand, in which red exceeds blue a little */
        assert_true(beyond[2] - beyond[0] > 20 && beyond[2] - beyond[0] < 80);
        assert_true(is_grey(without) && without[0] <= colormap_no_limits[0][0] && without[0] >= colormap_no_limits[1][0]);
        frame_unref(&frame);
    }
    check_alarms(&view);
}

/* When distances are shown, each marker shows its sensor's distance from the selected sensor 1. On a flat plate the distance
   along the surface equals the straight line. */
TEST_WITH(test_markers_tell_distances, set_up, stand_tear_down)
{
    const double want_m[PLATE_TAGS] = { hypot(4, 1), 0, hypot(2, 3) };
    struct view view = look_down();
    view.camera.eye_m[2] = 14;
    view.field.show = SHOW_DISTANCE;
    view.field.sensor = 1;
    for (int mode = DISTANCE_GEODESIC; mode <= DISTANCE_EUCLIDEAN; mode++)
        for (int tier = TIER_PREVIEW; tier <= TIER_REFINED; tier++) {
            view.field.distance = (enum distance_mode)mode;
            view.tier = (enum tier)tier;
            view_default_scale(&stand.toy->scene, &view);
            struct frame *frame = stand_draw(&stand, &view);
            frame_read_markers(frame, stand.snapshot, NULL);
            assert_int_equal(frame->marker_count, PLATE_TAGS);
            for (int i = 0; i < PLATE_TAGS; i++)
                assert_true(fabs(frame->markers[i].value - want_m[frame->markers[i].tag]) <= (mode == DISTANCE_GEODESIC ? 0.08 : 1e-6));
            frame_unref(&frame);
        }
}

/* Frames state an unsynchronised clock next to the time. */
TEST_WITH(test_a_clock_that_is_not_set_is_said, set_up, stand_tear_down)
{
    struct view view;
    int differ = 0;
    view = look_down();
    view.width_px = 800;
    struct frame *set = test_frame(stand_draw(&stand, &view)), *unset = test_frame(stand_draw(&stand, &view));
    unset->clock_unset = true;
    overlay_draw(set, &stand.toy->scene, stand.snapshot, NULL);
    overlay_draw(unset, &stand.toy->scene, stand.snapshot, NULL);
    for (int y = 0; y < SIDE_PX; y++)
        for (int x = 0; x < 800; x++) {
            bool differs = memcmp(frame_pixel(set, x, y), frame_pixel(unset, x, y), 3) != 0;
            differ += differs;
            assert_true(!differs || y < 50);
        }
    assert_true(differ > 1000);
}

/* Once one tag has passed its loop check, markers and legend show which tags have not; the rest of the frame stays the same. */
TEST_WITH(test_unproven_tags_are_marked, set_up, stand_tear_down)
{
    enum { WIDE_PX = 600 };
    struct view view;
    char *folder = temp_folder();
    struct plant *plant = &stand.toy->plant;
    struct plant_source source = { .id = (char[]){ "plc" } };
    int by_name[PLATE_TAGS] = { 0, 1, 2 }, differ[PLATE_TAGS] = { 0 };
    plant->tags_by_name = by_name;
    plant->sources = &source;
    for (int i = 0; i < PLATE_TAGS; i++)
        plant->tags[i].source = 0;
    struct loop_checks *loop_checks = loop_checks_open(rig.log, plant, folder, NULL);
    view = look_down();
    view.camera.eye_m[2] = 14;
    view.width_px = view.height_px = WIDE_PX;
    struct frame *plain = test_frame(stand_draw(&stand, &view)), *before = stand_draw(&stand, &view), *begun = stand_draw(&stand, &view);
    overlay_draw(plain, &stand.toy->scene, stand.snapshot, NULL);
    overlay_draw(before, &stand.toy->scene, stand.snapshot, loop_checks);
    /* as long as no tag was checked, the frame is the same as without loop checks: no marker shows whether its tag was checked
       */
    assert_memory_equal(plain->bgrx, before->bgrx, (size_t)WIDE_PX * (size_t)plain->stride_bytes);
    assert_null(
        loop_checks_add(loop_checks, 0, &(struct loop_check){ .state = LOOP_CHECK_PASSED, .value = 10, .expected = 10, .tolerance = 1 }));
    overlay_draw(begun, &stand.toy->scene, stand.snapshot, loop_checks);
    for (size_t i = 0; i < begun->marker_count; i++)
        for (int y = -6; y <= 6; y++)
            for (int x = -6; x <= 6; x++) {
                int px = (int)lround((double)begun->markers[i].x_px) + x, py = (int)lround((double)begun->markers[i].y_px) + y;
                differ[begun->markers[i].tag] += memcmp(frame_pixel(plain, px, py), frame_pixel(begun, px, py), 3) != 0;
            }
    assert_int_equal(differ[0], 0);
    assert_true(differ[1] > 4 && differ[2] > 4);
    frame_unref(&before);
    frame_unref(&begun);
    loop_checks_close(&loop_checks);
    plant->tags_by_name = NULL;
    plant->sources = NULL;
    for (int i = 0; i < PLATE_TAGS; i++)
        plant->tags[i].source = -1;
}

TEST_WITH(test_default_look_keeps_to_the_palette, set_up, stand_tear_down)
{
    struct view view = look_down();
    view.look = LOOK_DEFAULT;
    view.ramp_interval = 200; /* bands of 200 units: the whole range is one band of one colour, so pixels may differ in lightness only */
    uint8_t rgb[3], shaded[3];
    memcpy(rgb, colormap_at(NULL, 0)->rgb[128], 3);
    for (int tier = TIER_PREVIEW; tier <= TIER_REFINED; tier++) {
        view.tier = (enum tier)tier;
        struct frame *frame = stand_draw(&stand, &view);
        const uint8_t *pixel = frame_pixel(frame, SIDE_PX / 2, SIDE_PX / 2);
        bool found = false;
        for (int row = 0; row < COLORMAP_ROWS; row++) {
            lab_shade(rgb, colormap_at(NULL, 0)->shading * (2.0 * row / (COLORMAP_ROWS - 1) - 1), shaded);
            found = found || (shaded[0] == pixel[2] && shaded[1] == pixel[1] && shaded[2] == pixel[0]);
        }
        assert_true(found);
        frame_unref(&frame);
    }
}

/* Materials of a model without sensors ("context") must not look like values: here they have colours of the map, and no picture
   that shows a field may contain one of these colours. */
TEST_WITH(test_context_has_no_color, set_up, stand_tear_down)
{
    enum { STRIPS = 16 };
    static const double low[3] = { 0, 0, 0 };
    struct asset_material materials[STRIPS];
    struct test_shape shape = { .materials = materials, .material_count = STRIPS };
    struct toy *toy = toy_create();
    struct view view;
    for (uint32_t i = 0; i < STRIPS; i++) {
        const uint8_t *rgb = colormap_at(NULL, 0)->rgb[i * 255 / (STRIPS - 1)];
        materials[i] = (struct asset_material){ .base_color = { rgb[0] / 255.0f, rgb[1] / 255.0f, rgb[2] / 255.0f, 1 },
                                                .roughness = 0.7f,
                                                .normal_scale = 1,
                                                .occlusion_strength = 1,
                                                NO_TEXTURES };
        shape_plate(&shape, i, (double[3]){ side_m * i / STRIPS, 0, 0 }, (double[3]){ side_m / STRIPS, 0, 0 }, (double[3]){ 0, side_m, 0 },
                    2);
    }
    stand_tear_down(NULL);
    toy_add(toy, "STEEL", &shape, low, NULL, 0);
    stand_init(&stand, &rig, toy);
    view = look_down();
    for (int by_gl = 0; by_gl <= 1; by_gl++)
        for (int tier = TIER_PREVIEW; tier <= TIER_REFINED; tier++)
            for (int look = LOOK_DEFAULT; look <= LOOK_FLAT; look++) {
                view.tier = (enum tier)tier;
                view.look = (enum look)look;
                renderer_use_gl(stand.renderer, by_gl);
                struct frame *frame = stand_draw(&stand, &view);
                int coloured = 0;
                for (int i = 0; i < SIDE_PX * SIDE_PX; i++) {
                    const uint8_t *c = frame_pixel(frame, i % SIDE_PX, i / SIDE_PX);
                    coloured += abs(c[0] - c[1]) > 2 || abs(c[1] - c[2]) > 2;
                }
                assert_int_equal(coloured, 0);
                frame_unref(&frame);
            }
}
