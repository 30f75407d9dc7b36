/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Detection of sensors that drift. The fit is compared with plain least squares. Real series (../shared/data/sensors),
   stretched over a week, are tested as recorded and with a drift added to one sensor; the alarm limit lies a tenth of the
   group's range beyond all readings. */
#include "tests/support/test.h"

#include "base/log/log.h"
#include "base/math/search.h"
#include "field/drift.h"
#include "scene/scene_create.h"
#include "tests/support/cad.h"
#include "tests/support/model_maker.h"
#include "tests/support/prep_case.h"

#define SERIES "../shared/data/sensors/"
enum { SENSORS = 5 };

/* --- the fit ------------------------------------------------------------------------------------------------------------- */

static double random_in(double low, double high)
{
    return low + (high - low) * rand() / (double)RAND_MAX;
}

enum { UNKNOWNS = 5 };

/* Solves the normal equations by Gaussian elimination. */
static void solve(double a[UNKNOWNS][UNKNOWNS + 1])
{
    for (int i = 0; i < UNKNOWNS; i++) {
        int pivot = i;
        for (int r = i + 1; r < UNKNOWNS; r++)
            pivot = fabs(a[r][i]) > fabs(a[pivot][i]) ? r : pivot;
        for (int c = 0; c <= UNKNOWNS; c++) {
            double x = a[i][c];
            a[i][c] = a[pivot][c];
            a[pivot][c] = x;
        }
        for (int r = 0; r < UNKNOWNS; r++)
            for (int c = UNKNOWNS; c >= i && r != i; c--)
                a[r][c] -= a[r][i] / a[i][i] * a[i][c];
    }
}

/* Returns the mean change per hour, from three hours before `hour` to three hours after it. */
static double change_at(const double *predicted, int hours, int hour)
{
    double sum = 0;
    int count = 0;
    for (int h = hour - 3; h <= hour + 1; h++)
        if (h >= 1 && h < hours) {
            sum += fabs(predicted[h] - predicted[h - 1]);
            count++;
        }
    return sum / count;
}

/* Reference for drift_fit(): plain weighted least squares. The weight of an hour is 1 / (1 + (change / twice the usual
   change)^2), so that hours of fast changes count little. */
static double slow_change(const double *values, const double *predicted, const double *nearest, int hours)
{
    double a[UNKNOWNS][UNKNOWNS + 1] = { 0 }, changes[DRIFT_HOURS], lagging = predicted[0];
    int known = 0;
    for (int h = 0; h < hours; h++)
        if (isfinite(values[h]))
            changes[known++] = change_at(predicted, hours, h);
    qsort(changes, (size_t)known, sizeof(*changes), compare_doubles);
    double usual = (changes[(known - 1) / 2] + changes[known / 2]) / 2;
    for (int h = 0; h < hours; h++) {
        lagging += h > 0 ? (predicted[h] - lagging) / 12 : 0;
        const double row[] = { 1, predicted[h], lagging, nearest[h], (h + 0.5) / hours - 0.5, values[h] };
        double fast = change_at(predicted, hours, h) / (2 * usual);
        for (int r = 0; r < UNKNOWNS && isfinite(values[h]); r++)
            for (int c = 0; c <= UNKNOWNS; c++)
                a[r][c] += row[r] * row[c] / (1 + fast * fast);
    }
    solve(a);
    return a[UNKNOWNS - 1][UNKNOWNS] / a[UNKNOWNS - 1][UNKNOWNS - 1];
}

