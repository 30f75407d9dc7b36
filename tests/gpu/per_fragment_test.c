/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The field computed per fragment, with more than the paper's 512 sensors, compared with plain loops in double precision:
   values and drawn colours. The plate is seen from straight above, so that each pixel's position is known. */
#include "tests/support/test.h"

#include "protocol/asset_distance.h"
#include "tests/support/cad.h"
#include "tests/support/renderer_compare.h"
#include "tests/support/rig.h"
#include "tests/support/synthetic.h"
#include "value/quality.h"

enum { SENSORS = 701, SAMPLES = 1500, BAD_EVERY = 60 };
static const double SIDE_M = 4, TOLERANCE = 1.0 / 255;
static int side_px; /* pixels per side; each pixel costs a sum over all sensors */
static struct rig rig;
static struct stand stand;
static uint64_t random_state;

static double between(double low, double high)
{
    return low + (high - low) * synthetic_random_unit(&random_state);
}

static int set_up(void **state)
{
    struct test_shape shape = { 0 };
    struct toy *toy = toy_create();
    double(*places)[3] = mem_array(SENSORS, sizeof(*places));
    (void)state;
    for (int i = 0; i < SENSORS; i++)
        for (int c = 0; c < 2; c++)
            places[i][c] = between(0, SIDE_M);
    shape_plate(&shape, TOY_STEEL, (double[3]){ 0, 0, 0 }, (double[3]){ SIDE_M, 0, 0 }, (double[3]){ 0, SIDE_M, 0 }, sweep(40, 20));
    toy_add(toy, "PLATE", &shape, (double[3]){ 0, 0, 0 }, (const double(*)[3])places, SENSORS);
    mem_free(places);
    stand_init(&stand, &rig, toy);
    for (int i = 0; i < SENSORS; i++) {
        toy->plant.tags[i].strength = between(0.5, 2);
        toy->plant.tags[i].decay = between(0, 2);
        toy_set(stand.snapshot, i, between(0, 100), i % BAD_EVERY == 7 ? QUALITY_BAD_SENSOR_FAILURE : QUALITY_GOOD);
    }
    renderer_set_per_fragment(stand.renderer, true);
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    stand_finish(&stand);
    return 0;
}

static const struct asset_view *file(void)
{
    return &stand.toy->scene.assets[0].file->view;
}

/* --- slow truth --------------------------------------------------------------------------------------------------------------- */

/* a point on the plate: its position, the corners of its triangle, and the weights (`parts`) with which it lies between them */
struct plate_spot {
    double at_m[2], parts[3];
    const uint32_t *corners;
};

static bool find_spot(double x_m, double y_m, struct plate_spot *spot)
{
    for (uint32_t i = 0; i < file()->header->index_count; i += 3) {
        const uint32_t *corners = &file()->indices[i];
        const float *a = file()->positions_m[corners[0]], *b = file()->positions_m[corners[1]], *c = file()->positions_m[corners[2]];
        double bx = (double)b[0] - a[0], by = (double)b[1] - a[1], cx = (double)c[0] - a[0], cy = (double)c[1] - a[1];
        double px = x_m - (double)a[0], py = y_m - (double)a[1], area = bx * cy - by * cx;
        double v = (px * cy - py * cx) / area, w = (bx * py - by * px) / area;
        if (v < 0 || w < 0 || v + w > 1)
            continue;
        *spot = (struct plate_spot){ .at_m = { x_m, y_m }, .parts = { 1 - v - w, v, w }, .corners = corners };
        return true;
    }
    return false;
}

static double distance_of(const struct plate_spot *spot, int sensor, enum distance_mode mode)
{
    const float *at = file()->sensors[sensor].surface_m;
    double sum = 0;
    if (mode == DISTANCE_EUCLIDEAN)
        return hypot(spot->at_m[0] - (double)at[0], spot->at_m[1] - (double)at[1]);
    for (int c = 0; c < 3; c++)
        sum += spot->parts[c] * (double)asset_distance_m(file(), (size_t)sensor, spot->corners[c]);
    return sum;
}

/* Returns the largest distance in metres from any sensor to any vertex; on the flat toy plate, distances along the surface
   equal straight lines. */
static double largest_m(void)
{
    double most_m = 0;
    for (int i = 0; i < SENSORS; i++)
        for (uint32_t v = 0; v < file()->header->vertex_count; v++)
            most_m = fmax(most_m, (double)asset_distance_m(file(), (size_t)i, v));
    return most_m;
}

struct fragment_truth {
    double value;        /* expected value as a fraction of the colour scale's range, 0 to 1 */
    bool no_data, a_tie; /* a_tie: rounding decides between two results */
};

