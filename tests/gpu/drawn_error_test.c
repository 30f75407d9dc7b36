/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Triangles that are too long to show the field exactly, because values are interpolated linearly between their corners. Picks
   and pixels are compared with plain sums over all sensors in double precision. Each pick must be within one colour step, and
   each pixel too, unless it is marked uncertain. With straight-line distances each pixel must be exact and unmarked. */
#include "tests/support/test.h"
#include <unistd.h>

#include "message/marker_text.h"
#include "render/pick/pick.h"
#include "scene/scene_create.h"
#include "tests/support/planned.h"
#include "tests/support/prep_case.h"
#include "tests/support/renderer_compare.h"
#include "tests/support/rig_case.h"
#include "tests/support/synthetic.h"
#include "value/quality.h"

#define FOUND "../shared/data/found/long_part/"
enum { WIDTH_PX = 480, HEIGHT_PX = 270, PIXELS = WIDTH_PX * HEIGHT_PX, PICKS = 1500, NEEDLES = 60, CELLS = 90 };
enum { SENSORS = 6, MANY = 12, CROWD = 200 };
/* SNAP_PX: rasterizers round triangle corners to 1/256 pixel, so a pixel shows a point up to about that far away */
static const double STEP = 1.0 / 255, STEEP = 10 * STEP, SIDE_M = 4, SNAP_PX = 1.0 / 256;
/* MOST_SQUARE: asset files store distances with a relative error of at most 2^-12 (distance_code.h), so the error of their squares
   is at most twice as large; plus 1 % for float arithmetic */
static const double MOST_SQUARE = 1.01 * 0x1p-11;
static uint64_t random_state;

struct drawn_error_case {
    const struct scene *scene;
    struct field *field;
    struct renderer *renderer;
    struct snapshot *snapshot;
};
struct drawn_error_tally {
    int compared, marked, marked_right, no_data, other;
    double worst_pick, worst_drawn;    /* largest error of picks, and of pixels that are not marked uncertain, as shares of the range */
    /* worst_marked: largest error of marked pixels; worst_beyond: largest excess of an error over pick.drawn_error, negative if
       that is always an upper bound */
    double worst_marked, worst_beyond;
    /* largest difference between the values of pixel_field_at() and of picks, as a share of the range */
    double worst_evaluated;
    /* largest error of unmarked pixels after subtracting how much the true value changes within SNAP_PX */
    double worst_placed;
    double worst_away_m; /* largest error of the distances to sensors that picks state */
    /* largest error of the squares of these distances, relative to the mean square of the corners' distances to the sensor */
    double worst_square;
    /* soft: number of pixels of the software renderer that were compared; soft_off: those with another colour; flags_off:
       number of picks whose flags differ from those of pixel_field_at() */
    int soft, soft_off, flags_off;
};

/* number of elements of the arrays for which there is no memory; 0: there is memory for all */
static size_t missing_elements;
void *__real_mem_try_array(size_t count, size_t bytes_each);
void *__wrap_mem_try_array(size_t count, size_t bytes_each);

void *__wrap_mem_try_array(size_t count, size_t bytes_each)
{
    return missing_elements > 0 && count == missing_elements ? NULL : __real_mem_try_array(count, bytes_each);
}

static double between(double low, double high)
{
    return low + (high - low) * synthetic_random_unit(&random_state);
}

/* --- the plain sum ---------------------------------------------------------------------------------------------------------- */

static double weight_of(const struct view *view, double distance_m, double radius_m, double *term)
{
    if (view->field.interpolation == INTERPOLATION_SHEPARD) {
        const double reach_m = view->field.reach_m, left = reach_m < INFINITY ? fmax(1 - distance_m / reach_m, 0) : 1;
        return *term = pow(fmax(distance_m, 1e-12), -view->field.power) * left * left;
    }
    double near = fmax(0, 1 - distance_m / radius_m), weight = exp(near);
    *term = weight * near;
    return weight;
}

/* Returns the true value at the picked point, computed with straight-line distances to all sensors; NAN: no data there. */
static double truth_at(const struct drawn_error_case *site, const struct view *view, const struct pick *pick)
{
    const struct scene_asset *asset = &site->scene->assets[pick->asset];
    const struct plant_group *group = &site->scene->plant->groups[view->field.group];
    double sum = 0, total = 0, nearest_m = INFINITY;
    bool lost = false;
    for (size_t i = 0; i < asset->sensor_count; i++) {
        const struct reading *reading = &site->snapshot->readings[asset->sensors[i].tag];
        double away = 0, term, value = reading->value;
        for (int c = 0; c < 3; c++)
            away += pow(pick->position_m[c] - asset->sensors[i].surface_m[c], 2);
        away = sqrt(away);
        bool bad = quality_is_bad(reading->quality);
        if (away < nearest_m) {
            nearest_m = away;
            lost = bad;
        }
        if (bad)
            continue;
        if (view->field.interpolation == INTERPOLATION_PAPER)
            value = fmin(fmax((value - group->min) / (group->max - group->min), 0), 1);
        total += weight_of(view, away, view->field.radius_m, &term);
        sum += value * term;
    }
    double value = sum / total;
    if (view->field.interpolation == INTERPOLATION_PAPER)
        value = group->min + value * (group->max - group->min);
    return lost ? (double)NAN : value;
}

/* --- comparing -------------------------------------------------------------------------------------------------------------- */

/* Compares a pick with the value that pixel_field_at() computes from the inputs that renderers get for each pixel. */
static void compare_evaluated(const struct drawn_error_case *site, const struct view *view, const struct pick *pick,
                              struct drawn_error_tally *tally)
{
    struct pixel_field pixels;
    struct pixel_value value;
    const float at_m[3] = { (float)pick->position_m[0], (float)pick->position_m[1], (float)pick->position_m[2] };
    field_pixels(site->field, pick->asset, &view->field, &pixels);
    if (pixels.count == 0)
        return;
    pixel_field_at(&pixels, at_m, &value);
    tally->flags_off += value.no_data != (pick->state == PICK_NO_DATA);
    tally->worst_evaluated = fmax(tally->worst_evaluated, fabs((double)value.value - pick->value) / (view->range_max - view->range_min));
    pixel_field_finish(&pixels);
}

/* Tallies the errors of the distances to sensors that a pick states. A geodesic distance is computed from those of the triangle's
   corners to the sensor: its square is their weighted mean square, less the corners' mean square distance from the picked point.
   The latter is at most that in the middle of a needle, (SIDE_M / 2)^2. */
