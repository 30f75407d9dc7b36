/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Moving a sensor on a loaded asset computes the distances from its new position. They must equal those that plantcast-prep
   would store. Each request must get exactly one answer, and invalid requests are refused. */
#include "surface/relocation.h"

#include "tests/support/test.h"
#include <pthread.h>
#include <stdatomic.h>

#include "base/clock.h"
#include "base/files/cache_file.h"
#include "placing/mover.h"
#include "protocol/asset_distance.h"
#include "scene/asset.h"
#include "scene/scene_create.h"
#include "surface/surface_store.h"
#include "tests/support/cad.h"
#include "tests/support/model_maker.h"
#include "tests/support/prep_case.h"
#include "tests/support/sleep.h"

#define FAR 3e-3  /* of the largest distance */
/* metres; points nearer than this to the surface count as on it: when cracks are bridged, the surface moves by less */
#define ON 1e-3
#define SEEN 1e-5 /* metres; a vertex of the finest level that is this near to the visible surface counts as visible */
#define NEAR 0.05 /* metres; the same limit for vertices that only coarser levels have, because these lie off the surface */

struct result_box { /* receives a result */
    pthread_mutex_t lock;
    pthread_cond_t came;
    struct relocation_result result;
    int count, done_count;
};

static void box_init(struct result_box *box)
{
    *box = (struct result_box){ .lock = PTHREAD_MUTEX_INITIALIZER, .came = PTHREAD_COND_INITIALIZER };
}

static void put_into_box(void *arg, struct relocation_result *result)
{
    struct result_box *box = arg;
    pthread_mutex_lock(&box->lock);
    mem_free(box->result.geodesic_m);
    box->result = *result;
    box->done_count += result->status == RELOCATION_DONE;
    box->count++;
    pthread_cond_broadcast(&box->came);
    pthread_mutex_unlock(&box->lock);
}

static void wait_for(struct result_box *box, int count)
{
    pthread_mutex_lock(&box->lock);
    while (box->count < count)
        pthread_cond_wait(&box->came, &box->lock);
    pthread_mutex_unlock(&box->lock);
}

static struct log *the_log;
static struct workers *workers;

static int set_up(void **state)
{
    the_log = log_create(LOG_ERROR);
    workers = workers_create(2);
    return prep_case_set_up(state);
}

static int tear_down(void **state)
{
    workers_destroy(&workers);
    log_destroy(&the_log);
    return prep_case_tear_down(state);
}

/* --- against plantcast-prep --------------------------------------------------------------------------------------------------- */

static struct relocation_shape finest_of(const struct asset *asset)
{
    const struct asset_view *view = &asset->view;
    const struct asset_level *finest = &view->levels[0];
    const struct asset_primitive *first = &view->primitives[finest->first_primitive], *last = first + finest->primitive_count - 1;
    return (struct relocation_shape){ .positions_m = view->positions_m,
                                      .normals = view->normals,
                                      .vertex_count = finest->vertex_count,
                                      .triangles = view->indices + first->first_index,
                                      .triangle_count = (last->first_index + last->index_count - first->first_index) / 3 };
}

static struct asset *prepared(struct prep_case *c)
{
    char *model = realpath("build/demo/plant.glb", NULL);
    if (!model) {
        print_message("# skipped: there is no build/demo/plant.glb\n");
        skip();
    }
    char *yaml = test_printf("plant: { name: Moved }\n"
                            "assets: [{ id: E-101, model: %s, nodes: E-101, up: y }]\n"
                            "groups: [{ id: t, unit: K, min: 0, max: 1 }]\n"
                            "tags: tags.csv\n",
                            model);
    prep_case_plant(c, yaml);
    prep_case_tags(c, "a,,,,t,E-101,,-15.83,-8.68,2.09\n"
                      "b,,,,t,E-101,,-16.0,-7.53,2.18\n"
                      "c,,,,t,E-101,,-16.26,-3.7057,1.1497\n");
    prep_case_expect(c, "$PLANT --report json", 0);
    json_t *report = prep_case_json(&c->out);
    const char *file = json_string_value(json_object_get(json_array_get(json_object_get(report, "assets"), 0), "file"));
    assert_non_null(file);
    char *path = test_printf("%s/plant.prepared/%s", c->folder, file);
    struct asset *asset = asset_open(the_log, path);
    assert_non_null(asset);
    free(model);
    return asset;
}

