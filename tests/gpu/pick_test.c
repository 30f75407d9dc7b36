/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Picks (what is at a pixel of the picture) compared with the values, depths and markers of the frame's pixels, and with sums
   over sensors in double precision; on the demo plant and on a small one. */
#include "render/pick/pick.h"

#include "tests/support/renderer_compare.h"
#include "tests/support/test.h"
#include <time.h>

#include "scene/framing.h"
#include "scene/scene_create.h"
#include "tests/support/rig_case.h"
#include "tests/support/synthetic.h"
#include "value/quality.h"

enum { WIDTH_PX = 640, HEIGHT_PX = 360, PIXELS = WIDTH_PX * HEIGHT_PX };

struct pick_case {
    const struct scene *scene;
    struct field *field;
    struct renderer *renderer;
    struct snapshot *snapshot;
    uint64_t random;
};

static void fill(struct pick_case *site)
{
    const struct plant *plant = site->scene->plant;
    site->random = 7;
    for (size_t i = 0; i < plant->tag_count; i++) {
        const struct plant_tag *tag = &plant->tags[i];
        if (tag->group < 0)
            continue;
        const struct plant_group *group = &plant->groups[tag->group];
        double part = synthetic_random_unit(&site->random);
        site->snapshot->readings[i] = (struct reading){ .value = group->min + (group->max - group->min) * part,
                                                        .quality = part > 0.9 ? QUALITY_BAD_COMMUNICATION_ERROR : QUALITY_GOOD };
    }
}

struct pick_tally {
    int compared, context, inside, no_data, moved, differ, over, marked, marked_right;
    double worst_value, worst_px, worst_sum, longest_ms;
};

/* Returns the value at the picked point by Shepard's formula in double precision, from the distances that the pick reports. */
static double slow_value(const struct pick_case *site, const struct view *view, const struct pick *pick)
{
    double numerator = 0, denominator = 0;
    for (int i = 0; i < pick->nearest_count; i++) {
        double distance_m = pick->nearest[i].distance_m, left = 1 - distance_m / view->field.reach_m;
        double weight = site->scene->plant->tags[pick->nearest[i].tag].strength * left * left / pow(distance_m, view->field.power);
        numerator += weight * pick->nearest[i].value;
        denominator += weight;
    }
    return numerator / denominator;
}

static double project(const struct view *view, const struct pick_case *site, const double place_m[3], double *x_px, double *y_px)
{
    double m[16], projection[16], eye[4], clip[4] = { 0 };
    camera_matrices(&view->camera, (double)view->width_px / view->height_px, site->scene->bounds_min_m, site->scene->bounds_max_m, m,
                    projection);
    for (int row = 0; row < 4; row++)
        eye[row] = m[row] * place_m[0] + m[4 + row] * place_m[1] + m[8 + row] * place_m[2] + m[12 + row];
    for (int row = 0; row < 4; row++)
        for (int c = 0; c < 4; c++)
            clip[row] += projection[4 * c + row] * eye[c];
    *x_px = (0.5 + 0.5 * clip[0] / clip[3]) * view->width_px;
    *y_px = (0.5 - 0.5 * clip[1] / clip[3]) * view->height_px;
    return 0.5 - 0.5 * clip[2] / clip[3];
}

/* Returns the measured value of the pixel or of that neighbour whose depth is closest to the pick's depth, because at a
   silhouette the renderer may assign a point to the pixel next to it. */
static const float *same_place(const float (*measured)[4], int x, int y, double depth)
{
    const float *best = measured[y * WIDTH_PX + x];
    for (int v = y - 1; v <= y + 1; v++)
        for (int u = x - 1; u <= x + 1; u++)
            if (fabs((double)measured[v * WIDTH_PX + u][3] - depth) < 0.2 * fabs((double)best[3] - depth))
                best = measured[v * WIDTH_PX + u];
    return best;
}

