/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The lists of near sensors with which GL evaluates fields of many sensors (render/gl/sensor_cells.h). Pixels are compared with plain
   sums over all sensors in double precision, and their flags with pixel_field_at(). */
#include "tests/support/test.h"

#include "field/trials.h"
#include "render/gl/gl_backend.h"
#include "render/pick/pick.h"
#include "render/renderer_impl.h"
#include "tests/support/planned.h"
#include "tests/support/renderer_compare.h"
#include "tests/support/rig_case.h"
#include "tests/support/synthetic.h"
#include "value/quality.h"

enum { WIDTH_PX = 320, HEIGHT_PX = 180, PIXELS = WIDTH_PX * HEIGHT_PX, MOST_SENSORS = 4096, SPOTS = 5 };
/* SNAP_PX: rasterizers round triangle corners to 1/256 pixel, so a pixel shows a point up to about that far away. APART_M: a pixel
   whose spots are farther apart shows the edge of a surface */
static const double STEP = 1.0 / 255, SIDE_M = 4, SNAP_PX = 1.0 / 256, APART_M = 0.05;
/* largest error that lists may cause, in steps: 0.5, and rounding */
static const double MOST_STEPS = 0.55;
static uint64_t random_state;

struct cells_tally {
    int pixels, no_data, uncertain, flags, flags_off;
    double worst; /* largest error in steps, beyond what the place explains */
};

static double between(double low, double high)
{
    return low + (high - low) * synthetic_random_unit(&random_state);
}

/* --- the plain sum ---------------------------------------------------------------------------------------------------------- */

static double distance_of(const struct pixel_sensor *sensor, const float at_m[3])
{
    double square = 0;
    for (int c = 0; c < 3; c++)
        square += pow((double)at_m[c] - (double)sensor->place_m[c], 2);
    return fmax(sqrt(square), 1e-15);
}

/* Returns the logarithm of the sensor's weight at this distance; -INFINITY: its weight is 0. */
static double log_weight(const struct pixel_field *field, const struct pixel_sensor *sensor, double distance)
{
    double reach = field->reach_m < INFINITY ? 2 * log(fmax(0, 1 - distance / (double)field->reach_m)) : 0;
    double near = fmax(0, 1 - distance / (double)field->radius_m);
    return reach + (field->paper ? near * (double)sensor->strength : log((double)sensor->strength) - (double)field->power * log(distance));
}

static double truth_at(const struct pixel_field *field, const float at_m[3])
{
    double top = -INFINITY, total = 0, sum = 0;
    for (int pass = 0; pass < 2; pass++)
        for (int i = 0; i < field->count; i++) {
            const struct pixel_sensor *sensor = &field->sensors[i];
            double distance = distance_of(sensor, at_m), log = log_weight(field, sensor, distance);
            if (!(sensor->state & PIXEL_USABLE) || log == -INFINITY)
                continue;
            if (pass == 0) {
                top = fmax(top, log);
                continue;
            }
            double near = fmax(0, 1 - distance / (double)field->radius_m), weight = exp(log - top);
            total += weight;
            sum += weight * (double)sensor->value * (field->paper ? pow(near, (double)sensor->decay) : 1);
        }
    return sum / total * (double)field->scale + (double)field->offset;
}

/* --- the plant -------------------------------------------------------------------------------------------------------------- */

/* Sets up a plant of one asset: two plates, one of them of large triangles, a sphere and a small box. Some sensors lie at corners, on
   edges and at the same point as another one; the others lie on the plates. */