static void compare_distances(const struct drawn_error_case *site, const struct pick *pick, struct drawn_error_tally *tally)
{
    const struct scene_asset *asset = &site->scene->assets[pick->asset];
    for (size_t i = 0; i < asset->sensor_count; i++) {
        double away_m = 0;
        for (int c = 0; c < 3; c++)
            away_m = hypot(away_m, pick->position_m[c] - asset->sensors[i].surface_m[c]);
        for (int n = 0; n < pick->nearest_count; n++) {
            double stated_m = pick->nearest[n].distance_m, mean_m2 = away_m * away_m + SIDE_M * SIDE_M / 4;
            if (pick->nearest[n].tag != asset->sensors[i].tag)
                continue;
            tally->worst_away_m = fmax(tally->worst_away_m, fabs(stated_m - away_m));
            tally->worst_square = fmax(tally->worst_square, fabs(stated_m * stated_m - away_m * away_m) / mean_m2);
        }
    }
}

/* Returns the largest change of the true value, as a share of the range, between a pixel's centre and points SNAP_PX away. */
static double change_around(const struct drawn_error_case *site, const struct view *view, int x, int y, double truth)
{
    double most = 0;
    for (int i = 0; i < 4; i++) {
        struct pick pick;
        double right = x + 0.5 + (i % 2 ? SNAP_PX : -SNAP_PX), down = y + 0.5 + (i / 2 ? SNAP_PX : -SNAP_PX);
        pick_at(site->scene, site->field, view, site->snapshot, right, down, &pick);
        if (pick.asset >= 0 && pick.state != PICK_CONTEXT)
            most = fmax(most, fabs(truth_at(site, view, &pick) - truth));
    }
    return most / (view->range_max - view->range_min);
}

static void compare_pixel(const struct drawn_error_case *site, const struct view *view, const float pixel[4], int x, int y,
                          struct drawn_error_tally *tally)
{
    double range = view->range_max - view->range_min;
    struct pick pick;
    pick_at(site->scene, site->field, view, site->snapshot, x + 0.5, y + 0.5, &pick);
    if (pick.asset < 0 || pick.state == PICK_CONTEXT || pixel[1] < 0) {
        tally->other++;
        return;
    }
    double truth = truth_at(site, view, &pick);
    if (isnan(truth) || pick.state == PICK_NO_DATA) {
        tally->no_data++;
        tally->other += isnan(truth) != (pick.state == PICK_NO_DATA);
        return;
    }
    compare_evaluated(site, view, &pick, tally);
    compare_distances(site, &pick, tally);
    double drawn = fabs((double)pixel[0] - (truth - view->range_min) / range);
    bool marked = pixel[2] > 0.5f || pixel[1] > 0.5f;
    tally->compared++;
    tally->marked += marked;
    tally->marked_right += marked && drawn <= STEP;
    if (marked) {
        tally->worst_marked = fmax(tally->worst_marked, drawn);
    } else {
        double allowed = drawn > 0.1 * STEP ? change_around(site, view, x, y, truth) : 0;
        tally->worst_drawn = fmax(tally->worst_drawn, drawn);
        tally->worst_placed = fmax(tally->worst_placed, drawn - allowed);
        tally->worst_pick = fmax(tally->worst_pick, fabs(pick.value - truth) / range);
    }
    if (pick.drawn_error > 0)
        tally->worst_beyond = fmax(tally->worst_beyond, drawn - pick.drawn_error / range);
}

/* Returns whether the pixel and its eight neighbours have data and show one flat surface, judged by their depths, without a
   jump of the value. */
static bool is_within(const float (*measured)[4], int x, int y)
{
    if (x < 1 || y < 1 || x + 1 >= WIDTH_PX || y + 1 >= HEIGHT_PX)
        return false;
    for (int i = 0; i < 9; i++)
        if (measured[(y + i / 3 - 1) * WIDTH_PX + x + i % 3 - 1][1] != 0)
            return false;
    for (int i = 1; i <= WIDTH_PX; i += WIDTH_PX - 1) {
        const float(*at)[4] = &measured[y * WIDTH_PX + x];
        if (fabs((double)(at[-i][3] + at[i][3] - 2 * at[0][3])) > 0.002 * (double)at[0][3])
            return false;
        if (fabs((double)(at[-i][0] - at[0][0])) > STEEP || fabs((double)(at[i][0] - at[0][0])) > STEEP)
            return false;
    }
    return true;
}

/* Draws a preview and a refined picture with the software renderer, and compares the colours with the values that GL measured.
   */
static void compare_soft(const struct drawn_error_case *site, const struct view *view, const float (*measured)[4],
                         struct drawn_error_tally *tally)
{
    for (int tier = TIER_PREVIEW; tier <= TIER_REFINED; tier++) {
        struct view flat = *view;
        flat.look = LOOK_FLAT;
        flat.tier = tier;
        struct frame *frame = split_view_draw_now(site->renderer, &flat, site->snapshot);
        assert_non_null(frame);
        for (int y = 0; y < HEIGHT_PX; y++)
            for (int x = 0; x < WIDTH_PX; x++) {
                const float *number = measured[y * WIDTH_PX + x];
                if (!is_within(measured, x, y) || number[2] > 0.5f)
                    continue;
                int off = map_colors_off(colormap_at(NULL, (size_t)flat.colormap), frame_pixel(frame, x, y), (double)number[0]);
                tally->soft += off >= 0;
                tally->soft_off += off > 1;
            }
        frame_unref(&frame);
    }
}

/* Chooses a random camera above the scene that roughly fills the image. */
static void look(const struct scene *scene, struct view *view)
{
    double forward[3] = { between(-1, 1), between(-1, 1), between(-2, -0.5) }, nearer = between(0.4, 1);
    camera_fit_along(&view->camera, forward, scene->bounds_min_m, scene->bounds_max_m, (double)WIDTH_PX / HEIGHT_PX,
                     &(struct camera_window){ 0 });
    for (int c = 0; c < 3; c++)
        view->camera.eye_m[c] = view->camera.target_m[c] + nearer * (view->camera.eye_m[c] - view->camera.target_m[c]);
}

static void compare_view(const struct drawn_error_case *site, const struct view *view, struct drawn_error_tally *tally)
{
    float(*measured)[4] = mem_array(PIXELS, sizeof(*measured));
    assert_true(renderer_measure(site->renderer, view, site->snapshot, true, measured));
    compare_soft(site, view, (const float(*)[4])measured, tally);
    for (int i = 0; i < PICKS; i++) {
        int x = (int)between(0, WIDTH_PX), y = (int)between(0, HEIGHT_PX);
        compare_pixel(site, view, measured[y * WIDTH_PX + x], x, y, tally);
    }
    mem_free(measured);
}