static void compare_pixel(struct pick_case *site, const struct view *view, const float (*measured)[4], int x, int y,
                          struct pick_tally *tally)
{
    struct pick pick;
    struct timespec began, ended;
    double x_px, y_px;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &began);
    pick_at(site->scene, site->field, view, site->snapshot, x + 0.5, y + 0.5, &pick);
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &ended);
    double ms = (double)(ended.tv_sec - began.tv_sec) * 1e3 + (double)(ended.tv_nsec - began.tv_nsec) / 1e6;
    tally->longest_ms = fmax(tally->longest_ms, ms);
    const float *centre = measured[y * WIDTH_PX + x];
    tally->compared++;
    if (pick.asset < 0) {
        tally->differ += centre[1] > MEASURE_NOTHING;
        return;
    }
    if (pick.inside) { /* picks on a section cap (filled cut face) have no value, so there is nothing to compare */
        tally->inside++;
        assert_true(pick.state == PICK_CONTEXT && isnan(pick.value));
        return;
    }
    double depth = project(view, site, pick.position_m, &x_px, &y_px);
    tally->worst_px = fmax(tally->worst_px, hypot(x_px - x - 0.5, y_px - y - 0.5));
    const float *pixel = same_place(measured, x, y, depth);
    if (fabs((double)pixel[3] - depth) > 1e-3 * depth + 1e-5) {
        tally->moved++;
        return;
    }
    bool context = pixel[1]<0, no_data = pixel[1]> 0.5f;
    if (pick.state == PICK_CONTEXT) {
        tally->context++;
        tally->differ += !context;
    } else if (pick.state == PICK_NO_DATA) {
        tally->no_data++;
        tally->differ += !no_data;
    } else if (context || no_data) {
        tally->differ++;
    } else {
        double range = view->range_max - view->range_min;
        double error = fabs((pick.value - view->range_min) / range - (double)pixel[0]);
        bool marked = pixel[2] > 0.5f;
        tally->marked += marked;
        tally->marked_right += marked && error <= 1.0 / 255;
        tally->worst_value = fmax(tally->worst_value, marked ? 0 : error);
        tally->over += !marked && error > 1.0 / 255;
        /* with PICK_NEAREST or more sensors within reach, the pick reports only the nearest ones, and their sum would be
           incomplete */
        if (pick.nearest_count < PICK_NEAREST)
            tally->worst_sum = fmax(tally->worst_sum, fabs(slow_value(site, view, &pick) - pick.value) / range);
    }
}

static void compare_view(struct pick_case *site, const struct view *view, int count, struct pick_tally *tally)
{
    float(*measured)[4] = mem_array(PIXELS, sizeof(*measured));
    assert_true(renderer_measure(site->renderer, view, site->snapshot, true, measured));
    for (int i = 0; i < count; i++) {
        int x = 1 + (int)((WIDTH_PX - 2) * synthetic_random_unit(&site->random));
        int y = 1 + (int)((HEIGHT_PX - 2) * synthetic_random_unit(&site->random));
        compare_pixel(site, view, (const float(*)[4])measured, x, y, tally);
    }
    mem_free(measured);
}

static void say(const struct pick_tally *tally)
{
    print_message(
        "# %d picks: %d context, %d inside, %d no data; elsewhere %d, other %d; marked %d, %d of them right; "
        "worst %.4f of the range, sums %.4f, %.3f px, %.2f ms\n",
        tally->compared, tally->context, tally->inside, tally->no_data, tally->moved, tally->differ, tally->marked, tally->marked_right,
        tally->worst_value, tally->worst_sum,
        tally->worst_px, tally->longest_ms);
}

static void assert_exact(const struct pick_tally *tally)
{
    say(tally);
    assert_true(tally->worst_value <= 1.0 / 255);
    assert_true(tally->worst_px < 1e-3);
    assert_in_range(tally->differ, 0, tally->compared / 200); /* up to 0.5 % differ at borders of hatched areas */
    assert_in_range(tally->moved, 0, tally->compared / 50);   /* up to 2 % hit another surface, at silhouettes and thin railings */
    if (sweep_is_whole())
        assert_true(tally->longest_ms < 10);
}

static void stand_site(struct stand *stand, struct pick_case *site)
{
    *site =
        (struct pick_case){ .scene = &stand->toy->scene, .field = stand->field, .renderer = stand->renderer, .snapshot = stand->snapshot };
    fill(site);
}