static void stand_on_plates(struct stand *stand, int sensors)
{
    struct toy *toy = toy_create();
    struct test_shape shape = { 0 };
    double(*places)[3] = mem_array((size_t)sensors, sizeof(*places));
    shape_plate(&shape, TOY_STEEL, (double[3]){ 0, 0, 0 }, (double[3]){ SIDE_M, 0, 0 }, (double[3]){ 0, SIDE_M, 0 }, 1);
    shape_plate(&shape, TOY_BLUE, (double[3]){ 0, 0, 0.5 }, (double[3]){ SIDE_M / 2, 0, 1 }, (double[3]){ 0.5, SIDE_M, 0.3 }, 6);
    shape_sphere(&shape, TOY_BLUE, (double[3]){ 3, 2, 0.7 }, 0.5, 8);
    shape_box(&shape, TOY_STEEL, (double[3]){ 3, 3.5, 0.2 }, (double[3]){ 3.05, 3.55, 0.9 });
    for (int i = 0; i < sensors; i++) {
        double u = between(0, 1), v = between(0, 1);
        for (int c = 0; c < 3; c++)
            places[i][c] = i % 3 ? (c == 0   ? SIDE_M * u
                                    : c == 1 ? SIDE_M * v
                                             : 0)
                                 : (c == 0   ? SIDE_M / 2 * u + 0.5 * v
                                    : c == 1 ? SIDE_M * v
                                             : 0.5 + u + 0.3 * v);
        if (i % 7 == 3) /* at the previous sensor's place or, for every second, a micrometre away */
            memcpy(places[i], places[i - 1], sizeof(places[i]));
        places[i][0] += i % 14 == 3 ? 1e-6 : 0;
    }
    memcpy(places, (double[3][3]){ { SIDE_M, 0, 0 }, { 0, SIDE_M / 2, 0 }, { 3.05, 3.55, 0.9 } }, 3 * sizeof(*places));
    toy_add(toy, "PLATES", &shape, (double[3]){ 0, 0, 0 }, (const double(*)[3])places, (size_t)sensors);
    struct asset_sensor *made = (struct asset_sensor *)toy->scene.assets[0].file->view.sensors;
    for (int i = 0; i < sensors; i++)
        for (int c = 0; c < 3; c++)
            made[i].surface_m[c] = (float)places[i][c];
    toy->plant.groups[0].hot_spot_m = 0.3;
    mem_free(places);
    stand_init(stand, &rig, toy);
}

/* Changes all readings. odd: some sensors are Bad, others Uncertain. */
static void fill(struct stand *stand, int sensors, bool odd)
{
    for (int i = 0; i < sensors; i++)
        toy_set(stand->snapshot, i, between(0, 100),
                odd && i % 11 == 5  ? QUALITY_BAD_COMMUNICATION_ERROR
                : odd && i % 5 == 1 ? QUALITY_UNCERTAIN_SENSOR_NOT_ACCURATE
                                    : QUALITY_GOOD);
}

static struct sensor_cells *cells_of(const struct stand *stand, const struct field_params *params)
{
    for (size_t i = 0; i < stand->renderer->fields.count; i++)
        if (field_params_equal(&stand->renderer->fields.entries[i]->params, params))
            return stand->renderer->fields.entries[i]->cells;
    return NULL;
}

/* --- comparing -------------------------------------------------------------------------------------------------------------- */

/* Picks the points that the pixel may show: at its centre, and around it. Returns false if they are not close to each other. */
static bool find_spots(const struct stand *stand, const struct view *view, int x, int y, float spots_m[SPOTS][3])
{
    for (int i = 0; i < SPOTS; i++) {
        struct pick pick;
        double right = i == 0 ? 0 : i % 2 ? SNAP_PX : -SNAP_PX, down = i == 0 ? 0 : i > 2 ? SNAP_PX : -SNAP_PX;
        pick_at(&stand->toy->scene, stand->field, view, stand->snapshot, x + 0.5 + right, y + 0.5 + down, &pick);
        if (pick.asset < 0)
            return false;
        for (int c = 0; c < 3; c++) {
            spots_m[i][c] = (float)pick.position_m[c];
            if (fabs((double)(spots_m[i][c] - spots_m[0][c])) > APART_M)
                return false;
        }
    }
    return true;
}

