/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The software renderer's lists of sensors near a square of pixels (render/soft/pixel_lists.h): for random squares, the values
   computed with them are compared with plain sums over all sensors, and the flags with pixel_field_at(). */
#include "tests/support/test.h"

#include "base/clock.h"
#include "render/soft/pixel_lanes.h"
#include "tests/support/synthetic.h"

enum { MOST_SENSORS = 4096, PLACES = 8 };
static uint64_t random_state;

struct list_tally {
    double worst; /* largest error of the field's value, in steps of 1/255 of the range */
    size_t lists, sensors, pixels, flags_off;
    int64_t built_ns;
    int reported;
};

static double between(double low, double high)
{
    return low + (high - low) * synthetic_random_unit(&random_state);
}

static double one_of(const double *from, int count)
{
    return from[(int)between(0, count - 1e-9)];
}

/* --- plain sums ---------------------------------------------------------------------------------------------------------------- */

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
    return total > 0 ? sum / total * (double)field->scale + (double)field->offset : (double)NAN;
}

/* --- random fields ------------------------------------------------------------------------------------------------------------- */

static void make_field(struct pixel_field *field, int count, bool paper, bool odd)
{
    static const double powers[] = { 0.5, 1, 2, 2, 2, 3.3, 6, 16 }, decays[] = { 0, 0.5, 1, 1, 1, 2 };
    double decay = one_of(decays, 6);
    *field = (struct pixel_field){ .count = count,
                                   .paper = paper,
                                   .fill = between(0, 1) < 0.3,
                                   .power = (float)one_of(powers, 8),
                                   .reach_m = between(0, 1) < 0.3 ? (float)between(0.2, 6) : INFINITY,
                                   .radius_m = (float)between(0.3, 8),
                                   .scale = paper ? 100 : 1,
                                   .offset = paper ? 20 : 0,
                                   .low = -INFINITY,
                                   .high = INFINITY };
    field->sensors = mem_array((size_t)count, sizeof(*field->sensors));
    for (int i = 0; i < count; i++) {
        struct pixel_sensor *sensor = &field->sensors[i];
        *sensor = (struct pixel_sensor){ .value = (float)(paper ? between(0, 1) : between(20, 120)),
                                         .strength = odd ? (float)pow(10, between(-1, 1)) : 1,
                                         .decay = (float)(odd ? one_of(decays, 6) : decay),
                                         .state = PIXEL_CONFIGURED | PIXEL_USABLE };
        for (int c = 0; c < 3; c++)
            sensor->place_m[c] = (float)(c == 2 ? between(0, 1) < 0.5 ? 0 : between(0, 0.3) : between(0, 4));
        if (odd && i % 7 == 3) /* puts this sensor exactly at the previous one's position or, for every second, a micrometre away */
            memcpy(sensor->place_m, sensor[-1].place_m, sizeof(sensor->place_m));
        if (odd && i % 14 == 3)
            sensor->place_m[0] += 1e-6f;
        if (odd && i % 11 == 5)
            sensor->state = PIXEL_CONFIGURED | (i % 2 ? PIXEL_NO_LIMITS : 0);
        if (odd && i % 5 == 1 && sensor->state & PIXEL_USABLE)
            sensor->state |= PIXEL_UNCERTAIN;
    }
}

/* Makes the cells (pixels with positions) of a square of side x side pixels on a tilted plane, without some; some cells also
   show a second surface behind the plane. */
static size_t make_cells(struct pixel_cell *cells, int side, double size_m, const double corner_m[3], const double slope[2])
{
    size_t count = 0;
    for (uint32_t i = 0; i < SQUARE_CELLS * SQUARE_CELLS; i++) {
        uint32_t column, row;
        pixel_cell_from_order(i, &column, &row);
        if ((int)column >= side || (int)row >= side || between(0, 1) < 0.05)
            continue;
        struct pixel_cell *cell = &cells[count++];
        *cell = (struct pixel_cell){ .column = (uint16_t)column, .row = (uint16_t)row };
        double x = size_m * column / SQUARE_CELLS, y = size_m * row / SQUARE_CELLS, part = size_m / SQUARE_CELLS;
        double behind = between(0, 1) < 0.1 ? between(0, 1) : 0;
        const double low[3] = { x, y, x * slope[0] + y * slope[1] };
        const double high[3] = { x + part, y + part, (x + part) * slope[0] + (y + part) * slope[1] + behind };
        for (int c = 0; c < 3; c++) {
            cell->low[c] = (float)(corner_m[c] + fmin(low[c], high[c]));
            cell->high[c] = (float)(corner_m[c] + fmax(low[c], high[c]));
        }
    }
    return count;
}