TEST(test_small_plant)
{
    struct stand stand;
    struct pick_case site;
    struct view view;
    stand_init(&stand, &rig, toy_unit());
    stand_site(&stand, &site);
    for (int way = 0; way < 12; way++) {
        struct pick_tally tally = { 0 };
        view_default(site.scene, WIDTH_PX, HEIGHT_PX, &view);
        view.tier = way & 1 ? TIER_REFINED : TIER_PREVIEW;
        view.field.distance = way & 2 ? DISTANCE_EUCLIDEAN : DISTANCE_GEODESIC;
        view.camera.height_m = way & 4 ? 6 : 0;
        if (way >= 8) {
            asset_set_add(&view.visibility.hidden, 2);
            asset_set_add(&view.visibility.ghosts, 1);
            view.visibility.clip = (struct clip){ .plane_count = 1, .planes = { { 0.6, 0.8, 0, 0.3 } } };
        }
        compare_view(&site, &view, 3000, &tally);
        assert_exact(&tally);
        assert_true(way < 8 || tally.inside > 50);
        /* a pick's value is computed from the distances at that point, not interpolated between the triangle's corners */
        assert_true(tally.worst_sum < 1.0 / 255);
    }
    stand_finish(&stand);
}

/* A realistic size: several assets with tens of thousands of triangles, one behind another. */
TEST(test_demo_plant)
{
    struct diag diag = { 0 };
    struct plant *plant = plant_load("build/demo/plant.yaml", &diag);
    diag_finish(&diag);
    struct scene *scene = plant ? scene_create(rig.log, plant, "build/demo/plant.prepared") : NULL;
    assert_non_null(scene);
    struct pick_case site = { .scene = scene, .snapshot = snapshot_create(plant->tag_count) };
    site.field = field_create(rig.workers, scene);
    site.renderer = renderer_create(rig.log, rig.gl, scene, site.field);
    assert_non_null(site.renderer);
    fill(&site);
    for (int side = SIDE_FRONT; side <= SIDE_ISO; side++) {
        struct pick_tally tally = { 0 };
        struct view view;
        view_default(scene, WIDTH_PX, HEIGHT_PX, &view);
        view.tier = TIER_PREVIEW;
        view.camera.height_m = side & 1;
        struct framing framing = { .asset = -1, .tag = -1, .side = (enum side)side };
        framing_look(scene, &framing, (double)WIDTH_PX / HEIGHT_PX, &view.camera);
        compare_view(&site, &view, 2000, &tally);
        say(&tally);
        assert_true(tally.worst_px < 1e-3 && tally.longest_ms < 10);
        assert_in_range(tally.over, 0, tally.compared / 300);                /* GL and picks may differ at silhouettes */
        assert_in_range(tally.moved + tally.differ, 0, tally.compared / 10); /* much of the demo plant is thinner than a pixel */
    }
    renderer_destroy(&site.renderer);
    field_destroy(&site.field);
    snapshot_destroy(&site.snapshot);
    scene_destroy(&scene);
    plant_destroy(&plant);
}

TEST(test_sensors)
{
    struct stand stand;
    struct pick_case site;
    struct view view;
    struct pick pick;
    stand_init(&stand, &rig, toy_unit());
    stand_site(&stand, &site);
    for (int i = 0; i < 8; i++)
        toy_set(site.snapshot, i, 20 + 7 * i, QUALITY_GOOD);
    view_default(site.scene, WIDTH_PX, HEIGHT_PX, &view);
    struct frame *frame = stand_draw(&stand, &view);
    int seen = 0;
    for (size_t i = 0; i < frame->marker_count; i++) {
        const struct frame_marker *marker = &frame->markers[i];
        pick_at(site.scene, site.field, &view, site.snapshot, (double)marker->x_px, (double)marker->y_px, &pick);
        if (pick.sensor != marker->tag) /* the pick hit the marker of another sensor in front of this one */
            continue;
        assert_int_equal(pick.sensor_occluded, marker->occluded);
        if (marker->occluded)
            continue;
        seen++;
        assert_int_equal(pick.state, PICK_MEASURED);
        assert_int_equal(pick.nearest[0].tag, marker->tag);
        assert_true(pick.nearest[0].distance_m < 0.05 && fabs(pick.value - (20 + 7 * marker->tag)) < 1);
        toy_set(site.snapshot, marker->tag, 50, QUALITY_BAD_COMMUNICATION_ERROR);
        pick_at(site.scene, site.field, &view, site.snapshot, (double)marker->x_px, (double)marker->y_px, &pick);
        assert_int_equal(pick.state, PICK_NO_DATA);
        for (int n = 0; n < pick.nearest_count; n++)
            assert_int_not_equal(pick.nearest[n].tag, marker->tag);
        toy_set(site.snapshot, marker->tag, 20 + 7 * marker->tag, QUALITY_GOOD);
    }
    assert_true(seen >= 3);
    frame_unref(&frame);
    pick_at(site.scene, site.field, &view, site.snapshot, -1, 5, &pick);
    assert_true(pick.asset == -1 && pick.sensor == -1);
    stand_finish(&stand);
}