struct most {           /* limits for the differences between computed and stored distances, as shares of the largest distance */
    double mean, worst; /* limits for the mean and for the largest difference of the compared vertices */
    double far_share;   /* limit for the share of the finest level's visible vertices whose distances differ by more than FAR */
};

enum sight { UNSEEN, SEEN_FINEST, SEEN_COARSE };

/* Returns for each vertex whether it belongs to the finest level, only to coarser levels (which have errors), or is hidden
   inside another part. Hidden vertices are not compared, because plantcast-prep gives them the distance of any nearby point of
   the surface. */
static enum sight *sights_of(const struct relocation_shape *shape)
{
    struct cache_file kept;
    assert_true(cache_file_open_compressed(&kept, the_log, shape->surface_path, SURFACE_MAGIC, shape->surface_key));
    struct surface *surface = surface_unpack(&(struct unpack){ .at = kept.bytes, .left = kept.count }, the_log, workers);
    assert_non_null(surface);
    enum sight *sights = mem_array(shape->vertex_count, sizeof(*sights));
    size_t of_finest = 0, hidden = 0;
    for (size_t i = 0; i < 3 * shape->triangle_count; i++)
        sights[shape->triangles[i]] = SEEN_FINEST;
    for (size_t v = 0; v < shape->vertex_count; v++) {
        const float *p = shape->positions_m[v];
        struct surface_point hit;
        bool finest = sights[v] == SEEN_FINEST;
        surface_find_point(surface, (const double[3]){ (double)p[0], (double)p[1], (double)p[2] }, NULL, &hit);
        sights[v] = hit.distance_m >= (finest ? SEEN : NEAR) ? UNSEEN : finest ? SEEN_FINEST : SEEN_COARSE;
        of_finest += finest;
        hidden += finest && !sights[v];
    }
    print_message("# of %zu vertices of the finest level, %zu are inside another part; %zu only of others\n", of_finest, hidden,
                  shape->vertex_count - of_finest);
    assert_true(hidden < of_finest / 20);
    surface_destroy(&surface);
    cache_file_close(&kept);
    return sights;
}

static void compare(const struct asset *asset, size_t sensor, const struct relocation_result *result, const enum sight *sights,
                    enum sight which, const struct most *most)
{
    const struct asset_view *view = &asset->view;
    float *stored = mem_array(view->header->vertex_count, sizeof(*stored));
    double largest = 0, worst = 0, sum = 0, count = 0, far = 0, finest = 0;
    for (size_t v = 0; v < view->levels[0].vertex_count; v++) {
        stored[v] = asset_distance_m(view, sensor, v);
        assert_true(isfinite(stored[v]) == isfinite(result->geodesic_m[v]));
        if (isfinite(stored[v]))
            largest = fmax(largest, (double)stored[v]);
    }
    for (size_t v = 0; v < view->levels[0].vertex_count; v++) {
        double error = fabs((double)stored[v] - (double)result->geodesic_m[v]);
        finest += isfinite(stored[v]) && sights[v] == SEEN_FINEST;
        if (!isfinite(stored[v]) || sights[v] != which)
            continue;
        worst = fmax(worst, error);
        sum += error;
        far += error > FAR * largest;
        count++;
    }
    print_message("# sensor %zu: differs from the stored distances by %.4f %% on average, %.4f %% at most; by over %g %% at %g of %g\n",
                  sensor, 100 * sum / count / largest, 100 * worst / largest, 100 * FAR, far, count);
    assert_true(sum / count < most->mean * largest);
    assert_true(worst < most->worst * largest);
    assert_true(far <= most->far_share * finest);
    mem_free(stored);
}

static double distance(const float p[3], const double q[3])
{
    return hypot(hypot((double)p[0] - q[0], (double)p[1] - q[1]), (double)p[2] - q[2]);
}