/* Compares five views: Shepard interpolation with a low power, with two high ones, and with the low power in a section box around
   half of the plant; and the interpolation of the paper. In the toy plant, distances along the surface equal straight-line
   distances. */
static void compare(const struct drawn_error_case *site, enum distance_mode distance, struct drawn_error_tally *tally)
{
    static const double powers[] = { 2, 6, 0, 16, 2 };
    for (int way = 0; way < 5; way++) {
        struct view view;
        view_default(site->scene, WIDTH_PX, HEIGHT_PX, &view);
        view.tier = TIER_PREVIEW;
        view.field.distance = distance;
        if (powers[way] > 0)
            view.field.power = powers[way];
        else
            view.field.interpolation = INTERPOLATION_PAPER, view.field.radius_m = 1.5;
        look(site->scene, &view);
        if (way == 4) {
            double far_m[3];
            memcpy(far_m, site->scene->bounds_max_m, sizeof(far_m));
            far_m[0] = 0.5 * (site->scene->bounds_min_m[0] + far_m[0]);
            clip_box(&view.visibility.clip, site->scene->bounds_min_m, far_m);
        }
        compare_view(site, &view, tally);
    }
}

static void expect_truth(const char *name, const struct drawn_error_tally *tally)
{
    print_message("# %s: %d pixels, %d without data, %d others; picks off by %.2f steps at most, unmarked pixels by %.2f, marked by %.1f; "
                  "marked %d, %d of them right\n",
                  name, tally->compared, tally->no_data, tally->other, tally->worst_pick / STEP, tally->worst_drawn / STEP,
                  tally->worst_marked / STEP, tally->marked, tally->marked_right);
    print_message(
        "# beyond the bound that picks tell: %.2f steps; without a GPU %d pixels, %d of another colour; distances off by %.6f m, "
        "their squares by %.3f of the limit\n",
        tally->worst_beyond / STEP, tally->soft, tally->soft_off, tally->worst_away_m, tally->worst_square / MOST_SQUARE);
    assert_true(tally->compared > 500);
    assert_true(tally->worst_pick <= STEP);
    /* the limit is 2 % above one colour step, because a pixel's value is a float and belongs to a slightly different point than
       the pick's value */
    assert_true(tally->worst_drawn <= 1.02 * STEP);
    assert_true(tally->worst_beyond <= 0.1 * STEP);
    assert_true(tally->worst_square <= MOST_SQUARE);
}

/* With straight-line distances the value is computed exactly for each pixel, so no pixel may be marked uncertain. */
static void expect_exact(const char *name, const struct drawn_error_tally *tally)
{
    expect_truth(name, tally);
    print_message("# evaluated off by %.4f steps, %.4f more than the place explains; %d flags\n", tally->worst_evaluated / STEP,
                  tally->worst_placed / STEP, tally->flags_off);
    assert_int_equal(tally->marked, 0);
    assert_int_equal(tally->flags_off, 0);
    assert_true(tally->worst_away_m <= 1e-5);
    /* The software renderer's surface points are slightly inaccurate. One pixel in a thousand may differ, because with high
       powers the field changes strongly within a pixel. A GPU's refined picture shows the mean colour of a pixel's samples. */
    assert_true(tally->soft > 500 && tally->soft_off <= (rig.gl->software ? 0.001 : 0.005) * tally->soft);
    assert_true(tally->worst_evaluated <= 0.02 * STEP && tally->worst_placed <= 0.25 * STEP);
}

/* --- needles ---------------------------------------------------------------------------------------------------------------- */

/* Makes a square plate in the plane z = 0. From x = 0 to end_m it consists of NEEDLES strips across the whole plate, each of
   two long triangles (needles), beyond of small triangles. Adds a small box at each of the `sensors` places. */
static void make_plate(struct test_shape *shape, double end_m, int sensors, double (*places)[3])
{
    double low = 0;
    for (int i = 0; i < NEEDLES; i++) {
        double high = i + 1 == NEEDLES ? end_m : low + (end_m - low) * between(0.2, 1.8) / (NEEDLES - i);
        shape_plate(shape, TOY_STEEL, (double[3]){ low, 0, 0 }, (double[3]){ high - low, 0, 0 }, (double[3]){ 0, SIDE_M, 0 }, 1);
        low = high;
    }
    if (end_m < SIDE_M)
        shape_plate(shape, TOY_STEEL, (double[3]){ end_m, 0, 0 }, (double[3]){ SIDE_M - end_m, 0, 0 }, (double[3]){ 0, SIDE_M, 0 }, CELLS);
    for (int i = 0; i < sensors; i++) {
        double x = between(0.2, SIDE_M - 0.2), y = between(0.2, SIDE_M - 0.2);
        memcpy(places[i], (double[3]){ x, y, between(0.01, 0.1) }, sizeof(places[i]));
        shape_box(shape, TOY_BLUE, (double[3]){ x - 0.01, y - 0.01, places[i][2] - 0.005 },
                  (double[3]){ x + 0.01, y + 0.01, places[i][2] + 0.005 });
    }
}

static void fill(struct snapshot *snapshot, int sensors, int round)
{
    for (int i = 0; i < sensors; i++)
        toy_set(snapshot, i, between(0, 100), round % 2 == 1 && i == 1 ? QUALITY_BAD_COMMUNICATION_ERROR : QUALITY_GOOD);
}

static void tally_plates(double end_m, int sensors, enum distance_mode distance, struct drawn_error_tally *tally)
{
    *tally = (struct drawn_error_tally){ .worst_beyond = -1 };
    random_state = sweep_seed();
    for (int round = 0; round < sweep(12, sensors > MANY ? 1 : 2); round++) {
        struct toy *toy = toy_create();
        struct test_shape shape = { 0 };
        struct stand stand;
        double places[CROWD][3];
        make_plate(&shape, end_m, sensors, places);
        toy_add(toy, "PLATE", &shape, (double[3]){ 0, 0, 0 }, (const double(*)[3])places, (size_t)sensors);
        toy->scene.assets[0].file->resolved_levels = 0;
        stand_init(&stand, &rig, toy);
        fill(stand.snapshot, sensors, round);
        struct drawn_error_case site = { &toy->scene, stand.field, stand.renderer, stand.snapshot };
        compare(&site, distance, tally);
        stand_finish(&stand);
    }
}

TEST(test_needles)
{
    struct drawn_error_tally tally;
    tally_plates(SIDE_M, MANY, DISTANCE_GEODESIC, &tally);
    expect_truth("needles", &tally);
    /* more than a quarter of the pixels is marked uncertain, and some of them are really off by more than a colour step */
    assert_true(tally.marked > tally.compared / 4 && tally.worst_marked > STEP);
}