TEST(test_fit_is_least_squares)
{
    double values[DRIFT_HOURS], predicted[DRIFT_HOURS], nearest[DRIFT_HOURS];
    srand(1);
    for (int round = 0; round < 200; round++) {
        double gain = random_in(0.5, 2), change = random_in(-5, 5), noise = random_in(0.01, 1), at = 50;
        struct drift drift;
        for (int h = 0; h < DRIFT_HOURS; h++) {
            at += random_in(-1, 1);
            predicted[h] = at;
            /* the nearest sensor shows random changes that no other sensor shows, and the tested sensor shows half of these */
            nearest[h] = at + random_in(-3, 3);
            values[h] = gain * at + (nearest[h] - at) / 2 + change * h / DRIFT_HOURS + random_in(-noise, noise);
            if (h % 9 == round % 9)
                values[h] = NAN;
        }
        drift_fit(values, predicted, nearest, 1, DRIFT_HOURS, 0.01, &drift);
        assert_int_equal(drift.hours, DRIFT_HOURS - (DRIFT_HOURS + 8 - round % 9) / 9);
        assert_true(fabs(drift.change - slow_change(values, predicted, nearest, DRIFT_HOURS)) < 1e-6);
        assert_true(fabs(drift.change - change) < 10 * drift.error);
        /* the scatter found must be that of the added noise, which is evenly distributed within +-noise and so has the
           deviation noise / sqrt(3) */
        assert_true(fabs(drift.scatter - hypot(noise / sqrt(3), 0.01)) < 0.2 * drift.scatter);
        if (fabs(change) > 4 * drift.scatter && fabs(change) > 10 * drift.error)
            assert_int_equal(drift.verdict, DRIFT_FOUND);
    }
}

/* --- jumps: a sensor is moved or replaced ---------------------------------------------------------------------------------------- */

/* a sensor's readings are higher by `after` (in multiples of its noise) between the hours `begins` and `ends`, and by `left`
   after that */
struct jump {
    double after, left;
    int begins, ends;
};

/* Tests 200 random sensors with the jumps that jump_of draws; every second one also drifts by six times its noise. Asserts that
   at least `least_found` of these drifts are detected, and at most `most_accused` of the others. */
static void fit_after_jumps(const char *what, void (*jump_of)(int round, struct jump *jump), int least_found, int most_accused)
{
    double values[DRIFT_HOURS], predicted[DRIFT_HOURS];
    int found = 0, accused = 0;
    for (int round = 0; round < 200; round++) {
        double noise = random_in(0.1, 1), change = round % 2 ? (round % 4 == 1 ? 6 : -6) * noise : 0, at = 50;
        struct jump jump;
        struct drift drift;
        jump_of(round, &jump);
        for (int h = 0; h < DRIFT_HOURS; h++) {
            double by = h >= jump.ends ? jump.left : h >= jump.begins ? 1 : 0;
            at += random_in(-noise, noise) / 3;
            predicted[h] = at;
            values[h] = at + change * h / DRIFT_HOURS + random_in(-noise, noise) + by * (jump.after * noise);
        }
        drift_fit(values, predicted, NULL, 0, DRIFT_HOURS, 0.01, &drift);
        found += change != 0 && drift.verdict == DRIFT_FOUND && fabs(drift.change - change) < 3 * noise;
        accused += change == 0 && drift.verdict == DRIFT_FOUND;
    }
    printf("# after %s: %d of 100 drifts found, %d of 100 sensors accused that do not drift\n", what, found, accused);
    assert_true(found >= least_found && accused <= most_accused);
}

static void one_jump(int round, struct jump *jump)
{
    (void)round;
    *jump = (struct jump){ .after = random_in(8, 20), .ends = DRIFT_HOURS };
    jump->after *= rand() % 2 ? 1 : -1;
    jump->begins = 30 + rand() % 108;
}

/* Draws a jump that is undone, wholly or mostly, a day or two later, as when somebody tries something out. */
static void jump_and_back(int round, struct jump *jump)
{
    *jump = (struct jump){ .after = random_in(8, 20) };
    jump->after *= rand() % 2 ? 1 : -1;
    jump->left = round % 8 < 4 ? 0 : random_in(-0.5, 0.5);
    jump->begins = 24 + rand() % 60;
    jump->ends = jump->begins + 24 + rand() % 36;
}

/* A sensor that jumps once to another offset, as after being moved, must not count as drifting, and a real drift must be found
   despite the jump. */
TEST(test_jumps_are_no_drift)
{
    srand(2);
    fit_after_jumps("a jump", one_jump, 75, 16);
}

TEST(test_a_jump_and_back_is_no_drift)
{
    srand(3);
    fit_after_jumps("a jump and back", jump_and_back, 68, 12);
}