static void try_sensors(const struct asset *asset, const struct relocation_shape *from, const enum sight *sights, const struct most most[2])
{
    struct relocation_shape shape = *from;
    struct relocation *relocation = relocation_create(the_log, workers, &shape);
    float *euclidean_m = mem_array(shape.vertex_count, sizeof(*euclidean_m));
    struct relocation_place cold;
    assert_true(relocation_place(relocation, (const double[3]){ 0, 0, 0 }, &cold, euclidean_m));
    for (size_t v = 0; v < shape.vertex_count; v++)
        assert_float_equal(euclidean_m[v], distance(shape.positions_m[v], cold.surface_m), 1e-5);
    while (relocation_state(relocation) == RELOCATION_WARMING)
        sleep_ns(NS_PER_MS);
    for (size_t s = 0; s < asset->view.header->sensor_count; s++) {
        const struct asset_sensor *sensor = &asset->view.sensors[s];
        const double point[3] = { (double)sensor->position_m[0], (double)sensor->position_m[1], (double)sensor->position_m[2] };
        struct relocation_place place;
        struct result_box box;
        box_init(&box);
        assert_true(relocation_place(relocation, point, &place, euclidean_m));
        for (int axis = 0; axis < 3; axis++)
            assert_float_equal(place.surface_m[axis], sensor->surface_m[axis], ON);
        assert_float_equal(place.distance_m, sensor->surface_distance_m, ON);
        assert_float_equal(euclidean_m[sensor->nearest_vertex], 0, ON);
        uint64_t ticket = relocation_request(relocation, point, put_into_box, &box);
        assert_true(ticket > 0);
        wait_for(&box, 1);
        assert_int_equal(box.result.status, RELOCATION_DONE);
        assert_int_equal(box.result.ticket, ticket);
        assert_int_equal(relocation_state(relocation), RELOCATION_WARM);
        compare(asset, s, &box.result, sights, SEEN_FINEST, &most[0]);
        compare(asset, s, &box.result, sights, SEEN_COARSE, &most[1]);
        mem_free(box.result.geodesic_m);
    }
    mem_free(euclidean_m);
    relocation_destroy(&relocation);
    assert_null(relocation);
}

TEST(a_moved_sensor_has_the_distances_that_would_be_stored)
{
    /* limits if the stored surface is used, for the first asset and for the second, whose parts intersect */
    static const struct most as_stored[] = { { 2e-4, 0.02, 2e-3 }, { 1e-3, 0.07, 0.0065 } };
    static const struct most as_made_anew[] = { { 5e-4, 0.05, 0.015 }, { 2e-3, 0.08, 0.014 } };
    struct asset *asset = prepared(*state);
    struct relocation_shape shape = finest_of(asset);
    char *path = prep_case_file(*state, ".surface", &shape.surface_key);
    shape.surface_path = path;
    enum sight *sights = test_memory(sights_of(&shape));
    try_sensors(asset, &shape, sights, as_stored);
    shape.surface_key++; /* the key no longer fits the stored surface, so it must not be used but be computed again */
    try_sensors(asset, &shape, sights, as_made_anew);
    asset_unref(&asset);
}

/* --- after plantcast-prep ran again, without a reload --------------------------------------------------------------------------- */

static void prepare_plate(struct prep_case *c, int slot)
{
    struct cad_random random;
    struct cad *cad = test_cad();
    cad_random_start(&random);
    cad_slotted_plate(cad, &random, 100, 60, 4, 4, 50, 2, slot);
    maker_write_cad(c->folder, "model.glb", "plate", cad);
    prep_case_plant(c, "plant: { name: Plate }\n"
                       "assets: [{ id: P, model: model.glb, up: z }]\n"
                       "groups: [{ id: t, unit: K, min: 0, max: 1 }]\n"
                       "tags: tags.csv\n");
    prep_case_tags(c, "a,,,,t,P,,0.5,0.5,0\n");
    prep_case_expect(c, "$PLANT", 0);
}

/* The daemon shows the old model until it reloads the plant. Until then, distances are those on the old model, too, not on the
   surface that plantcast-prep has stored for the new one, which has a slot. */