/* One half of the plate consists of needles, the other of small triangles. Only pixels of needles may be marked uncertain,
   because only they show the field inexactly. */
TEST(test_half_of_needles)
{
    struct drawn_error_tally tally;
    tally_plates(SIDE_M / 2, MANY, DISTANCE_GEODESIC, &tally);
    expect_truth("half of needles", &tally);
    assert_true(tally.compared - tally.marked > tally.compared / 4 && tally.marked > tally.compared / 4);
    assert_true(tally.marked_right < tally.marked / 3);
}

/* With many sensors, not all triangles are sampled (MOST_SAMPLES in drawn_error.c). The others are marked, too. */
TEST(test_triangles_without_samples_are_marked)
{
    struct drawn_error_tally tally;
    tally_plates(SIDE_M / 2, CROWD, DISTANCE_GEODESIC, &tally);
    expect_truth("half of needles, 200 sensors", &tally);
}

/* Near the middle of a plate of small triangles, one sensor is near, and the others are at the ends of their reach. */
TEST(test_ends_of_reaches_are_marked)
{
    static const double powers[] = { 0.5, 1, 2 };
    enum { RING = 40 };
    const double reach_m = 1.5;
    random_state = sweep_seed();
    for (size_t i = 0; i < sizeof(powers) / sizeof(*powers); i++) {
        struct drawn_error_tally tally = { .worst_beyond = -1 };
        struct toy *toy = toy_create();
        struct test_shape shape = { 0 };
        struct stand stand;
        struct view view;
        double places[RING][3] = { { SIDE_M / 2 + reach_m / 2, SIDE_M / 2, 0 } };
        for (int s = 1; s < RING; s++) {
            const double angle = between(-M_PI, M_PI), away_m = reach_m * between(0.95, 1.05);
            memcpy(places[s], (double[3]){ SIDE_M / 2 + away_m * cos(angle), SIDE_M / 2 + away_m * sin(angle), 0 }, sizeof(places[s]));
        }
        shape_plate(&shape, TOY_STEEL, (double[3]){ 0 }, (double[3]){ SIDE_M, 0, 0 }, (double[3]){ 0, SIDE_M, 0 }, CELLS);
        toy_add(toy, "PLATE", &shape, (double[3]){ 0, 0, 0 }, (const double(*)[3])places, RING);
        toy->scene.assets[0].file->resolved_levels = 0;
        stand_init(&stand, &rig, toy);
        for (int s = 0; s < RING; s++)
            toy_set(stand.snapshot, s, s ? 100 : 0, QUALITY_GOOD);
        view_default(&toy->scene, WIDTH_PX, HEIGHT_PX, &view);
        view.tier = TIER_PREVIEW;
        view.field.distance = DISTANCE_GEODESIC;
        view.field.power = powers[i];
        view.field.reach_m = reach_m;
        look(&toy->scene, &view);
        compare_view(&(struct drawn_error_case){ &toy->scene, stand.field, stand.renderer, stand.snapshot }, &view, &tally);
        stand_finish(&stand);
        expect_truth(test_printf("ends of reaches, power %g", powers[i]), &tally);
    }
}

/* Sets up a plant with one plate of needles and MANY sensors. resolved_levels: bit i tells the renderer that preparation has
   subdivided level i until it shows the field exactly. */
static void stand_on_plate(struct stand *stand, struct view *view, uint64_t resolved_levels)
{
    struct toy *toy = toy_create();
    struct test_shape shape = { 0 };
    double places[MANY][3];
    random_state = sweep_seed();
    make_plate(&shape, SIDE_M, MANY, places);
    toy_add(toy, "PLATE", &shape, (double[3]){ 0, 0, 0 }, (const double(*)[3])places, MANY);
    toy->scene.assets[0].file->resolved_levels = resolved_levels;
    stand_init(stand, &rig, toy);
    view_default(&toy->scene, WIDTH_PX, HEIGHT_PX, view);
}

static void expect_plates(int sensors)
{
    struct drawn_error_tally tally;
    char name[32];
    tally_plates(SIDE_M, sensors, DISTANCE_EUCLIDEAN, &tally);
    snprintf(name, sizeof(name), "%d sensors", sensors);
    expect_exact(name, &tally);
}

TEST(test_few_sensors_are_exact)
{
    expect_plates(SENSORS);
}

TEST(test_nine_sensors_are_exact)
{
    expect_plates(9);
}

TEST(test_many_sensors_are_exact)
{
    expect_plates(CROWD);
}

/* Makes a plate of needles 10,000 times as long as wide and of degenerate triangles. Sensors lie at a corner, on an edge, a
   tiny distance from the edge, and two with different readings at one point. The others lie at random points, every second one
   at the same point as the one before. */
static void make_odd_plate(struct test_shape *shape, int sensors, double (*places)[3])
{
    const double width_m = SIDE_M / 10000, x = between(1, SIDE_M - 1), y = between(1, SIDE_M - 1);
    for (int i = 0; i < NEEDLES; i++)
        shape_plate(shape, TOY_STEEL, (double[3]){ i * width_m, 0, 0 }, (double[3]){ width_m, 0, 0 }, (double[3]){ 0, SIDE_M, 0 }, 1);
    shape_plate(shape, TOY_STEEL, (double[3]){ NEEDLES * width_m, 0, 0 }, (double[3]){ SIDE_M - NEEDLES * width_m, 0, 0 },
                (double[3]){ 0, SIDE_M, 0 }, 1);
    shape_plate(shape, TOY_STEEL, (double[3]){ 1, 1, 0 }, (double[3]){ 1, 0, 0 }, (double[3]){ 1, 1e-9, 0 }, 3);
    memcpy(places, (double[SENSORS][3]){ { SIDE_M, 0, 0 }, { NEEDLES * width_m, y, 0 }, { NEEDLES * width_m + 1e-6, SIDE_M - y, 0 },
                                         { x, y, 0 }, { x, y, 0 }, { between(1, 3), between(1, 3), 0 } },
           SENSORS * sizeof(*places));
    for (int i = SENSORS; i < sensors; i++) {
        const double anywhere[3] = { between(0, SIDE_M), between(0, SIDE_M), 0 };
        memcpy(places[i], i % 2 ? places[i - 1] : anywhere, sizeof(places[i]));
    }
}