/* Drift is unknown if readings are missing, or if the whole plant changed in one direction all week. */
TEST(test_what_cannot_be_told_is_unknown)
{
    double values[DRIFT_HOURS], predicted[DRIFT_HOURS];
    struct drift drift;
    for (int h = 0; h < DRIFT_HOURS; h++) {
        values[h] = h < DRIFT_HOURS_LEAST - 1 ? 50 + h : NAN;
        predicted[h] = 50;
    }
    drift_fit(values, predicted, NULL, 0, DRIFT_HOURS, 0.2, &drift);
    assert_int_equal(drift.verdict, DRIFT_UNKNOWN);
    assert_true(isnan(drift.change) && drift.hours == DRIFT_HOURS_LEAST - 1);
    assert_non_null(strstr(drift_unknown_cause(&drift, 3), "fewer than 84 hours"));
    assert_non_null(strstr(drift_unknown_cause(&drift, 2), "fewer than 3 sensors of the group"));
    assert_non_null(strstr(drift_unknown_cause(&drift, NEIGHBOURS_MOST), "fewer than 84 hours"));
    assert_non_null(strstr(drift_unknown_cause(&drift, NEIGHBOURS_MOST + 1), "more than 512 sensors"));
    for (int h = 0; h < DRIFT_HOURS; h++) {
        predicted[h] = 50 + h;
        values[h] = 50 + 1.1 * h;
    }
    drift_fit(values, predicted, NULL, 0, DRIFT_HOURS, 0.2, &drift);
    assert_int_equal(drift.verdict, DRIFT_UNKNOWN);
    assert_non_null(strstr(drift_unknown_cause(&drift, 3), "changes in plant operation"));
    for (int h = 0; h < DRIFT_HOURS; h++) /* all readings are constant, as from stuck sensors: the verdict is "no drift", not "unknown" */
        values[h] = predicted[h] = 50;
    drift_fit(values, predicted, NULL, 0, DRIFT_HOURS, 0.2, &drift);
    assert_int_equal(drift.verdict, DRIFT_NONE);
    assert_string_equal(drift_unknown_cause(&drift, 3), "");
    /* drift_find() sets this verdict for a sensor if fewer than three others of its group do not drift */
    drift.verdict = DRIFT_UNKNOWN;
    assert_non_null(strstr(drift_unknown_cause(&drift, 3), "that do not drift"));
}

/* --- real series ---------------------------------------------------------------------------------------------------------- */

struct recorded_series {
    const char *file, *columns[SENSORS];
    int count; /* number of columns */
    /* noise: deviation of a reading's noise; beyond: distance from the extreme readings to the alarm limit, a tenth of the
       group's range */
    double noise, beyond;
    double from, to;      /* from, to: part of the recording that is stretched over a week; 0: its beginning, 1: its end */
    double hours[DRIFT_HOURS][SENSORS];
};

static void read_series(struct recorded_series *s)
{
    char *path = test_printf(SERIES "%s", s->file), *line = NULL;
    FILE *file = fopen(path, "r");
    size_t room = 0, rows = 0, row = 0;
    int column[SENSORS];
    if (!file)
        skip();
    assert_true(getline(&line, &room, file) > 0);
    for (int i = 0; i < s->count; i++) {
        char *rest = line;
        column[i] = 0;
        for (char *name; (name = strsep(&rest, ",\n")) && strcmp(name, s->columns[i]) != 0; column[i]++)
            if (rest)
                rest[-1] = ','; /* for the next name */
        if (rest)
            rest[-1] = ',';
    }
    long begin = ftell(file);
    while (getline(&line, &room, file) > 0)
        rows++;
    fseek(file, begin, SEEK_SET);
    const size_t first = (size_t)(s->from * (double)rows), count = (size_t)(s->to * (double)rows) - first;
    double counted[DRIFT_HOURS] = { 0 };
    memset(s->hours, 0, sizeof(s->hours));
    for (; getline(&line, &room, file) > 0; row++) {
        if (row < first || row >= first + count)
            continue;
        size_t hour = (row - first) * DRIFT_HOURS / count;
        char *rest = line;
        counted[hour]++;
        for (int c = 0; rest; c++) {
            double value = atof(rest);
            for (int i = 0; i < s->count; i++)
                s->hours[hour][i] += c == column[i] ? value : 0;
            rest = strchr(rest, ',') ? strchr(rest, ',') + 1 : NULL;
        }
    }
    for (int h = 0; h < DRIFT_HOURS; h++)
        for (int i = 0; i < s->count; i++)
            s->hours[h][i] /= counted[h];
    free(line);
    fclose(file);
}

