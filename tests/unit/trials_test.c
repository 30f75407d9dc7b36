/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Trials: sensor positions that an engineer tries out. A trial's field must equal that of a plant with the sensors there, and
   only sessions that request the trial may get it. */
#include "tests/support/test.h"

#include "field/field.h"
#include "protocol/asset_distance.h"
#include "tests/support/synthetic.h"
#include "tests/support/whole_field.h"

enum { VERTICES = 900, SENSORS = 6, MOVED = 2, TO = 400 };

struct trials_fixture {
    struct synthetic *plant;
    struct workers *workers;
    struct field *field;
    struct trials *trials;
    struct field_params params;
};

static void begin(struct trials_fixture *f)
{
    f->plant = synthetic_create(.vertices = VERTICES, .sensors = SENSORS, .assets = 2, .seed = sweep_seed());
    f->workers = test_workers(2);
    f->field = field_create(f->workers, &f->plant->scene);
    f->trials = trials_create();
    field_set_trials(f->field, f->trials);
    field_params_default(&f->plant->plant, 0, &f->params);
}

static void end(struct trials_fixture *f)
{
    field_destroy(&f->field);
    trials_destroy(&f->trials);
    synthetic_destroy(&f->plant);
}

TEST_FIXTURE(struct trials_fixture, begin, end)

#define CASE(name) TEST_ON(struct trials_fixture *f, name, set_up, tear_down)

/* Returns the distances along the surface to vertex `to` as the synthetic plant defines them: the sum of the distances along the axes. */
static float *along(const struct trials_fixture *f, size_t to)
{
    const float(*at)[3] = f->plant->file.view.positions_m;
    float *distance_m = mem_array(VERTICES, sizeof(*distance_m));
    for (size_t i = 0; i < VERTICES; i++)
        for (int c = 0; c < 3; c++)
            distance_m[i] += fabsf(at[i][c] - at[to][c]);
    return distance_m;
}

static struct trial_sensor sensor_at(const struct trials_fixture *f, int tag, int asset, size_t vertex, bool known)
{
    struct trial_sensor sensor = { .tag = tag, .asset = asset, .vertex = (uint32_t)vertex };
    memcpy(sensor.surface_m, f->plant->file.view.positions_m[vertex], sizeof(sensor.surface_m));
    sensor.reach = known ? trial_reach_create(along(f, vertex)) : NULL;
    return sensor;
}

static uint32_t put(struct trials_fixture *f, struct trial_sensor sensor)
{
    uint32_t id = trials_put(f->trials, &sensor, 1);
    trial_reach_unref(&sensor.reach);
    return id;
}

static struct scalar *copy_of(struct trials_fixture *f, int asset, uint32_t trial)
{
    struct field_params params = f->params;
    params.trial = trial;
    const struct scalars *scalars = field_scalars(f->field, asset, &params, f->plant->snapshot);
    if (!scalars)
        return NULL;
    struct scalar *copy = mem_array(scalars->count, sizeof(*copy));
    memcpy(copy, scalars->at, scalars->count * sizeof(*copy));
    return copy;
}

/* Returns the expected value at a vertex if the moved sensor has the distances moved_m[]: the weighted sum of all readings, in
   double precision. */
static double truth(const struct trials_fixture *f, const float *moved_m, size_t vertex)
{
    double sum = 0, total = 0;
    for (size_t i = 0; i < SENSORS; i++) {
        double d = (double)(i == MOVED ? moved_m[vertex] : asset_distance_m(&f->plant->file.view, i, vertex));
        if (d == 0)
            return f->plant->snapshot->readings[i].value;
        sum += f->plant->snapshot->readings[i].value / (d * d);
        total += 1 / (d * d);
    }
    return sum / total;
}

CASE(test_a_moved_sensor_is_where_it_is_tried)
{
    struct scalar *before = copy_of(f, 0, 0), *tried = copy_of(f, 0, put(f, sensor_at(f, MOVED, 0, TO, true))), *after = copy_of(f, 0, 0);
    float *moved_m = test_memory(along(f, TO));
    size_t changed = 0;
    for (size_t i = 0; i < VERTICES; i++) {
        assert_true(fabs((double)tried[i].value - truth(f, moved_m, i)) < 0.01);
        changed += fabsf(tried[i].value - before[i].value) > 0.5f;
        assert_true(before[i].value == after[i].value);
    }
    assert_true(changed > VERTICES / 10);
    assert_true(fabs((double)tried[TO].value - f->plant->snapshot->readings[MOVED].value) < 1e-4);
    mem_free(before);
    mem_free(tried);
    mem_free(after);
}

CASE(test_straight_distances_stand_in)
{
    struct scalar *guess = test_memory(copy_of(f, 0, put(f, sensor_at(f, MOVED, 0, TO, false))));
    const float(*at)[3] = f->plant->file.view.positions_m;
    float *straight_m = test_memory(mem_array(VERTICES, sizeof(*straight_m)));
    for (size_t i = 0; i < VERTICES; i++)
        straight_m[i] = sqrtf(powf(at[i][0] - at[TO][0], 2) + powf(at[i][1] - at[TO][1], 2) + powf(at[i][2] - at[TO][2], 2));
    for (size_t i = 0; i < VERTICES; i++)
        assert_true(fabs((double)guess[i].value - truth(f, straight_m, i)) < 0.01);
}

CASE(test_it_may_go_to_another_asset)
{
    uint32_t id = put(f, sensor_at(f, MOVED, 1, TO, true));
    struct scalar *left = test_memory(copy_of(f, 0, id)), *there = test_memory(copy_of(f, 1, id)), *was = test_memory(copy_of(f, 0, 0));
    assert_true(fabs((double)there[TO].value - f->plant->snapshot->readings[MOVED].value) < 1e-4);
    /* without the trial, the vertex where the sensor really is shows its reading */
    assert_true(fabsf(was[MOVED].value - (float)f->plant->snapshot->readings[MOVED].value) < 1e-3f);
    size_t changed = 0;
    for (size_t i = 0; i < VERTICES; i++)
        changed += left[i].value != was[i].value;
    assert_true(changed > VERTICES / 2);
}

CASE(test_what_it_does_not_touch_is_shared)
{
    struct field_params params = f->params;
    const struct scalars *plain = field_scalars(f->field, 1, &params, f->plant->snapshot);
    uint64_t version = plain->version;
    params.trial = put(f, sensor_at(f, MOVED, 0, TO, true));
    assert_ptr_equal(field_scalars(f->field, 1, &params, f->plant->snapshot), plain);
    assert_int_equal(plain->version, version);
}

/* Dragging a sensor makes a new trial for each step and drops the one before: memory must not grow. */
CASE(test_dragging_leaves_nothing_behind)
{
    uint32_t id = 0, first = 0;
    size_t bytes = 0;
    for (size_t step = 0; step < 60; step++) {
        uint32_t next = put(f, sensor_at(f, MOVED, 0, TO + step, step % 2));
        trials_drop(f->trials, id);
        id = next;
        first = first ? first : id;
        mem_free(copy_of(f, 0, id));
        if (step == 20)
            bytes = field_bytes(f->field);
    }
    assert_true(field_bytes(f->field) <= bytes);
    assert_null(trials_take(f->trials, first));
    assert_true(trials_live(f->trials, id));
    /* for the number of a dropped trial, the field uses the plant's own positions */
    struct scalar *gone = copy_of(f, 0, first), *plain = copy_of(f, 0, 0);
    assert_memory_equal(gone, plain, VERTICES * sizeof(*plain));
    mem_free(gone);
    mem_free(plain);
}
