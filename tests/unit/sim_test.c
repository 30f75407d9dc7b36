/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parts of plantcast-sim: encoding compared with the daemon's decoding, the process model, and recorded series and their mapping. */
#include "tests/support/test.h"

#include "base/files/atomic_file.h"
#include "deploy/demo/sim_encode.h"
#include "deploy/demo/sim_image.h"
#include "deploy/demo/sim_map.h"
#include "deploy/demo/sim_process.h"
#include "value/series.h"
#include "value/decode.h"
#include "value/quality.h"

/* --- encoding --------------------------------------------------------------------------------------------------------------- */

static double random_between(double low, double high)
{
    return low + (high - low) * (rand() / (double)RAND_MAX);
}

/* Returns the error that encoding a value in the tag's raw type may cause: half a raw step for integers, the precision of a
   float otherwise. */
static double tolerance(const struct plant_tag *tag, double raw_low, double raw_high)
{
    double step = tag->signal.type == DATA_FLOAT32   ? fmax(fabs(raw_low), fabs(raw_high)) * 1.2e-7
                  : tag->signal.type == DATA_FLOAT64 ? 1e-9
                                                     : 0.500001;
    double per_raw = tag->scale.kind == SCALING_NONE ? 1 : fabs((tag->scale.scaled_high - tag->scale.scaled_low) / (raw_high - raw_low));
    return step * per_raw + 1e-9;
}

static void check_there_and_back(const struct plant_tag *tag, double value, double allowed)
{
    uint16_t words[4] = { 0x5555, 0x5555, 0x5555, 0x5555 };
    struct sample sample;
    assert_true(sim_encode(tag, value, words));
    decode_sample(tag, words, &sample);
    /* with square-root scaling, raw steps are steps of the value's square, so the error is larger for small values */
    if (tag->scale.kind == SCALING_SQUARE_ROOT) {
        double low = tag->scale.negate ? -tag->scale.scaled_low : tag->scale.scaled_low;
        allowed = allowed * fabs(tag->scale.scaled_high - tag->scale.scaled_low) /
                  fmax(fabs(value - low), sqrt(allowed * fabs(tag->scale.scaled_high - tag->scale.scaled_low)));
    }
    if (fabs(sample.value - value) > allowed)
        fail_msg("type %d order %d scaling %d negate %d: %.12g came back as %.12g (allowed %.3g)", tag->signal.type, tag->signal.byte_order,
                 tag->scale.kind, tag->scale.negate, value, sample.value, allowed);
    assert_int_equal(sample.quality, QUALITY_GOOD);
}

TEST(what_is_encoded_is_decoded)
{
    static const double raws[][2] = {
        [DATA_INT16] = { -32000, 32000 }, [DATA_UINT16] = { 0, 65000 }, [DATA_INT32] = { -2e9, 2e9 }, [DATA_UINT32] = { 0, 4e9 },
        [DATA_FLOAT32] = { -1000, 1000 }, [DATA_INT64] = { -1e12, 1e12 }, [DATA_UINT64] = { 0, 1e13 }, [DATA_FLOAT64] = { -1e5, 1e5 },
        [DATA_BCD] = { 0, 9999 },         [DATA_LBCD] = { 0, 99999999 },
    };
    srand(1);
    for (int type = DATA_INT16; type <= DATA_LBCD; type++)
        for (int order = BYTE_ORDER_ABCD; order <= BYTE_ORDER_DCBA; order++)
            for (int scaling = SCALING_NONE; scaling <= SCALING_SQUARE_ROOT; scaling++)
                for (int negate = 0; negate < 2; negate++) {
                    double low = raws[type][0], high = raws[type][1];
                    struct plant_tag tag = { .signal.table = TABLE_HOLDING,
                                             .signal.bit = -1,
                                             .signal.type = (enum data_type)type,
                                             .signal.byte_order = (enum byte_order)order,
                                             .scale.kind = (enum scaling)scaling,
                                             .scale.raw_low = low,
                                             .scale.raw_high = high,
                                             .scale.scaled_low = -40,
                                             .scale.scaled_high = 260,
                                             .scale.negate = negate };
                    assert_int_equal(sim_encode_width(&tag), decode_width(&tag));
                    double from = scaling ? -40 : low, to = scaling ? 260 : high;
                    for (int i = 0; i < 50; i++) {
                        double value = i == 0 ? from : i == 1 ? to : random_between(from, to);
                        check_there_and_back(&tag, negate ? -value : value, tolerance(&tag, low, high));
                    }
                }
}