struct row_of_sensors {
    struct plant *plant;
    struct scene *scene;
    struct neighbours *neighbours;
};

/* Makes a strip with `count` sensors, 0.4 m apart. */
static void stand_sensors(struct prep_case *c, int count, struct row_of_sensors *out)
{
    struct cad_random random;
    struct cad *cad = test_cad();
    struct text *rows = test_text();
    cad_random_start(&random);
    cad_plate(cad, &random, 24, 3, 2.4, 0.3, 0);
    maker_write_cad(c->folder, "model.glb", "strip", cad);
    prep_case_plant(c, "plant: { name: Strip }\n"
                       "assets:\n"
                       "  - { id: S, model: model.glb, up: z }\n"
                       "groups:\n"
                       "  - { id: temperature, unit: K, min: 0, max: 100 }\n"
                       "sources:\n"
                       "  - { id: plc, type: modbus, host: 127.0.0.1, byte_order: ABCD, address_base: 1 }\n"
                       "tags: tags.csv\n");
    for (int i = 0; i < count; i++)
        text_add(rows, "T%d,%d,Float,plc,temperature,S,,%g,0.15,0\n", i, 400001 + 2 * i, 0.4 + 0.4 * i);
    prep_case_tags(c, rows->at);
    prep_case_expect(c, "$PLANT", 0);
    out->plant = plant_load_or_print(c->plant);
    assert_non_null(out->plant);
    char *prepared = test_memory(plant_prepared_folder(out->plant));
    out->scene = scene_create(test_log(), out->plant, prepared);
    assert_non_null(out->scene);
    out->neighbours = neighbours_create(out->scene, 0, 0);
    assert_non_null(out->neighbours);
    assert_int_equal(neighbours_count(out->neighbours), count);
    for (int i = 0; i < count; i++)
        assert_int_equal(neighbours_tag(out->neighbours, (size_t)i), i);
}

static void leave(struct row_of_sensors *row)
{
    neighbours_destroy(&row->neighbours);
    scene_destroy(&row->scene);
    plant_destroy(&row->plant);
}

/* Adds a linear drift to one sensor, which would reach `change` at the end of the week, and looks for drifts in the first
   `hours` hours. out[]: result for each sensor. */
static void find(const struct row_of_sensors *row, const struct recorded_series *s, int hours, int sensor, double change, struct drift *out)
{
    double values[DRIFT_HOURS * SENSORS], noise[SENSORS];
    for (int h = 0; h < hours; h++)
        for (int i = 0; i < s->count; i++)
            values[h * s->count + i] = s->hours[h][i] + (i == sensor ? change * h / DRIFT_HOURS : 0);
    for (int i = 0; i < s->count; i++)
        noise[i] = s->noise;
    drift_find(row->neighbours, values, hours, noise, out, NULL);
}

/* Looks for drifts after each hour from half a week on, in readings without added drift. Returns how many sensors were found to
   drift, wrongly, at any time; *times receives how often that happened. */
static int accused(const struct row_of_sensors *row, const struct recorded_series *s, int *times)
{
    bool ever[SENSORS] = { false };
    int sensors = 0;
    *times = 0;
    for (int hours = DRIFT_HOURS_LEAST; hours <= DRIFT_HOURS; hours++) {
        struct drift drifts[SENSORS];
        find(row, s, hours, 0, 0, drifts);
        for (int i = 0; i < s->count; i++) {
            bool found = drifts[i].verdict == DRIFT_FOUND;
            *times += found;
            sensors += found && !ever[i];
            ever[i] |= found;
        }
    }
    return sensors;
}