static void compare(const struct pixel_field *field, const struct pixel_list *list, const struct pixel_cell *cell, double range,
                    struct list_tally *tally)
{
    lanes at[3];
    struct eight_values values;
    for (int i = 0; i < PLACES; i++)
        for (int c = 0; c < 3; c++)
            at[c][i] = i == 0 ? cell->low[c] : i == 1 ? cell->high[c] : (float)between((double)cell->low[c], (double)cell->high[c]);
    pixel_lanes_at(field, list, at, &values);
    for (int i = 0; i < PLACES; i++) {
        const float at_m[3] = { at[0][i], at[1][i], at[2][i] };
        struct pixel_value plain;
        pixel_field_at(field, at_m, &plain);
        tally->flags_off += plain.no_data != (values.no_data[i] != 0) || plain.no_limits != (values.no_limits[i] != 0);
        if (plain.no_data)
            continue;
        double truth = truth_at(field, at_m);
        if (isnan(truth)) { /* only a sensor without limits is within reach, so the pixel shows no value */
            assert_true(plain.no_limits);
            continue;
        }
        double off = fabs((double)values.value[i] - truth) / range * 255;
        if (!(off < 0.8) && tally->reported++ < 3)
            print_message("# off %g: value %g, truth %g, list %d, far %d, power %g, paper %d, reach %g, radius %g, decay %g\n", off,
                          (double)values.value[i], truth, list->count, list->has_far, (double)field->power, field->paper,
                          (double)field->reach_m, (double)field->radius_m, (double)field->sensors[0].decay);
        tally->worst = fmax(tally->worst, off);
    }
}

static void tally_square(const struct pixel_field *field, double size_m, struct list_tally *tally)
{
    struct pixel_cell cells[SQUARE_CELLS * SQUARE_CELLS];
    struct pixel_lists lists = { 0 };
    const double corner[3] = { between(-0.5, 4), between(-0.5, 4), between(-0.2, 0.2) }, range = 100;
    const double slope[2] = { between(-2, 2), between(-1, 1) };
    size_t count = make_cells(cells, 8, size_m, corner, slope);
    const float scale[4] = { 20, 0.01f };
    int64_t before = clock_work_ns();
    pixel_lists_add(&lists, field, pixel_lists_step(scale), cells, count);
    pixel_lists_settle(&lists);
    tally->built_ns += clock_work_ns() - before;
    assert_int_equal(lists.count, count);
    for (size_t i = 0; i < count; i++) {
        compare(field, &lists.lists[i], &cells[i], range, tally);
        tally->sensors += (size_t)lists.lists[i].count;
    }
    tally->lists += count;
    tally->pixels += PLACES * count;
    pixel_lists_finish(&lists);
}

static void tally_fields(int count, bool paper, bool odd, int rounds)
{
    static const double sizes[] = { 0.02, 0.1, 0.4, 1.5 };
    for (int s = 0; s < 4; s++) {
        struct list_tally tally = { 0 };
        for (int round = 0; round < rounds; round++) {
            struct pixel_field field;
            make_field(&field, count, paper, odd);
            tally_square(&field, sizes[s], &tally);
            pixel_field_finish(&field);
        }
        print_message("# %s%s, %d sensors, squares of %g m: %zu pixels off by %.3f steps at most; lists of %.1f, %.0f ns each; flags %zu\n",
                      paper ? "paper" : "shepard", odd ? ", odd" : "", count, sizes[s], tally.pixels, tally.worst,
                      (double)tally.sensors / (double)tally.lists, (double)tally.built_ns / (double)tally.lists, tally.flags_off);
        assert_true(tally.worst <= 0.8);
        assert_true(tally.flags_off <= tally.pixels / 100); /* flags may differ where two sensors are nearly equally near */
    }
}

TEST(test_lists_are_as_good_as_all_sensors)
{
    static const int counts[] = { 9, 64, 512 };
    random_state = sweep_seed();
    for (int i = 0; i < 3; i++)
        for (int way = 0; way < 4; way++)
            tally_fields(counts[i], way & 1, way & 2, sweep(40, 6));
    tally_fields(MOST_SENSORS, false, false, sweep(10, 1));
    tally_fields(MOST_SENSORS, true, true, sweep(10, 1));
}