static void expect_odd_shapes(int sensors)
{
    struct drawn_error_tally tally = { .worst_beyond = -1 };
    random_state = sweep_seed();
    for (int round = 0; round < sweep(8, 1); round++) {
        struct toy *toy = toy_create();
        struct test_shape shape = { 0 };
        struct stand stand;
        double places[CROWD][3];
        make_odd_plate(&shape, sensors, places);
        toy_add(toy, "PLATE", &shape, (double[3]){ 0, 0, 0 }, (const double(*)[3])places, (size_t)sensors);
        stand_init(&stand, &rig, toy);
        fill(stand.snapshot, sensors, 0);
        struct drawn_error_case site = { &toy->scene, stand.field, stand.renderer, stand.snapshot };
        compare(&site, DISTANCE_EUCLIDEAN, &tally);
        stand_finish(&stand);
    }
    expect_exact("odd shapes", &tally);
}

TEST(test_odd_shapes_are_exact)
{
    expect_odd_shapes(SENSORS);
}

TEST(test_odd_shapes_with_many_sensors_are_exact)
{
    expect_odd_shapes(9);
    expect_odd_shapes(CROWD);
}

/* Returns the height that a hot spot needs at a pixel for a sensor to show it, as a share of the range. */
static double hot_spot_at(const struct drawn_error_case *site, const struct view *view, double x, double y)
{
    struct pick pick;
    struct pixel_field pixels;
    struct pixel_value value = { 0 };
    pick_at(site->scene, site->field, view, site->snapshot, x, y, &pick);
    const float at_m[3] = { (float)pick.position_m[0], (float)pick.position_m[1], (float)pick.position_m[2] };
    field_pixels(site->field, 0, &view->field, &pixels);
    assert_true(pixels.show == PIXEL_BLIND);
    pixel_field_at(&pixels, at_m, &value);
    pixel_field_finish(&pixels);
    return pick.asset < 0 ? (double)NAN : ((double)value.value - view->range_min) / (view->range_max - view->range_min);
}

TEST(test_hot_spots_are_exact)
{
    struct stand stand;
    struct view view;
    int compared = 0;
    double least = INFINITY, most = -INFINITY;
    float(*measured)[4] = mem_array(PIXELS, sizeof(*measured));
    stand_on_plate(&stand, &view, 0);
    stand.toy->plant.groups[0].hot_spot_m = 0.3;
    fill(stand.snapshot, MANY, 0);
    view.field.distance = DISTANCE_EUCLIDEAN;
    field_params_set_show(&stand.toy->plant, &view.field, SHOW_BLIND);
    view_default_scale(&stand.toy->scene, &view);
    assert_true(renderer_measure(stand.renderer, &view, stand.snapshot, true, measured));
    struct drawn_error_case site = { &stand.toy->scene, stand.field, stand.renderer, stand.snapshot };
    for (int i = 0; i < PICKS; i++) {
        int x = (int)between(1, WIDTH_PX - 1), y = (int)between(1, HEIGHT_PX - 1);
        double low = INFINITY, high = -INFINITY, drawn = (double)measured[y * WIDTH_PX + x][0];
        for (int n = 0; n < 5; n++) { /* the pixel's centre, and points SNAP_PX away from it */
            double away = n < 4 ? SNAP_PX : 0, right = x + 0.5 + (n % 2 ? away : -away), down = y + 0.5 + (n / 2 ? away : -away);
            double here = hot_spot_at(&site, &view, right, down);
            low = fmin(low, isnan(here) ? -INFINITY : here);
            high = fmax(high, here);
        }
        if (measured[y * WIDTH_PX + x][1] != 0 || low == -INFINITY || high - low > 20 * STEP)
            continue;
        compared++;
        least = fmin(least, drawn);
        most = fmax(most, drawn);
        assert_true(drawn >= low - STEP && drawn <= high + STEP);
    }
    print_message("# %d pixels, from %.2f to %.2f of the range\n", compared, least, most);
    assert_true(compared > 50 && least < 0.1 && most > 0.5);
    mem_free(measured);
    stand_finish(&stand);
}

/* The frame states its largest drawing error: on this plate more than 1 if neighbouring readings differ by 40, and 0 if all
   readings are equal. */
TEST(test_equal_readings_mark_nothing)
{
    struct stand stand;
    struct view view;
    stand_on_plate(&stand, &view, 0);
    view.field.distance = DISTANCE_GEODESIC;
    for (int spread = 40; spread >= 0; spread -= 40) {
        for (int i = 0; i < MANY; i++)
            toy_set(stand.snapshot, i, 50 + (i % 2 ? spread : 0), QUALITY_GOOD);
        struct frame *frame = stand_draw(&stand, &view);
        assert_true(spread > 0 ? frame->drawn_error[0] > 1 && frame->drawn_error[0] <= 50 : frame->drawn_error[0] == 0);
        frame_unref(&frame);
    }
    stand_finish(&stand);
}

/* The error bound that preparation stored holds only for the plant file's power, while all sensors are good and all readings are
   within the range. Otherwise the renderer must measure the error. */
TEST(test_lost_sensors_wild_readings_and_other_powers_are_measured)
{
    struct stand stand;
    struct view view;
    stand_on_plate(&stand, &view, 1);
    /* way 0: all sensors good, as assumed by preparation; 1: one sensor Bad; 2: one reading far out of the range; 3: a lower
       power; 4: a higher power */
    for (int way = 0; way < 5; way++) {
        view.field.power = way == 3 ? 1 : way == 4 ? 4 : 2;
        for (int i = 0; i < MANY; i++)
            toy_set(stand.snapshot, i, 20 + 5 * i, way == 1 && i == 1 ? QUALITY_BAD_COMMUNICATION_ERROR : QUALITY_GOOD);
        if (way == 2)
            toy_set(stand.snapshot, 2, 300, QUALITY_GOOD);
        struct frame *frame = stand_draw(&stand, &view);
        assert_true(way == 0 ? frame->drawn_error[0] == 0 : frame->drawn_error[0] > 0);
        frame_unref(&frame);
    }
    stand_finish(&stand);
}

/* Draws the plate with the power 6 for which it was prepared, first with readings within the range if `usual`, then with one far
   beyond. Returns the error that the last frame states. */
static double error_of_wild_readings(bool usual)
{
    struct stand stand;
    struct view view;
    double error = 0;
    stand_on_plate(&stand, &view, 1);
    stand.toy->plant.groups[0].power = view.field.power = 6;
    for (int wild = !usual; wild < 2; wild++) {
        for (int i = 0; i < MANY; i++)
            toy_set(stand.snapshot, i, i == 2 && wild ? 300 : 20 + 5 * i, QUALITY_GOOD);
        struct frame *frame = stand_draw(&stand, &view);
        error = frame->drawn_error[0];
        frame_unref(&frame);
    }
    stand_finish(&stand);
    return error;
}