static struct fragment_truth truth_at(const struct plate_spot *spot, enum interpolation interpolation, enum distance_mode mode,
                                      double radius_m)
{
    double sum = 0, weights = 0, near_m = INFINITY, lost_m = INFINITY;
    for (int i = 0; i < SENSORS; i++) {
        const struct reading *reading = &stand.snapshot->readings[i];
        const struct plant_tag *tag = &stand.toy->plant.tags[i];
        double d = distance_of(spot, i, mode), near = fmax(0, 1 - d / radius_m), place = reading->value / 100;
        bool bad = quality_is_bad(reading->quality);
        *(bad ? &lost_m : &near_m) = fmin(bad ? lost_m : near_m, d);
        if (bad)
            continue;
        double weight = interpolation == INTERPOLATION_PAPER ? exp(near * tag->strength) : tag->strength / (d * d);
        sum += place * weight * (interpolation == INTERPOLATION_PAPER ? pow(near, tag->decay) : 1);
        weights += weight;
    }
    return (struct fragment_truth){ sum / weights, lost_m < near_m, fabs(lost_m - near_m) < 1e-4 };
}

/* --- comparison with the drawn frame ---------------------------------------------------------------------------------------- */

static void look_down(struct view *view, enum interpolation interpolation, enum distance_mode distance)
{
    view_default(&stand.toy->scene, side_px, side_px, view);
    view->camera = (struct camera){ .eye_m = { SIDE_M / 2, SIDE_M / 2, 10 }, .target_m = { SIDE_M / 2, SIDE_M / 2, 0 }, .up = { 0, 1, 0 } };
    view->camera.height_m = SIDE_M;
    view->look = LOOK_FLAT;
    view->tier = TIER_PREVIEW;
    view->field.interpolation = interpolation;
    view->field.distance = distance;
}

struct per_fragment_tally {
    double worst;
    int most_off, flags_differ, no_data, dots; /* most_off: largest error so far, in steps of the map's colours */
};

static void compare(const struct view *view, const float (*numbers)[4], const struct frame *frame, double radius_m,
                    struct per_fragment_tally *tally)
{
    int x = (int)between(0, side_px), y = (int)between(0, side_px);
    double metre = SIDE_M / side_px;
    struct plate_spot spot = { 0 };
    assert_true(find_spot((x + 0.5) * metre, (side_px - y - 0.5) * metre, &spot));
    struct fragment_truth truth = truth_at(&spot, view->field.interpolation, view->field.distance, radius_m);
    const float *number = numbers[y * side_px + x];
    if (truth.a_tie)
        return;
    tally->flags_differ += (number[1] > 0.5f) != truth.no_data;
    tally->no_data += truth.no_data;
    tally->worst = fmax(tally->worst, fabs((double)number[0] - truth.value));
    if (truth.no_data)
        return;
    int off = map_colors_off(colormap_at(NULL, (size_t)view->colormap), frame_pixel(frame, x, y), truth.value);
    if (off < 0 && number[2] > 0.5f) { /* a dot of the pattern of uncertain places */
        tally->dots++;
        return;
    }
    assert_true(off >= 0);
    tally->most_off = off > tally->most_off ? off : tally->most_off;
}

TEST_WITH(test_more_than_512_sensors, set_up, tear_down)
{
    double radius_m = largest_m();
    float(*numbers)[4] = mem_array((size_t)side_px * (size_t)side_px, sizeof(*numbers));
    for (int way = 0; way < 4; way++) {
        struct view view;
        struct per_fragment_tally tally = { 0 };
        look_down(&view, way & 1 ? INTERPOLATION_PAPER : INTERPOLATION_SHEPARD, way & 2 ? DISTANCE_EUCLIDEAN : DISTANCE_GEODESIC);
        assert_true(renderer_measure(stand.renderer, &view, stand.snapshot, true, numbers));
        struct frame *frame = stand_draw(&stand, &view);
        for (int i = 0; i < SAMPLES; i++)
            compare(&view, (const float(*)[4])numbers, frame, radius_m, &tally);
        print_message("# %s, %s: worst %.6f, of colours %d; no data %d, other flags %d\n", way & 1 ? "paper" : "shepard",
                      way & 2 ? "euclidean" : "geodesic", tally.worst, tally.most_off, tally.no_data, tally.flags_differ);
        assert_int_equal(tally.flags_differ, 0);
        assert_true(tally.no_data > 0 && tally.no_data < SAMPLES / 4);
        assert_true(view.field.distance == DISTANCE_EUCLIDEAN ? tally.dots == 0 : tally.dots < SAMPLES / 2);
        /* a GPU interpolates positions less exactly than llvmpipe */
        assert_true(tally.worst <= (rig.gl->software ? TOLERANCE / 10 : TOLERANCE) && tally.most_off <= 1);
        frame_unref(&frame);
    }
    mem_free(numbers);
}

int main(void)
{
    struct cad_random random;
    cad_random_start(&random);
    random_state = random.state;
    side_px = sweep(160, 48);
    return rig_run(&rig);
}