TEST(a_moved_sensor_stays_on_the_model_that_is_shown)
{
    struct prep_case *c = *state;
    const double from[3] = { 1, 0.5, 0 };
    struct result_box box;
    prepare_plate(c, 0);
    struct plant *plant = plant_load_or_print(c->plant);
    assert_non_null(plant);
    char *folder = test_memory(plant_prepared_folder(plant));
    struct scene *scene = scene_create(the_log, plant, folder);
    assert_non_null(scene);
    prepare_plate(c, 50);
    struct relocation *relocation = mover_create(the_log, workers, scene, folder, 0);
    const struct asset_view *view = &scene->assets[0].file->view;
    double worst_m = 0, moved_m[3];
    for (int axis = 0; axis < 3; axis++)
        moved_m[axis] = from[axis] - view->header->origin_m[axis];
    box_init(&box);
    assert_true(relocation_request(relocation, moved_m, put_into_box, &box) > 0);
    wait_for(&box, 1);
    assert_int_equal(box.result.status, RELOCATION_DONE);
    for (size_t v = 0; v < view->header->vertex_count; v++)
        worst_m = fmax(worst_m, fabs((double)box.result.geodesic_m[v] - distance(view->positions_m[v], moved_m)));
    print_message("# distances differ by up to %.4f m from those on the plate without a slot\n", worst_m);
    assert_true(worst_m < 0.05);
    mem_free(box.result.geodesic_m);
    relocation_destroy(&relocation);
    scene_destroy(&scene);
    plant_destroy(&plant);
}

/* --- refused, cancelled, broken ----------------------------------------------------------------------------------------------- */

static struct relocation_shape shape_of(const struct cad *cad)
{
    return (struct relocation_shape){ .positions_m = (const float(*)[3])cad->positions,
                                      .vertex_count = cad->vertex_count,
                                      .triangles = cad->triangles,
                                      .triangle_count = cad->triangle_count };
}

TEST(a_point_that_is_far_away_is_refused)
{
    struct cad *plate = test_cad();
    struct cad_random chance = { 5 };
    struct relocation_place place;
    struct result_box box;
    box_init(&box);
    cad_plate(plate, &chance, 20, 20, 1, 1, 0);
    struct relocation_shape shape = shape_of(plate);
    struct relocation *relocation = relocation_create(the_log, workers, &shape);
    assert_true(relocation_place(relocation, (const double[3]){ 0.3, 0.6, 1.2 }, &place, NULL));
    assert_float_equal(place.distance_m, 1.2, 1e-6);
    /* refused: the point is farther from the plate than the limit, which is the plate's diagonal of 1.41 m */
    assert_false(relocation_place(relocation, (const double[3]){ 0.3, 0.6, 1.5 }, &place, NULL));
    assert_int_equal(relocation_request(relocation, (const double[3]){ 0.3, 0.6, 1.5 }, put_into_box, &box), 0);
    assert_int_equal(relocation_request(relocation, (const double[3]){ 0.3, NAN, 0 }, put_into_box, &box), 0);
    assert_int_equal(relocation_request(relocation, (const double[3]){ 0.3, INFINITY, 0 }, put_into_box, &box), 0);
    relocation_destroy(&relocation);
    assert_int_equal(box.count, 0);
}

TEST(an_asset_without_surface_is_said_to_be_broken)
{
    const float line[3][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 2, 0, 0 } };
    const uint32_t flat[3] = { 0, 1, 2 };
    struct relocation_shape shapes[2] = { { .positions_m = line, .vertex_count = 3, .triangles = flat, .triangle_count = 1 },
                                          { .positions_m = line, .vertex_count = 3, .triangles = flat } };
    struct relocation_place place;
    for (int i = 0; i < 2; i++) {
        struct result_box box;
        box_init(&box);
        struct relocation *relocation = relocation_create(the_log, workers, &shapes[i]);
        uint64_t ticket = relocation_request(relocation, (const double[3]){ 0.5, 0.1, 0 }, put_into_box, &box);
        assert_true((ticket > 0) == (i == 0)); /* only the first of these shapes, a degenerate triangle, accepts positions of sensors */
        assert_true(relocation_place(relocation, (const double[3]){ 0.5, 0.1, 0 }, &place, NULL) == (i == 0));
        if (ticket) {
            wait_for(&box, 1);
            assert_int_equal(box.result.status, RELOCATION_NO_SURFACE);
            assert_null(box.result.geodesic_m);
            assert_int_equal(relocation_state(relocation), RELOCATION_BROKEN);
        }
        relocation_destroy(&relocation);
    }
}

/* --- failing allocations ------------------------------------------------------------------------------------------------------- */