TEST(bytes_lie_as_the_order_says)
{
    const uint16_t wanted[][2] = { { 0xC2ED, 0x4000 }, { 0xC2ED, 0x4000 }, { 0x4000, 0xC2ED }, { 0xEDC2, 0x0040 }, { 0x0040, 0xEDC2 } };
    for (int order = BYTE_ORDER_ABCD; order <= BYTE_ORDER_DCBA; order++) {
        struct plant_tag tag = {
            .signal.table = TABLE_INPUT, .signal.bit = -1, .signal.type = DATA_FLOAT32, .signal.byte_order = (enum byte_order)order
        };
        uint16_t words[2];
        assert_true(sim_encode(&tag, -118.625, words));
        assert_int_equal(words[0], wanted[order][0]);
        assert_int_equal(words[1], wanted[order][1]);
    }
}

TEST(bits_leave_their_neighbours_alone)
{
    for (int order = BYTE_ORDER_NONE; order <= BYTE_ORDER_DCBA; order++)
        for (int bit = 0; bit < 16; bit++)
            for (int negate = 0; negate < 2; negate++) {
                struct plant_tag tag = { .signal.table = TABLE_HOLDING,
                                         .signal.bit = bit,
                                         .signal.type = DATA_BIT,
                                         .signal.byte_order = (enum byte_order)order,
                                         .scale.negate = negate };
                uint16_t word = 0xA5C3;
                check_there_and_back(&tag, 1, 0);
                check_there_and_back(&tag, 0, 0);
                assert_true(sim_encode(&tag, 1, &word) && sim_encode(&tag, 0, &word));
                int changed = word ^ 0xA5C3;
                assert_true((changed & (changed - 1)) == 0); /* at most one bit changes */
            }
    struct plant_tag coil = { .signal.table = TABLE_COIL, .signal.bit = -1, .signal.type = DATA_BIT };
    check_there_and_back(&coil, 1, 0);
    check_there_and_back(&coil, 0, 0);
}

TEST(too_much_becomes_the_most)
{
    const struct {
        enum data_type type;
        double value, wanted;
    } cases[] = {
        { DATA_INT16, 1e9, 32767 },     { DATA_INT16, -1e9, -32768 },  { DATA_UINT16, -5, 0 },
        { DATA_UINT16, 70000, 65535 },  { DATA_BCD, 12345, 9999 },     { DATA_LBCD, 1e9, 99999999 },
        { DATA_INT64, 1e30, 0x1p63 },   { DATA_UINT64, 1e30, 0x1p64 }, { DATA_INT64, -1e30, -0x1p63 },
        { DATA_INT32, 3e9, 2147483647 }, { DATA_UINT32, -1, 0 },
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        struct plant_tag tag = {
            .signal.table = TABLE_HOLDING, .signal.bit = -1, .signal.type = cases[i].type, .signal.byte_order = BYTE_ORDER_ABCD
        };
        uint16_t words[4];
        struct sample sample;
        assert_true(sim_encode(&tag, cases[i].value, words));
        decode_sample(&tag, words, &sample);
        assert_true(sample.value == cases[i].wanted);
    }
}

TEST(only_floats_hold_no_number)
{
    struct plant_tag tag = {
        .signal.table = TABLE_HOLDING, .signal.bit = -1, .signal.type = DATA_FLOAT32, .signal.byte_order = BYTE_ORDER_CDAB
    };
    uint16_t words[4] = { 0 };
    struct sample sample;
    assert_true(sim_encode(&tag, NAN, words));
    decode_sample(&tag, words, &sample);
    assert_int_equal(sample.quality, QUALITY_BAD_SENSOR_FAILURE);
    tag.signal.type = DATA_INT16;
    words[0] = 77;
    assert_false(sim_encode(&tag, NAN, words));
    assert_false(sim_encode(&tag, INFINITY, words));
    assert_int_equal(words[0], 77);
}