/* With a high power, errors of distances are measured even if preparation left no interpolation error. These errors must not hide
   that of later readings, beyond the range. */
TEST(test_wild_readings_after_usual_ones_are_measured)
{
    const double error = error_of_wild_readings(false);
    assert_true(error > 100);
    assert_float_equal(error_of_wild_readings(true), error, 1e-6 * error);
}

/* Returns the number of pixels with data that are marked uncertain. *shown: receives the number of all pixels with data. */
static int count_marked(const struct stand *stand, const struct view *view, int *shown)
{
    float(*measured)[4] = mem_array(PIXELS, sizeof(*measured));
    int marked = 0;
    *shown = 0;
    assert_true(renderer_measure(stand->renderer, view, stand->snapshot, true, measured));
    for (int i = 0; i < PIXELS; i++) {
        bool has_data = measured[i][1] >= 0 && measured[i][1] <= 0.5f;
        *shown += has_data;
        marked += has_data && measured[i][2] > 0.5f;
    }
    mem_free(measured);
    return marked;
}

/* A plate of needles with distances along the surface and readings that alternate between 10 and 90. */
static void stand_on_uneven_plate(struct stand *stand, struct view *view)
{
    stand_on_plate(stand, view, 0);
    view->field.distance = DISTANCE_GEODESIC;
    for (int i = 0; i < MANY; i++)
        toy_set(stand->snapshot, i, i % 2 ? 90 : 10, QUALITY_GOOD);
}

/* Each half of a split view states its own error, and the message `markers` names the half. */
TEST(test_halves_state_errors_of_their_own)
{
    struct stand stand;
    struct view right, view;
    struct known_markers known = { 0 };
    struct marker_text_cache lists = { 0 };
    stand_on_uneven_plate(&stand, &right);
    view = right;
    view.field.distance = DISTANCE_EUCLIDEAN;
    for (int split = 1; split >= 0; split--) {
        view.split = false;
        if (split)
            view_split(&view, &right);
        struct frame *frame = stand_draw(&stand, &view);
        assert_true(frame->drawn_error[0] == 0 && (split ? frame->drawn_error[1] > 0 : frame->drawn_error[1] == 0));
        char *text = marker_text(frame, 1, &known, &lists);
        assert_null(strstr(text, "\"drawn_error\""));
        assert_non_null(strstr(text, "\"drawn_error_right\":"));
        assert_int_equal(!strstr(text, "\"drawn_error_right\":0}"), split);
        mem_free(text);
        frame_unref(&frame);
    }
    marker_text_cache_finish(&lists);
    known_markers_finish(&known);
    stand_finish(&stand);
}

/* If memory runs out while errors are measured, pictures and picks mark the whole asset. */
TEST(test_without_memory_for_errors_all_is_marked)
{
    struct stand stand;
    struct view view;
    struct pick pick;
    stand_on_uneven_plate(&stand, &view);
    missing_elements = stand.toy->scene.assets[0].file->view.header->index_count / 3;
    int shown, marked = count_marked(&stand, &view, &shown);
    struct frame *frame = stand_draw(&stand, &view);
    pick_at(&stand.toy->scene, stand.field, &view, stand.snapshot, WIDTH_PX / 2.0, HEIGHT_PX / 2.0, &pick);
    missing_elements = 0;
    assert_true(marked > 1000 && marked == shown);
    assert_true(pick.asset == 0 && pick.drawn_error > 0 && frame->drawn_error[0] >= 80);
    frame_unref(&frame);
    stand_finish(&stand);
}

/* Even if shaders sum over all sensors at each pixel, the distances along a surface are interpolated over a triangle. Therefore
   long triangles stay marked. */
TEST(test_a_field_per_fragment_marks_long_triangles)
{
    struct stand stand;
    struct view view;
    stand_on_uneven_plate(&stand, &view);
    int shown, at_vertices = count_marked(&stand, &view, &shown);
    renderer_set_per_fragment(stand.renderer, true);
    int per_fragment = count_marked(&stand, &view, &shown);
    print_message("# %d pixels are marked, %d with a field per fragment\n", at_vertices, per_fragment);
    assert_true(at_vertices > 1000 && per_fragment >= at_vertices);
    stand_finish(&stand);
}

struct near_tally {
    int compared, marked, marked_right;
    double worst, worst_marked; /* largest error of unmarked and of marked pixels, as a share of the colour scale */
};

/* Compares pixels with picks, which evaluate the distance at their place. */
static void compare_near(const struct stand *stand, const struct view *view, struct near_tally *tally)
{
    const struct scale scale = { .min = view->range_min, .max = view->range_max, .log = view->color_scale.log };
    float(*measured)[4] = mem_array(PIXELS, sizeof(*measured));
    assert_true(renderer_measure(stand->renderer, view, stand->snapshot, true, measured));
    for (int i = 0; i < PICKS; i++) {
        int x = (int)between(0, WIDTH_PX), y = (int)between(0, HEIGHT_PX);
        const float *pixel = measured[y * WIDTH_PX + x];
        struct pick pick;
        pick_at(&stand->toy->scene, stand->field, view, stand->snapshot, x + 0.5, y + 0.5, &pick);
        if (pick.asset < 0 || pixel[1] != 0 || pick.state == PICK_NO_DATA)
            continue;
        double drawn = scale.min + (double)pixel[0] * (scale.max - scale.min);
        double off = fabs(fmin(fmax(scale_place(&scale, fmax(drawn, 1e-9)), 0), 1) - fmin(fmax(scale_place(&scale, pick.value), 0), 1));
        bool marked = pixel[2] > 0.5f;
        tally->compared++;
        tally->marked += marked;
        tally->marked_right += marked && off <= STEP;
        *(marked ? &tally->worst_marked : &tally->worst) = fmax(marked ? tally->worst_marked : tally->worst, off);
    }
    mem_free(measured);
}

/* Distances along a surface, and the blind places that follow from them, are interpolated between corners. Where that is off by
   more than `limit` of the colour scale, pictures mark it. The plate consists half of strips and half of small triangles. */