/* Where all places are assumed, one sensor colours an asset: in the operator view one with limits. A pick names the sensor that
   colours the asset, and its reading. */
TEST(test_assumed_places)
{
    struct stand stand;
    struct pick_case site;
    struct view view;
    struct pick pick = { .asset = -1 };
    double x_px = 0;
    stand_init(&stand, &rig, toy_unit());
    stand_site(&stand, &site);
    for (int i = 0; i < 8; i++) {
        stand.toy->plant.tags[i].place.assumed = true;
        toy_set(site.snapshot, i, 50, QUALITY_GOOD);
    }
    stand.toy->plant.tags[0].alarms.limits[LIMIT_L] = 40;
    stand.toy->plant.tags[0].alarms.limits[LIMIT_H] = 60;
    toy_set(site.snapshot, 0, 52, QUALITY_GOOD);
    toy_set(site.snapshot, 1, 95, QUALITY_GOOD);
    view_default(site.scene, WIDTH_PX, HEIGHT_PX, &view);
    for (; pick.asset != stand.toy->plant.tags[0].asset && x_px < WIDTH_PX; x_px++)
        pick_at(site.scene, site.field, &view, site.snapshot, x_px, HEIGHT_PX / 2.0, &pick);
    assert_true(pick.assumed && pick.nearest_count == 1 && pick.nearest[0].tag == 1 && pick.value == 95);
    view.field.show = SHOW_OPERATOR;
    pick_at(site.scene, site.field, &view, site.snapshot, x_px - 1, HEIGHT_PX / 2.0, &pick);
    assert_true(pick.assumed && pick.nearest_count == 1 && pick.nearest[0].tag == 0 && pick.value == 52);
    stand.toy->plant.tags[0].alarms.limits[LIMIT_L] = stand.toy->plant.tags[0].alarms.limits[LIMIT_H] = NAN;
    view.range_max = 99; /* another view: none of the tags has limits */
    pick_at(site.scene, site.field, &view, site.snapshot, x_px - 1, HEIGHT_PX / 2.0, &pick);
    assert_true(pick.assumed && pick.nearest_count == 1);
    stand_finish(&stand);
}

/* In a split view, a pick must use the view of the half in which it lies. */
TEST(test_split_view)
{
    struct stand stand;
    struct pick_case site;
    struct view view, right;
    struct pick left_pick, right_pick;
    stand_init(&stand, &rig, toy_unit());
    stand_site(&stand, &site);
    view_default(site.scene, WIDTH_PX, HEIGHT_PX, &view);
    right = view;
    right.field.interpolation = INTERPOLATION_PAPER;
    view_split(&view, &right);
    pick_at(site.scene, site.field, &view, site.snapshot, 160.5, 200.5, &left_pick);
    pick_at(site.scene, site.field, &view, site.snapshot, 480.5, 200.5, &right_pick);
    assert_true(left_pick.asset >= 0 && left_pick.asset == right_pick.asset);
    for (int i = 0; i < 3; i++)
        assert_float_equal(left_pick.position_m[i], right_pick.position_m[i], 1e-9);
    stand_finish(&stand);
}