static void compare_pixel(const struct pixel_field *field, const struct view *view, const float pixel[4], float spots_m[SPOTS][3],
                          struct cells_tally *tally)
{
    double low = INFINITY, high = -INFINITY, range = view->range_max - view->range_min;
    struct pixel_value plain[SPOTS];
    bool same = true;
    for (int i = 0; i < SPOTS; i++) {
        pixel_field_at(field, spots_m[i], &plain[i]);
        same &= plain[i].no_data == plain[0].no_data && plain[i].uncertain == plain[0].uncertain;
    }
    if (!same)
        return;
    tally->flags++;
    tally->flags_off += (pixel[1] > 0.5f) != plain[0].no_data || (!plain[0].no_data && (pixel[2] > 0.5f) != plain[0].uncertain);
    tally->uncertain += plain[0].uncertain;
    tally->no_data += plain[0].no_data;
    if (plain[0].no_data)
        return;
    for (int i = 0; i < SPOTS; i++) {
        double truth = field->show == PIXEL_SUM ? truth_at(field, spots_m[i]) : (double)plain[i].value;
        low = fmin(low, (truth - view->range_min) / range);
        high = fmax(high, (truth - view->range_min) / range);
    }
    double off = fmax(low - (double)pixel[0], (double)pixel[0] - high) / STEP;
    tally->worst = fmax(tally->worst, isnan(pixel[0]) ? INFINITY : off);
    tally->pixels++;
}

static void compare(struct stand *stand, const struct view *view, int picks, struct cells_tally *tally)
{
    struct pixel_field field;
    float(*measured)[4] = mem_array(PIXELS, sizeof(*measured));
    assert_true(renderer_measure(stand->renderer, view, stand->snapshot, true, measured));
    field_pixels(stand->field, 0, &view->field, &field);
    assert_true(field.count > 0);
    for (int i = 0; i < picks; i++) {
        int x = (int)between(0, WIDTH_PX), y = (int)between(0, HEIGHT_PX);
        float spots_m[SPOTS][3];
        const float *pixel = measured[y * WIDTH_PX + x];
        if (pixel[1] >= 0 && find_spots(stand, view, x, y, spots_m))
            compare_pixel(&field, view, pixel, spots_m, tally);
    }
    pixel_field_finish(&field);
    mem_free(measured);
}

/* Chooses a random camera above the scene that roughly fills the image. */
static void look(const struct scene *scene, struct view *view)
{
    double forward[3] = { between(-1, 1), between(-1, 1), between(-2, -0.5) }, nearer = between(0.5, 1);
    view_default(scene, WIDTH_PX, HEIGHT_PX, view);
    view->tier = TIER_PREVIEW;
    view->field.distance = DISTANCE_EUCLIDEAN;
    camera_fit_along(&view->camera, forward, scene->bounds_min_m, scene->bounds_max_m, (double)WIDTH_PX / HEIGHT_PX,
                     &(struct camera_window){ 0 });
    for (int c = 0; c < 3; c++)
        view->camera.eye_m[c] = view->camera.target_m[c] + nearer * (view->camera.eye_m[c] - view->camera.target_m[c]);
}

static const struct cells_way {
    const char *name;
    double power, radius_m, reach_m; /* radius_m above 0: interpolation paper */
    enum field_show show;
    bool fill;
    int most_near; /* largest mean length of a list with 512 sensors */
} ways[] = {
    { "power 2", 2, 0, INFINITY, SHOW_VALUE, false, 24 },       { "power 6", 6, 0, INFINITY, SHOW_VALUE, true, 24 },
    { "power 16", 16, 0, INFINITY, SHOW_VALUE, false, 24 },     { "power 0.5", 0.5, 0, INFINITY, SHOW_VALUE, false, 24 },
    { "paper", 0, 1.5, INFINITY, SHOW_VALUE, false, 32 },       { "paper with reach", 0, 3, 0.8, SHOW_VALUE, true, 64 },
    { "power 2 with reach", 2, 0, 0.7, SHOW_VALUE, false, 64 }, { "hot spots", 2, 0, INFINITY, SHOW_BLIND, false, 512 },
};
enum { WAYS = sizeof(ways) / sizeof(ways[0]) };