static void tally_near(enum field_show show, double hot_spot_m, double limit, struct near_tally *tally)
{
    random_state = sweep_seed();
    for (int round = 0; round < sweep(8, 2); round++) {
        struct toy *toy = toy_create();
        struct test_shape shape = { 0 };
        struct stand stand;
        struct view view;
        double places[SENSORS][3];
        make_plate(&shape, SIDE_M / 2, SENSORS, places);
        toy->plant.groups[0].hot_spot_m = hot_spot_m;
        toy_add(toy, "PLATE", &shape, (double[3]){ 0, 0, 0 }, (const double(*)[3])places, SENSORS);
        stand_init(&stand, &rig, toy);
        fill(stand.snapshot, SENSORS, 0);
        view_default(&toy->scene, WIDTH_PX, HEIGHT_PX, &view);
        field_params_set_show(&toy->plant, &view.field, show);
        view.field.distance = DISTANCE_GEODESIC;
        view.field.sensor = 2;
        view_default_scale(&toy->scene, &view);
        look(&toy->scene, &view);
        toy->plant.tags[2].strength = 0; /* its distances are shown all the same */
        compare_near(&stand, &view, tally);
        stand_finish(&stand);
    }
    print_message("# %d pixels, unmarked ones off by %.2f steps, %d marked ones by %.1f, %d of these right\n", tally->compared,
                  tally->worst / STEP, tally->marked, tally->worst_marked / STEP, tally->marked_right);
    assert_true(tally->compared > 500 && tally->worst <= 1.1 * limit && tally->worst_marked > limit);
    assert_true(tally->compared - tally->marked > tally->compared / 10);
}

TEST(test_distances_along_surfaces_are_marked)
{
    struct near_tally tally = { 0 };
    tally_near(SHOW_DISTANCE, 0.7, STEP, &tally);
    assert_true(tally.marked > tally.compared / 10);
}

TEST(test_blind_places_along_surfaces_are_marked)
{
    struct near_tally large = { 0 }, small = { 0 };
    tally_near(SHOW_BLIND, 0.7, 0.1, &large);
    assert_true(large.marked > large.compared / 10);
    tally_near(SHOW_BLIND, 0.05, 0.1, &small);
}

/* Makes a square plate of two triangles with two small boxes, one for each sensor, near its corner, and a plate of small triangles
   beside this corner. */
static void make_pair(struct test_shape *shape, double (*places)[3])
{
    shape_plate(shape, TOY_STEEL, (double[3]){ 0 }, (double[3]){ SIDE_M, 0, 0 }, (double[3]){ 0, SIDE_M, 0 }, 1);
    shape_plate(shape, TOY_STEEL, (double[3]){ -1, 0, 0 }, (double[3]){ 1, 0, 0 }, (double[3]){ 0, 1, 0 }, CELLS);
    for (int i = 0; i < 2; i++) {
        double x = between(0.2, 0.5) + 0.5 * i, y = between(0.2, 0.5) + 0.5 * i;
        memcpy(places[i], (double[3]){ x, y, 0.02 }, sizeof(places[i]));
        shape_box(shape, TOY_BLUE, (double[3]){ x - 0.01, y - 0.01, 0.01 }, (double[3]){ x + 0.01, y + 0.01, 0.02 });
    }
}

#define BORDER_M 0.05 /* places nearer to the border of the data are not counted */

struct border_tally {
    int beyond;  /* places without data */
    int painted; /* of these, places shown with a colour and without a mark */
    int within;  /* places with data that are shown with a colour and without a mark */
};

/* Draws a picture and adds random places in it to *tally. beyond_m: returns how far a place is beyond the border of the data, in metres;
   negative: within. */
static void tally_border(struct stand *stand, const struct view *view, double (*beyond_m)(const struct pick *pick, const void *arg),
                         const void *arg, struct border_tally *tally)
{
    float(*measured)[4] = mem_array(PIXELS, sizeof(*measured));
    assert_true(renderer_measure(stand->renderer, view, stand->snapshot, true, measured));
    for (int i = 0; i < PICKS; i++) {
        int x = (int)between(0, WIDTH_PX), y = (int)between(0, HEIGHT_PX);
        const float *pixel = measured[y * WIDTH_PX + x];
        struct pick pick;
        pick_at(&stand->toy->scene, stand->field, view, stand->snapshot, x + 0.5, y + 0.5, &pick);
        if (pick.asset < 0 || pixel[1] < 0)
            continue;
        bool shown = pixel[1] <= 0.5f && pixel[2] <= 0.5f, is_beyond = beyond_m(&pick, arg) > BORDER_M;
        tally->beyond += is_beyond;
        tally->painted += is_beyond && shown;
        tally->within += beyond_m(&pick, arg) < -BORDER_M && shown;
    }
    mem_free(measured);
}

/* Returns how much nearer the picked point is to the second sensor of its asset than to the first, in metres. */
static double nearer_to_second_m(const struct pick *pick, const void *scene)
{
    double away_m[2] = { 0 };
    for (int i = 0; i < 2; i++) {
        const struct scene_sensor *sensor = &((const struct scene *)scene)->assets[pick->asset].sensors[i];
        for (int c = 0; c < 3; c++)
            away_m[i] = hypot(away_m[i], pick->position_m[c] - sensor->surface_m[c]);
    }
    return away_m[0] - away_m[1];
}

/* Of two sensors on a plate of two triangles, one is Bad. Places that are nearer to it than to the other sensor have no data.
   Pictures must show that, or mark the place as uncertain, although all values are equal. */
TEST(test_a_lost_sensor_keeps_its_place)
{
    struct border_tally tally = { 0 };
    random_state = sweep_seed();
    for (int round = 0; round < sweep(12, 3); round++) {
        struct toy *toy = toy_create();
        struct test_shape shape = { 0 };
        struct stand stand;
        struct view view;
        double places[2][3];
        make_pair(&shape, places);
        toy_add(toy, "PLATE", &shape, (double[3]){ 0, 0, 0 }, (const double(*)[3])places, 2);
        stand_init(&stand, &rig, toy);
        toy_set(stand.snapshot, 0, 50, QUALITY_GOOD);
        toy_set(stand.snapshot, 1, 50, QUALITY_BAD_COMMUNICATION_ERROR);
        view_default(&toy->scene, WIDTH_PX, HEIGHT_PX, &view);
        view.field.distance = DISTANCE_GEODESIC;
        look(&toy->scene, &view);
        tally_border(&stand, &view, nearer_to_second_m, &toy->scene, &tally);
        stand_finish(&stand);
    }
    print_message("# %d places nearer to the Bad sensor, %d of them painted; %d places of the good sensor are unmarked\n", tally.beyond,
                  tally.painted, tally.within);
    assert_true(tally.beyond > 300 && tally.within > 20);
    assert_int_equal(tally.painted, 0);
}

struct reach {
    double x_m, y_m, reach_m;
};

static double beyond_reach_m(const struct pick *pick, const void *arg)
{
    const struct reach *reach = arg;
    return hypot(pick->position_m[0] - reach->x_m, pick->position_m[1] - reach->y_m) - reach->reach_m;
}