TEST(only_named_registers_exist)
{
    struct sim_image image = { 0 };
    struct plant_tag tag = { .signal.table = TABLE_HOLDING,
                             .signal.register_index = 10,
                             .signal.bit = -1,
                             .signal.type = DATA_FLOAT32,
                             .signal.byte_order = BYTE_ORDER_ABCD };
    sim_image_add(&image, 3, &tag);
    assert_int_equal(sim_image_refusal(&image, 3, TABLE_HOLDING, 10, 2), 0);
    assert_int_equal(sim_image_refusal(&image, 3, TABLE_HOLDING, 10, 3), 2);
    assert_int_equal(sim_image_refusal(&image, 3, TABLE_HOLDING, 9, 2), 2);
    assert_int_equal(sim_image_refusal(&image, 3, TABLE_INPUT, 10, 2), 2);
    assert_int_equal(sim_image_refusal(&image, 3, TABLE_HOLDING, 10, 0), 3);
    assert_int_equal(sim_image_refusal(&image, 3, TABLE_HOLDING, 10, 126), 3);
    assert_int_equal(sim_image_refusal(&image, 3, TABLE_HOLDING, 65535, 2), 2);
    assert_int_equal(sim_image_refusal(&image, 4, TABLE_HOLDING, 10, 2), 11);
    sim_image_fail(&image, 3, &tag, true);
    assert_int_equal(sim_image_refusal(&image, 3, TABLE_HOLDING, 11, 1), 2);
    sim_image_fail(&image, 3, &tag, false);
    assert_int_equal(sim_image_refusal(&image, 3, TABLE_HOLDING, 11, 1), 0);
    sim_image_finish(&image);
}

/* --- the process ------------------------------------------------------------------------------------------------------------ */

static const struct process_tag unit[] = {
    { PROCESS_TEMPERATURE, 80, 100, "TI-1", "overhead" },     { PROCESS_PRESSURE, 5, 10, "PI-1", "overhead" },
    { PROCESS_TEMPERATURE, 60, 100, "TI-2", "feed preheat" }, { PROCESS_VIBRATION, 2, 12, "VI-1", "P-101" },
    { PROCESS_VIBRATION, 2, 12, "VI-2", "boiler feed pump" }, { PROCESS_TEMPERATURE, 40, 100, "TI-3", "no such word" },
    { PROCESS_TEMPERATURE, 30, 100, "TI-4", "storage" },      { PROCESS_OTHER, 0, 0, "XI-1", "" },
};
enum { TAGS = sizeof(unit) / sizeof(unit[0]), CYCLE_TICKS = 6900 };

/* statistics of one simulated tag over a cycle of process upsets: smallest and largest value, sum and number of values outside
   upsets, largest step */
struct course {
    double least, most, calm_sum, jump;
    int calm_count;
};

static void run_cycle(struct process *process, struct course courses[TAGS], int *upsets)
{
    const char *name, *before = "";
    double last[TAGS];
    for (size_t i = 0; i < TAGS; i++) {
        last[i] = process_value(process, i);
        courses[i] = (struct course){ .least = last[i], .most = last[i] };
    }
    for (int tick = 0; tick < CYCLE_TICKS; tick++) {
        process_step(process, 0.1);
        process_upset(process, &name);
        *upsets += *name && strcmp(name, before) != 0;
        before = name;
        for (size_t i = 0; i < TAGS; i++) {
            struct course *course = &courses[i];
            double value = process_value(process, i);
            assert_true(isfinite(value));
            course->least = fmin(course->least, value);
            course->most = fmax(course->most, value);
            course->jump = fmax(course->jump, fabs(value - last[i]));
            course->calm_sum += tick < 600 ? value : 0;
            course->calm_count += tick < 600;
            last[i] = value;
        }
    }
}