static void set_way(const struct stand *stand, const struct cells_way *way, struct view *view)
{
    look(&stand->toy->scene, view);
    view->field.power = way->power > 0 ? way->power : view->field.power;
    if (way->radius_m > 0)
        view->field.interpolation = INTERPOLATION_PAPER, view->field.radius_m = way->radius_m;
    view->field.reach_m = way->reach_m;
    view->field.fill = way->fill ? FILL_NEIGHBOURS : FILL_NONE;
    if (way->show != SHOW_VALUE) {
        field_params_set_show(stand->toy->scene.plant, &view->field, way->show);
        view_default_scale(&stand->toy->scene, view);
    }
}

static void expect_right(const char *name, int sensors, const struct cells_tally *tally, const struct sensor_cells_tally *lists)
{
    print_message("# %d sensors, %s: %d pixels off by %.3f steps at most, %d without data, %d uncertain; %d of %d flags off; %zu lists of "
                  "%.1f, %zu overflow\n",
                  sensors, name, tally->pixels, tally->worst, tally->no_data, tally->uncertain, tally->flags_off, tally->flags,
                  lists->lists, (double)lists->near / (double)lists->lists, lists->overflowing);
    assert_true(tally->worst <= MOST_STEPS);
    /* whether more than half of the weights are uncertain may differ where they are nearly half */
    assert_true(tally->flags_off <= tally->flags / 100);
}

/* first_round: 0, or 2 if making the lists takes so long that a default run makes them only once */
static void compare_ways(int sensors, int first, int every, int first_round, int picks)
{
    struct stand stand;
    random_state = sweep_seed();
    stand_on_plates(&stand, sensors);
    for (int i = first; i < WAYS; i += every) {
        struct view view;
        struct cells_tally tally = { 0 };
        set_way(&stand, &ways[i], &view);
        /* round 0: all sensors are good; 1: the same lists for other readings; 2: also lost and uncertain sensors */
        for (int round = first_round; round < 3; round++) {
            fill(&stand, sensors, round == 2);
            compare(&stand, &view, picks / (3 - first_round), &tally);
        }
        struct sensor_cells_tally lists = sensor_cells_count(cells_of(&stand, &view.field));
        assert_true(lists.lists > 0);
        expect_right(ways[i].name, sensors, &tally, &lists);
        assert_true(tally.pixels + tally.no_data > picks / 10);
        assert_true(lists.near <= (size_t)ways[i].most_near * lists.lists || sensors != 512);
    }
    stand_finish(&stand);
}

TEST(test_17_sensors)
{
    compare_ways(SENSOR_CELLS_FEW + 1, 0, 1, 0, sweep(6000, 600));
}

TEST(test_64_sensors)
{
    compare_ways(64, 0, sweep(1, 3), 0, sweep(6000, 600));
}

TEST(test_512_sensors)
{
    compare_ways(512, 1, sweep(1, 3), sweep(0, 2), sweep(6000, 300));
}

TEST(test_4096_sensors)
{
    compare_ways(MOST_SENSORS, 0, sweep(1, 8), sweep(0, 2), sweep(6000, 150));
}

/* --- whether lists are used ------------------------------------------------------------------------------------------------- */

static void expect_share_without_data(struct stand *stand, const struct view *view, double low, double high)
{
    int shown = 0, no_data = 0;
    float(*measured)[4] = mem_array(PIXELS, sizeof(*measured));
    assert_true(renderer_measure(stand->renderer, view, stand->snapshot, true, measured));
    for (int i = 0; i < PIXELS; i++) {
        shown += measured[i][1] >= 0;
        no_data += measured[i][1] > 0.5f;
    }
    mem_free(measured);
    assert_true(shown > PIXELS / 10 && no_data >= low * shown && no_data <= high * shown);
}

/* Sets up plates with this number of sensors, gives each a reading, and chooses a camera. */
static void show_plates(struct stand *stand, struct view *view, int sensors)
{
    random_state = sweep_seed();
    stand_on_plates(stand, sensors);
    fill(stand, sensors, false);
    look(&stand->toy->scene, view);
}