/* One sensor with a limited reach stands on a plate of two triangles, which preparation did not cut, because all values are equal.
   Pictures must show that places beyond the reach have no data, or mark them as uncertain. */
TEST(test_the_end_of_a_lone_reach_is_marked)
{
    struct border_tally tally = { 0 };
    random_state = sweep_seed();
    for (int round = 0; round < sweep(12, 3); round++) {
        struct toy *toy = toy_create();
        struct test_shape shape = { 0 };
        struct stand stand;
        struct view view;
        double x_m = between(0.02, 0.1), y_m = between(0.02, 0.1), places[1][3] = { { x_m, y_m, 0.02 } };
        const struct reach reach = { x_m, y_m, 1.2 };
        shape_plate(&shape, TOY_STEEL, (double[3]){ 0 }, (double[3]){ SIDE_M, 0, 0 }, (double[3]){ 0, SIDE_M, 0 }, 1);
        shape_plate(&shape, TOY_STEEL, (double[3]){ -1, 0, 0 }, (double[3]){ 1, 0, 0 }, (double[3]){ 0, SIDE_M, 0 }, CELLS);
        shape_box(&shape, TOY_BLUE, (double[3]){ x_m - 0.01, y_m - 0.01, 0.01 }, (double[3]){ x_m + 0.01, y_m + 0.01, 0.02 });
        toy_add(toy, "PLATE", &shape, (double[3]){ 0, 0, 0 }, (const double(*)[3])places, 1);
        toy->plant.groups[0].reach_m = reach.reach_m;
        toy->scene.assets[0].file->resolved_levels = UINT64_MAX;
        stand_init(&stand, &rig, toy);
        toy_set(stand.snapshot, 0, 50, QUALITY_GOOD);
        view_default(&toy->scene, WIDTH_PX, HEIGHT_PX, &view);
        view.field.distance = DISTANCE_GEODESIC;
        view.field.reach_m = reach.reach_m;
        look(&toy->scene, &view);
        tally_border(&stand, &view, beyond_reach_m, &reach, &tally);
        stand_finish(&stand);
    }
    print_message("# %d places beyond the reach, %d of them painted; %d places within it are unmarked\n", tally.beyond, tally.painted,
                  tally.within);
    assert_true(tally.beyond > 300 && tally.within > 20);
    assert_int_equal(tally.painted, 0);
}

/* --- what was found --------------------------------------------------------------------------------------------------------- */

struct long_part {
    struct plant *plant;
    struct drawn_error_case site;
};

/* Prepares the plant of the long part with this `distance` setting in the plant file. Skips the test if the part's files are
   missing. */
static void long_part_init(struct long_part *part, struct prep_case *c, const char *distance)
{
    static const double readings[] = { 20, 95, 40, 110, 60, 5 };
    if (access(FOUND, R_OK) != 0) {
        print_message("# " FOUND " is not there\n");
        skip();
    }
    char *copy = test_printf("cp %s* %s && chmod -R u+w %s && sed -i 's/distance: euclidean/distance: %s/' %s", FOUND, c->folder, c->folder,
                            distance, c->plant);
    assert_int_equal(system(copy), 0);
    prep_case_expect(c, "$PLANT", 0);
    struct diag diag = { 0 };
    part->plant = plant_load(c->plant, &diag);
    diag_finish(&diag);
    char *prepared = test_printf("%s/plant.prepared", c->folder);
    struct scene *scene = part->plant ? scene_create(rig.log, part->plant, prepared) : NULL;
    assert_non_null(scene);
    part->site = (struct drawn_error_case){ .scene = scene,
                                            .field = field_create(rig.workers, scene),
                                            .snapshot = snapshot_create(part->plant->tag_count) };
    part->site.renderer = renderer_create(rig.log, rig.gl, scene, part->site.field);
    assert_non_null(part->site.renderer);
    for (int i = 0; i < SENSORS; i++)
        part->site.snapshot->readings[i] = (struct reading){ .value = readings[i], .quality = QUALITY_GOOD };
    random_state = sweep_seed();
}

static void long_part_finish(struct long_part *part)
{
    struct scene *scene = (struct scene *)part->site.scene;
    renderer_destroy(&part->site.renderer);
    field_destroy(&part->site.field);
    snapshot_destroy(&part->site.snapshot);
    scene_destroy(&scene);
    plant_destroy(&part->plant);
}

TEST_WITH(test_long_part, prep_case_set_up, prep_case_tear_down)
{
    struct long_part part;
    struct drawn_error_tally tally = { .worst_beyond = -1 };
    long_part_init(&part, *state, "euclidean");
    for (int round = 0; round < sweep(8, 2); round++)
        compare(&part.site, DISTANCE_EUCLIDEAN, &tally);
    expect_exact("long_part", &tally);
    long_part_finish(&part);
}

/* With distances along surfaces, half of the part's pixels and a fifth of the picks would be off by more than a colour step
   (tests/bench/notes/windows.md). All of these must be marked uncertain. */
TEST_WITH(test_long_part_along_surfaces, prep_case_set_up, prep_case_tear_down)
{
    struct long_part part;
    int picks = 0, bare_picks = 0, pixels = 0, bare_pixels = 0;
    long_part_init(&part, *state, "geodesic");
    float(*measured)[4] = mem_array(PIXELS, sizeof(*measured));
    for (int round = 0; round < sweep(8, 2); round++) {
        struct view view;
        view_default(part.site.scene, WIDTH_PX, HEIGHT_PX, &view);
        view.tier = round % 2 ? TIER_REFINED : TIER_PREVIEW;
        look(part.site.scene, &view);
        assert_true(renderer_measure(part.site.renderer, &view, part.site.snapshot, true, measured));
        for (int i = 0; i < PIXELS; i++) {
            pixels += measured[i][1] == 0;
            bare_pixels += measured[i][1] == 0 && measured[i][2] <= 0.5f;
        }
        for (int i = 0; i < PICKS; i++) {
            struct pick pick;
            pick_at(part.site.scene, part.site.field, &view, part.site.snapshot, between(0, WIDTH_PX), between(0, HEIGHT_PX), &pick);
            picks += pick.asset >= 0;
            bare_picks += pick.asset >= 0 && (!pick.uncertain || !(pick.drawn_error > 0));
        }
    }
    print_message("# %d of %d picks and %d of %d pixels are not marked\n", bare_picks, picks, bare_pixels, pixels);
    assert_true(picks > 300 && pixels > 3000);
    assert_int_equal(bare_picks, 0);
    assert_int_equal(bare_pixels, 0);
    mem_free(measured);
    long_part_finish(&part);
}