#define RIG "hydraulic/hydraulic_ts_1hz.csv", { "TS1", "TS2", "TS3", "TS4" }, 4, 0.2, 4
#define PROCESS { "XMEAS09", "XMEAS11", "XMEAS18", "XMEAS21", "XMEAS22" }, 5, 0.5, 10, 0, 1, { { 0 } }
static struct recorded_series all_series[] = {
    /* whole recording: the rig's cooler is switched from 3 to 20 % after a third of it, and to 100 % after two thirds */
    { RIG, 0, 1, { { 0 } } },
    { "tep/tep_d00_normal.csv", PROCESS },
    { "tep/tep_d04_reactor_cooling_step.csv", PROCESS },
    { "tep/tep_d06_a_feed_loss.csv", PROCESS }, /* a feed is lost */
    { RIG, 0, 732 / 2205., { { 0 } } },
    { RIG, 732 / 2205., 1464 / 2205., { { 0 } } },
    { RIG, 1464 / 2205., 1, { { 0 } } },
    { RIG, 0, 1464 / 2205., { { 0 } } },
    { RIG, 732 / 2205., 1, { { 0 } } },
    /* the half of the recording with which the fit's weights (of neighbours, of hours with fast changes) were tuned */
    { RIG, 0, 0.5, { { 0 } } },
    { RIG, 0.5, 1, { { 0 } } }, /* the other half, not used for tuning */
};

TEST_WITH(test_false_accusations_are_counted, prep_case_set_up, prep_case_tear_down)
{
    static const int most[] = { 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0 }; /* sensors */
    for (size_t k = 0; k < sizeof(all_series) / sizeof(*all_series); k++) {
        struct recorded_series *s = &all_series[k];
        struct row_of_sensors row;
        int times;
        read_series(s);
        stand_sensors(*state, s->count, &row);
        int sensors = accused(&row, s, &times);
        printf("# %s, %.0f to %.0f %%: %d of %d sensors accused in a week, %d times of %d\n", s->file, 100 * s->from, 100 * s->to, sensors,
               s->count, times, s->count * (DRIFT_HOURS - DRIFT_HOURS_LEAST + 1));
        assert_true(sensors <= most[k]);
        leave(&row);
    }
}

/* Data that the rule was not tuned with: half an hour of temperatures of 25 simulated mixers (a value every 6 s), stretched
   over a week. */
TEST_WITH(test_held_out_series, prep_case_set_up, prep_case_tear_down)
{
    enum { MIXERS = 25 };
    static double sums[MIXERS][DRIFT_HOURS], counts[MIXERS][DRIFT_HOURS];
    char ids[MIXERS][100] = { "" }, id[100], *line = NULL;
    size_t room = 0;
    double first_ms = 0, last_ms = 0, time_ms, value;
    FILE *file = fopen(SERIES "cookie_factory/telemetry.csv", "r");
    int sensors = 0, times = 0, told = 0;
    if (!file)
        skip();
    while (getline(&line, &room, file) > 0) {
        time_ms = atof(line);
        first_ms = first_ms > 0 ? first_ms : time_ms;
        last_ms = time_ms;
    }
    rewind(file);
    while (getline(&line, &room, file) > 0) {
        int mixer = 0;
        if (sscanf(line, "%lf,Mixer,%99[^,],Temperature,%lf", &time_ms, id, &value) != 3)
            continue;
        while (mixer < MIXERS && ids[mixer][0] && strcmp(ids[mixer], id) != 0)
            mixer++;
        if (mixer == MIXERS)
            continue;
        memcpy(ids[mixer], id, sizeof(id));
        int hour = (int)((time_ms - first_ms) / (last_ms - first_ms + 1) * DRIFT_HOURS);
        sums[mixer][hour] += value;
        counts[mixer][hour]++;
    }
    free(line);
    fclose(file);
    for (int first = 0; first < MIXERS; first += SENSORS) {
        struct recorded_series s = { .count = SENSORS, .noise = 0.45 };
        struct row_of_sensors row;
        int looks;
        for (int h = 0; h < DRIFT_HOURS; h++)
            for (int i = 0; i < SENSORS; i++)
                s.hours[h][i] = counts[first + i][h] > 0 ? sums[first + i][h] / counts[first + i][h] : (double)NAN;
        stand_sensors(*state, SENSORS, &row);
        struct drift drifts[SENSORS];
        sensors += accused(&row, &s, &looks);
        times += looks;
        find(&row, &s, DRIFT_HOURS, 0, 0, drifts);
        for (int i = 0; i < SENSORS; i++)
            told += drifts[i].verdict == DRIFT_NONE;
        leave(&row);
    }
    printf("# held out: %d of %d mixers accused in a week, %d times of %d; of %d it is said that they do not drift\n", sensors, MIXERS,
           times, MIXERS * (DRIFT_HOURS - DRIFT_HOURS_LEAST + 1), told);
    assert_true(sensors == 0 && told == MIXERS);
}