/* Overwrites the lists by empty ones without sensors: a fragment that uses its list then shows no data. */
TEST(test_fragments_use_lists)
{
    struct stand stand;
    struct view view;
    show_plates(&stand, &view, 64);
    expect_share_without_data(&stand, &view, 0, 0);
    glClearNamedBufferData(cells_of(&stand, &view.field)->lists, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, NULL);
    expect_share_without_data(&stand, &view, 0.999, 1);
    /* changed readings make new lists */
    fill(&stand, 64, false);
    expect_share_without_data(&stand, &view, 0, 0);
    stand_finish(&stand);
}

TEST(test_few_sensors_have_no_lists)
{
    struct stand stand;
    struct view view;
    struct cells_tally tally = { 0 };
    show_plates(&stand, &view, SENSOR_CELLS_FEW);
    compare(&stand, &view, 300, &tally);
    assert_null(cells_of(&stand, &view.field));
    assert_true(tally.pixels > 50 && tally.worst <= MOST_STEPS && tally.flags_off == 0);
    stand_finish(&stand);
}

/* --- changes ---------------------------------------------------------------------------------------------------------------- */

TEST(test_moved_sensor)
{
    struct stand stand;
    struct view view;
    struct cells_tally tally = { 0 };
    show_plates(&stand, &view, 64);
    struct trials *trials = trials_create();
    field_set_trials(stand.field, trials);
    compare(&stand, &view, 300, &tally);
    struct trial_sensor moved = { .tag = 5, .surface_m = { 1, 3, 0 }, .place_m = { 1, 3, 0 } };
    view.field.trial = trials_put(trials, &moved, 1);
    compare(&stand, &view, 300, &tally);
    struct sensor_cells_tally lists = sensor_cells_count(cells_of(&stand, &view.field));
    expect_right("one moved", 64, &tally, &lists);
    assert_true(lists.lists > 0);
    stand_finish(&stand);
    trials_destroy(&trials);
}

static struct frame *end_job(struct renderer *renderer, struct render_job *job)
{
    while (!renderer_step(renderer, job, INT64_MAX)) {
    }
    struct frame *frame = renderer_end(renderer, &job);
    assert_non_null(frame);
    return frame;
}

/* A frame in progress shows the readings with which it began, although other lists were made meanwhile. */
TEST(test_frame_in_progress_keeps_its_lists)
{
    struct stand stand;
    struct view view;
    show_plates(&stand, &view, 64);
    renderer_use_gl(stand.renderer, true);
    view.tier = TIER_REFINED;
    struct frame *before = end_job(stand.renderer, planned_begin(stand.renderer, &view, stand.snapshot));
    struct render_job *job = planned_begin(stand.renderer, &view, stand.snapshot);
    fill(&stand, 64, true);
    struct frame *other = end_job(stand.renderer, planned_begin(stand.renderer, &view, stand.snapshot));
    struct frame *after = end_job(stand.renderer, job);
    size_t bytes = (size_t)before->stride_bytes * HEIGHT_PX;
    assert_memory_equal(before->bgrx, after->bgrx, bytes);
    assert_true(memcmp(before->bgrx, other->bgrx, bytes) != 0);
    frame_unref(&before);
    frame_unref(&other);
    frame_unref(&after);
    stand_finish(&stand);
}

/* After a lost context, everything on the GPU is made again. */
TEST(test_lost_context)
{
    struct stand stand;
    struct view view;
    struct cells_tally tally = { 0 };
    enum gl_kind kind = rig.gl->kind;
    show_plates(&stand, &view, 64);
    compare(&stand, &view, 300, &tally);
    gl_lose(rig.gl);
    renderer_destroy(&stand.renderer);
    gl_destroy(&rig.gl);
    rig.gl = gl_create(rig.log, kind, NULL);
    stand.renderer = renderer_create(rig.log, rig.gl, &stand.toy->scene, stand.field);
    assert_non_null(stand.renderer);
    compare(&stand, &view, 300, &tally);
    struct sensor_cells_tally lists = sensor_cells_count(cells_of(&stand, &view.field));
    expect_right("another context", 64, &tally, &lists);
    assert_true(lists.lists > 0);
    stand_finish(&stand);
}