/* Number of memory allocations until one fails (1: the next one), to test a shortage of memory; 0: none fails. */
static atomic_int until_fault;
void *__real_mem_try_array(size_t count, size_t bytes_each);
void *__wrap_mem_try_array(size_t count, size_t bytes_each);
void *__wrap_mem_try_array(size_t count, size_t bytes_each)
{
    int before = atomic_load(&until_fault);
    while (before > 0 && !atomic_compare_exchange_weak(&until_fault, &before, before - 1))
        ;
    return before == 1 ? NULL : __real_mem_try_array(count, bytes_each);
}

static void wait_until_warm(struct relocation *relocation)
{
    while (relocation_state(relocation) == RELOCATION_WARMING)
        sleep_ns(NS_PER_MS);
}

static void ask_and_wait(struct relocation *relocation, struct result_box *box)
{
    box_init(box);
    assert_true(relocation_request(relocation, (const double[3]){ 0.25, 0.5, 0 }, put_into_box, box) > 0);
    wait_for(box, 1);
}

/* Requests distances repeatedly; in the n-th round the n-th memory allocation fails. Each request must get an answer, and the
   request after it must succeed. */
static void try_walks_without_memory(struct relocation *relocation, const struct cad *plate)
{
    int failed = 0;
    for (int n = 1;; n++) {
        struct result_box box;
        atomic_store(&until_fault, n);
        ask_and_wait(relocation, &box);
        bool reached = atomic_exchange(&until_fault, 0) == 0;
        assert_int_equal(relocation_state(relocation), RELOCATION_WARM);
        assert_int_equal(box.result.status, reached ? RELOCATION_NO_MEMORY : RELOCATION_DONE);
        assert_true((box.result.geodesic_m != NULL) == !reached);
        for (size_t v = 0; !reached && v < plate->vertex_count; v++)
            assert_float_equal(box.result.geodesic_m[v], hypot((double)plate->positions[v][0] - 0.25, (double)plate->positions[v][1] - 0.5),
                               1e-4);
        mem_free(box.result.geodesic_m);
        if (!reached)
            break;
        failed++;
    }
    print_message("# a walk asks for memory %d times, and survives each that fails\n", failed);
    assert_true(failed >= 3);
}

TEST(without_memory_it_says_so_and_goes_on)
{
    struct prep_case *c = *state;
    struct cad *plate = test_cad();
    struct cad_random chance = { 8 };
    struct text *packed = test_text();
    struct log *quiet = log_create(LOG_ERROR + 1);
    cad_plate(plate, &chance, 20, 20, 1, 1, 0);
    struct relocation_shape shape = shape_of(plate);
    struct surface *surface = surface_create(quiet, NULL, shape.positions_m, shape.vertex_count, shape.triangles, shape.triangle_count,
                                             &(struct surface_params){ 0 });
    char *path = temp_path(c->folder, "plate.surface");
    surface_pack(surface, packed);
    const struct atomic_file_part part = { packed->at, packed->length };
    assert_int_equal(cache_file_write_compressed(path, SURFACE_MAGIC, 7, &part, 1), 0);
    for (int kept = 0; kept < 2; kept++) {
        int broken = 0, warm = 0;
        shape.surface_path = kept ? path : NULL;
        shape.surface_key = 7;
        for (bool reached = true; reached;) {
            struct result_box box;
            atomic_store(&until_fault, broken + warm + 1);
            struct relocation *relocation = relocation_create(quiet, workers, &shape);
            wait_until_warm(relocation);
            reached = atomic_exchange(&until_fault, 0) == 0;
            ask_and_wait(relocation, &box);
            assert_int_equal(box.result.status, relocation_state(relocation) == RELOCATION_WARM ? RELOCATION_DONE : RELOCATION_NO_SURFACE);
            assert_true(reached || relocation_state(relocation) == RELOCATION_WARM);
            broken += reached && relocation_state(relocation) == RELOCATION_BROKEN;
            /* warm although an allocation failed: the stored surface could not be loaded, so it was computed again */
            warm += reached && relocation_state(relocation) == RELOCATION_WARM;
            mem_free(box.result.geodesic_m);
            if (!reached)
                try_walks_without_memory(relocation, plate);
            relocation_destroy(&relocation);
        }
        print_message("# getting warm asks for memory %d times: broken %d times without\n", broken + warm, broken);
        assert_true(kept ? warm >= 10 : broken >= 1);
    }
    surface_destroy(&surface);
    log_destroy(&quiet);
}