struct drift_detection {
    int hours;      /* number of hours after the beginning of the week at which the drift was found; 0: not found */
    double drifted; /* amount drifted by that hour */
    double limit;   /* smallest distance so far between the drifting reading and its alarm limit; negative: beyond the limit */
};

static struct drift_detection search(const struct row_of_sensors *row, const struct recorded_series *s, int sensor, double change)
{
    struct drift_detection out = { 0, 0, INFINITY };
    double extreme = s->hours[0][sensor];
    for (int h = 1; h < DRIFT_HOURS; h++)
        extreme = change > 0 ? fmax(extreme, s->hours[h][sensor]) : fmin(extreme, s->hours[h][sensor]);
    for (int h = 0; h < DRIFT_HOURS; h++) {
        struct drift drifts[SENSORS];
        out.drifted = change * h / DRIFT_HOURS;
        out.limit = fmin(out.limit, s->beyond + fabs(extreme - s->hours[h][sensor]) - fabs(out.drifted));
        if (h + 1 < DRIFT_HOURS_LEAST)
            continue;
        find(row, s, h + 1, sensor, change, drifts);
        if (drifts[sensor].verdict == DRIFT_FOUND) {
            out.hours = h + 1;
            break;
        }
    }
    return out;
}

/* Returns whether, at the end of the week, a sensor other than the drifting one is found to drift. */
static bool accuses_another(const struct row_of_sensors *row, const struct recorded_series *s, int sensor, double change)
{
    struct drift drifts[SENSORS];
    bool another = false;
    find(row, s, DRIFT_HOURS, sensor, change, drifts);
    for (int k = 0; k < s->count; k++)
        another |= k != sensor && drifts[k].verdict == DRIFT_FOUND;
    return another;
}

/* Adds drifts of 3, 4 and 8 sigma per week, where sigma is the sensor's scatter without drift. Most must be found, and each
   before the reading reaches its alarm limit. */
TEST_WITH(test_a_drift_is_found_before_its_alarm, prep_case_set_up, prep_case_tear_down)
{
    enum { SIZES = 3 };
    static const double sizes[SIZES] = { 3, 4, 8 }; /* drifts, in sigmas per week */
    /* minimum number of drifts to find, by series and size; the test rig's own changes hide some. { 0 }: not tested, because
       the recorded process has a fault */
    static const int least[][SIZES] = { { 2, 7, 8 }, { 10, 10, 10 }, { 0 },       { 0 },       { 8, 8, 8 }, { 7, 8, 8 },
                                        { 8, 8, 8 }, { 6, 7, 8 },    { 6, 7, 8 }, { 5, 6, 8 }, { 8, 8, 8 } };
    int others = 0; /* how often a sensor without drift was found to drift while another one really did */
    for (size_t k = 0; k < sizeof(all_series) / sizeof(*all_series); k++) {
        struct recorded_series *s = &all_series[k];
        if (least[k][0] == 0)
            continue;
        struct row_of_sensors row;
        struct drift none[SENSORS];
        read_series(s);
        stand_sensors(*state, s->count, &row);
        find(&row, s, DRIFT_HOURS, 0, 0, none);
        for (int size = 0; size < SIZES; size++) {
            int found = 0, tries = 0;
            double most_sigmas = 0, least_limit = INFINITY;
            for (int i = 0; i < s->count; i++)
                for (int sign = -1; sign <= 1; sign += 2, tries++) {
                    struct drift_detection at = search(&row, s, i, sign * sizes[size] * none[i].scatter);
                    found += at.hours > 0;
                    others += accuses_another(&row, s, i, sign * sizes[size] * none[i].scatter);
                    if (at.hours == 0)
                        continue;
                    assert_true(at.limit > 0); /* a drift was found while the reading was still within its alarm limit */
                    most_sigmas = fmax(most_sigmas, fabs(at.drifted) / none[i].scatter);
                    least_limit = fmin(least_limit, at.limit);
                }
            printf("# %s, %.0f to %.0f %%, %g sigma in a week: %d of %d found, at %.1f sigma at most, %.1f K or more before the alarm\n",
                   s->file, 100 * s->from, 100 * s->to, sizes[size], found, tries, most_sigmas, least_limit);
            assert_true(found >= least[k][size]);
            if (k == 1 && sizes[size] < 8)
                assert_true(most_sigmas <= DRIFT_SIGMAS);
        }
        leave(&row);
    }
    printf("# at the week's end another than the one that drifts is accused: %d times\n", others);
    assert_true(others <= 27);
}