TEST(process_behaves)
{
    struct process *process = process_create(unit, TAGS, 1);
    struct course cycles[2][TAGS];
    int upsets = 0;
    run_cycle(process, cycles[0], &upsets);
    run_cycle(process, cycles[1], &upsets);
    assert_int_equal(upsets, 6);
    for (int c = 0; c < 2; c++) {
        const struct course *course = cycles[c];
        for (size_t i = 0; i < TAGS; i++) {
            assert_true(fabs(course[i].calm_sum / course[i].calm_count - unit[i].normal) <= 0.05 * unit[i].span); /* comes back to normal */
            /* within one tick of 0.1 s no tag may change by more than 4 % of its span */
            assert_true(course[i].jump <= 0.04 * unit[i].span);
        }
        assert_true(course[0].most - unit[0].normal > 8); /* overhead warms up */
        assert_true(course[1].most - unit[1].normal > 0.5);
        assert_true(unit[2].normal - course[2].least > 7);                                      /* fouled preheater */
        assert_true(course[3 + c].most - unit[3].normal > 3);                                   /* one bearing this time */
        assert_true(course[4 - c].most - unit[3].normal < 1.5);                                 /* the other one not */
        assert_true(course[5].most - course[5].least > 1 && course[5].most - unit[5].normal < 6); /* an unknown loop only drifts */
        assert_true(course[6].most - course[6].least < 3);                                      /* a tank takes hours */
        assert_true(course[3].least >= 0);
    }
    process_destroy(&process);
    assert_null(process);
}

TEST(process_repeats_with_its_seed)
{
    struct process *a = process_create(unit, TAGS, 5), *b = process_create(unit, TAGS, 5), *other = process_create(unit, TAGS, 6);
    for (int i = 0; i < 100; i++) {
        process_step(a, 0.1);
        process_step(b, 0.1);
        process_step(other, 0.1);
    }
    assert_true(process_value(a, 0) == process_value(b, 0));
    assert_true(process_value(a, 0) != process_value(other, 0));
    process_destroy(&a);
    process_destroy(&b);
    process_destroy(&other);
}

/* --- series and map --------------------------------------------------------------------------------------------------------- */

TEST(wide_series)
{
    char why[200];
    char *path = temp_write_text(temp_folder(), "wide.csv", "t_min,a,b,d\r\n10,1.5,-2,1\r\n13,2.5,,I/O Timeout\r\n16,3.5,4e1,hot\r\n");
    struct series series;
    bool found;
    assert_true(series_read(&series, path, "a", &found, why) && found);
    assert_int_equal(series.count, 3);
    assert_true(series.length_s == 540); /* the series lasts 9 min: 6 min to its last time plus one step of 3 min */
    assert_true(series_at(&series, 0, false) == 1.5);
    assert_true(series_at(&series, 179.9, false) == 1.5); /* held, nothing invented */
    assert_true(series_at(&series, 180, false) == 2.5);
    assert_true(series_at(&series, 1e9, false) == 3.5);
    assert_true(series_at(&series, 539, true) == 3.5);
    assert_true(series_at(&series, 541, true) == 1.5);
    series_finish(&series);
    assert_true(series_read(&series, path, "b", &found, why) && found);
    assert_int_equal(series.count, 2); /* an empty CSV cell gives no value */
    assert_true(series_at(&series, 200, false) == -2);
    series_finish(&series);
    assert_false(series_read(&series, path, "d", &found, why));
    /* the error is in line 4; line 3 has a status word instead of a number, which is allowed */
    assert_non_null(strstr(why, ":4: d: expected a number"));
    series_finish(&series);
    assert_true(series_read(&series, path, "c", &found, why));
    assert_false(found);
    assert_non_null(strstr(why, "has no series c"));
}