static void hold(void *arg)
{
    pthread_mutex_lock(arg);
    pthread_mutex_unlock(arg);
}

TEST(what_waits_is_cancelled)
{
    struct cad *plate = test_cad();
    struct cad_random chance = { 6 };
    struct result_box kept, cancelled, dropped;
    pthread_mutex_t gate = PTHREAD_MUTEX_INITIALIZER;
    box_init(&kept);
    box_init(&cancelled);
    box_init(&dropped);
    cad_plate(plate, &chance, 40, 40, 1, 1, 0);
    struct relocation_shape shape = shape_of(plate);
    struct workers *one = test_workers(1);
    pthread_mutex_lock(&gate);
    /* blocks the only worker until the gate opens, so that the preparation of the surface cannot begin */
    workers_submit(one, hold, &gate);
    struct relocation *relocation = relocation_create(the_log, one, &shape);
    uint64_t first = relocation_request(relocation, (const double[3]){ 0.5, 0.5, 0 }, put_into_box, &cancelled);
    relocation_request(relocation, (const double[3]){ 0.25, 0.5, 0 }, put_into_box, &kept);
    assert_int_equal(relocation_state(relocation), RELOCATION_WARMING);
    relocation_cancel(relocation, first);
    assert_int_equal(cancelled.count, 1);
    assert_int_equal(cancelled.result.status, RELOCATION_CANCELLED);
    relocation_cancel(relocation, first); /* once more: nothing */
    relocation_cancel(relocation, 77);
    pthread_mutex_unlock(&gate);
    wait_for(&kept, 1);
    assert_int_equal(kept.result.status, RELOCATION_DONE);
    for (size_t v = 0; v < plate->vertex_count; v++)
        assert_float_equal(kept.result.geodesic_m[v], hypot((double)plate->positions[v][0] - 0.25, (double)plate->positions[v][1] - 0.5),
                           1e-4);
    pthread_mutex_lock(&gate);
    workers_submit(one, hold, &gate);
    relocation_request(relocation, (const double[3]){ 0.5, 0.5, 0 }, put_into_box, &dropped);
    pthread_mutex_unlock(&gate);
    relocation_destroy(&relocation); /* relocation_destroy() must answer every pending request before it returns */
    assert_int_equal(dropped.count, 1);
    assert_int_equal(cancelled.count, 1);
    mem_free(kept.result.geodesic_m);
    mem_free(dropped.result.geodesic_m);
}

struct relocation_crowd {
    struct relocation *relocation;
    struct result_box *box;
    uint64_t seed;
};

static void *drag(void *arg)
{
    struct relocation_crowd *crowd = arg;
    struct cad_random chance = { crowd->seed };
    for (int i = 0; i < 50; i++) {
        const double point[3] = { cad_random(&chance), cad_random(&chance), 0 };
        uint64_t ticket = relocation_request(crowd->relocation, point, put_into_box, crowd->box);
        assert_true(ticket > 0);
        if (i % 3 == 0)
            relocation_cancel(crowd->relocation, ticket);
    }
    return NULL;
}

TEST(every_ask_is_answered_once)
{
    struct cad *plate = test_cad();
    struct cad_random chance = { 7 };
    struct result_box box;
    pthread_t threads[3];
    struct relocation_crowd crowds[3];
    box_init(&box);
    cad_plate(plate, &chance, 30, 30, 1, 1, 0);
    struct relocation_shape shape = shape_of(plate);
    struct relocation *relocation = relocation_create(the_log, workers, &shape);
    for (int i = 0; i < 3; i++) {
        crowds[i] = (struct relocation_crowd){ relocation, &box, 11 + (uint64_t)i };
        assert_int_equal(pthread_create(&threads[i], NULL, drag, &crowds[i]), 0);
    }
    for (int i = 0; i < 3; i++)
        pthread_join(threads[i], NULL);
    wait_for(&box, 150);
    relocation_destroy(&relocation);
    assert_int_equal(box.count, 150);
    assert_true(box.done_count >= 150 - 3 * 17);
    mem_free(box.result.geodesic_m);
}

TEST_GROUP(set_up, tear_down)