/* Once the drifting sensor is excluded, the others are compared with each other: none is accused because of it. */
TEST_WITH(test_one_that_drifts_does_not_accuse_others, prep_case_set_up, prep_case_tear_down)
{
    struct recorded_series *s = &all_series[1];
    struct row_of_sensors row;
    struct drift drifts[SENSORS];
    read_series(s);
    stand_sensors(*state, s->count, &row);
    for (int i = 0; i < s->count; i++) {
        find(&row, s, DRIFT_HOURS, i, 20, drifts);
        for (int k = 0; k < s->count; k++)
            assert_int_equal(drifts[k].verdict == DRIFT_FOUND, k == i);
        assert_true(fabs(drifts[i].change - 20) < 4 * drifts[i].error + 1);
    }
    leave(&row);
}

/* A sensor that is lost for a day and a half makes no other sensor appear to drift, whatever it reads before and after. */
TEST_WITH(test_one_that_is_lost_for_a_while_accuses_nobody, prep_case_set_up, prep_case_tear_down)
{
    struct recorded_series s = all_series[1];
    struct row_of_sensors row;
    struct drift drifts[SENSORS];
    read_series(&s);
    stand_sensors(*state, s.count, &row);
    for (int i = 0; i < s.count; i++) {
        struct recorded_series lossy = s;
        for (int h = 20; h < 56; h++)
            lossy.hours[h][i] = NAN;
        find(&row, &lossy, DRIFT_HOURS, 0, 0, drifts);
        for (int k = 0; k < s.count; k++) {
            assert_int_equal(drifts[k].verdict, DRIFT_NONE);
            assert_int_equal(drifts[k].hours, k == i ? DRIFT_HOURS - 36 : DRIFT_HOURS);
        }
    }
    leave(&row);
}

/* A sensor without any reading gets no verdict, and the others are compared with the sensors that have readings. */
TEST_WITH(test_one_that_is_silent_hides_nothing, prep_case_set_up, prep_case_tear_down)
{
    struct recorded_series s = all_series[1];
    struct row_of_sensors row;
    struct drift drifts[SENSORS];
    read_series(&s);
    stand_sensors(*state, s.count, &row);
    for (int i = 0; i < s.count; i++) {
        struct recorded_series silent = s;
        int drifting = (i + 1) % s.count;
        for (int h = 0; h < DRIFT_HOURS; h++)
            silent.hours[h][i] = NAN;
        find(&row, &silent, DRIFT_HOURS, drifting, 20, drifts);
        for (int k = 0; k < s.count; k++)
            assert_int_equal(drifts[k].verdict, k == i ? DRIFT_UNKNOWN : k == drifting ? DRIFT_FOUND : DRIFT_NONE);
    }
    leave(&row);
}

TEST_WITH(test_the_nearest_are_found, prep_case_set_up, prep_case_tear_down)
{
    struct row_of_sensors row;
    size_t near[SENSORS];
    bool apart[SENSORS] = { false };
    stand_sensors(*state, SENSORS, &row);
    assert_int_equal(neighbours_nearest(row.neighbours, 0, apart, 2, near), 2);
    assert_true(near[0] == 1 && near[1] == 2);
    apart[3] = true;
    assert_int_equal(neighbours_nearest(row.neighbours, 4, apart, SENSORS, near), 3);
    assert_true(near[0] == 2 && near[1] == 1 && near[2] == 0);
    leave(&row);
}

TEST_WITH(test_of_two_nobody_can_tell_which, prep_case_set_up, prep_case_tear_down)
{
    struct recorded_series two = all_series[1];
    struct row_of_sensors row;
    struct drift drifts[SENSORS];
    two.count = 2;
    read_series(&two);
    stand_sensors(*state, 2, &row);
    find(&row, &two, DRIFT_HOURS, 0, 20, drifts);
    for (int i = 0; i < 2; i++)
        assert_int_equal(drifts[i].verdict, DRIFT_UNKNOWN);
    leave(&row);
}