TEST(long_series)
{
    char why[200];
    char *path = temp_write_text(temp_folder(), "long.csv",
                                 "1636070400000,Alarm,M-1,state,NORMAL,VARCHAR\n1636070400001,Mixer,M-1,T,100,DOUBLE\n"
                                                  "1636070400002,Mixer,M-1,RPM,60,DOUBLE\n1636070406001,Mixer,M-1,T,101.5,DOUBLE");
    struct series series;
    bool found;
    assert_true(series_read(&series, path, "M-1/T", &found, why) && found);
    assert_int_equal(series.count, 2);
    assert_true(fabs(series.time_s[1] - 6.001) < 1e-9);
    assert_true(series_at(&series, 7, false) == 101.5);
    series_finish(&series);
    assert_true(series_read(&series, path, "M-2/T", &found, why));
    assert_false(found);
    assert_false(series_read(&series, path, "M-1/state", &found, why));
    assert_non_null(strstr(why, ":1: M-1/state: expected a number"));
}

TEST(bad_series)
{
    const char *const texts[] = { "t_s,a\n0,1\n2,x\n", "t_s,a\n5,1\n4,1\n", "time,a\n0,1\n", "", "t_s,a\n0\n", "t_s,a\nnan,1\n" };
    const char *const wanted[] = {
        ":3: a: expected a number", ":3: expected a time", ":1: no time column", "is empty", ":2: expected", ":2: expected"
    };
    for (int i = 0; i < 6; i++) {
        char why[200] = "", *path = temp_write_text(temp_folder(), "bad.csv", texts[i]);
        struct series series;
        bool found;
        assert_false(series_read(&series, path, "a", &found, why));
        if (!strstr(why, wanted[i]))
            fail_msg("%s: said %s", wanted[i], why);
    }
    char why[200];
    struct series series;
    bool found;
    assert_false(series_read(&series, "/nowhere/at/all.csv", "a", &found, why));
    assert_non_null(strstr(why, "No such file"));
}

TEST(map_lines)
{
    struct diag diag = { 0 };
    struct sim_map map = { 0 };
    sim_map_add(&map, "TT-1=XMEAS09", "f", 1, &diag);
    sim_map_add(&map, " TT 2 = Mixer_0-a/T * 1.8 + 32 ", "f", 2, &diag);
    sim_map_add(&map, "TT-3=TS1*-1e-1-5", "f", 3, &diag);
    assert_int_equal(diag.errors, 0);
    assert_string_equal(map.entries[0].series, "XMEAS09");
    assert_true(map.entries[0].scale == 1 && map.entries[0].offset == 0);
    assert_string_equal(map.entries[1].tag, "TT 2");
    assert_string_equal(map.entries[1].series, "Mixer_0-a/T");
    assert_true(map.entries[1].scale == 1.8 && map.entries[1].offset == 32);
    assert_true(map.entries[2].scale == -0.1 && map.entries[2].offset == -5);
    const char *const bad[] = { "TT-1", "=a", "TT-1=", "TT-1=a*", "TT-1=a*x", "TT-1=a*2+", "TT-1=a*2/3" };
    for (int i = 0; i < 7; i++) {
        sim_map_add(&map, bad[i], "f", 4 + i, &diag);
        assert_int_equal(diag.errors, i + 1);
    }
    assert_int_equal(map.count, 3);
    diag_finish(&diag);
    sim_map_finish(&map);
}

TEST(map_files)
{
    struct diag diag = { 0 };
    struct sim_map map = { 0 };
    char *folder = temp_folder();
    char *path = temp_write_text(
        folder, "a.map", "# what feeds what\nvalues ../data/x.csv\nvalues /abs/y.csv\n\nspeed 60\nloop\nT1 = a\nT2 : b\nspeed -1\n");
    sim_map_read(&map, path, &diag);
    assert_int_equal(map.file_count, 2);
    assert_string_equal(map.files[0], temp_path(folder, "../data/x.csv"));
    assert_string_equal(map.files[1], "/abs/y.csv");
    assert_true(map.loop);
    assert_int_equal(map.count, 1);
    assert_int_equal(map.entries[0].line, 7);
    assert_int_equal(diag.errors, 2);
    assert_int_equal(diag.items[0].line, 8);
    assert_int_equal(diag.items[1].line, 9);
    sim_map_read(&map, "/nowhere/b.map", &diag);
    assert_int_equal(diag.errors, 3);
    diag_finish(&diag);
    sim_map_finish(&map);
}
