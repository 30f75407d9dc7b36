/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Conversion of units: a value in one unit must never be shown with another unit. Tests the conversion factors against known
   numbers, and every path by which values arrive. */
#include "tests/support/test.h"

#include "base/text/text.h"
#include "deploy/demo/sim_encode.h"
#include "history/history.h"
#include "history/import.h"
#include "history/month.h"
#include "history/recorder.h"
#include "history/series_text.h"
#include "plant/tags/units.h"
#include "loopcheck/loop_checks.h"
#include "tests/support/plant_case.h"
#include "value/decode.h"
#include "value/derived.h"
#include "value/quality.h"

#define CASE(name) TEST_ON(struct plant_case *c, name, plant_case_set_up, plant_case_tear_down)

/* --- the table -------------------------------------------------------------------------------------------------------------- */

/* Expected values are those of GNU units 2.22; those of temperatures follow from the definitions of the scales. */
TEST(values_are_converted)
{
    static const struct {
        double value;
        const char *from;
        double wanted;
        const char *to;
    } known[] = {
        { 212, "°F", 100, "°C" },
        { -40, "degF", -40, "Cel" },
        { 0, "℃", 273.15, "K" },
        { 491.67, "degR", 0, "°C" },
        { 77, "[degF]", 25, "C" },
        { 9, "delta °F", 5, "ΔK" },
        { 1, "bar", 14.503774, "psi" },
        { 14.503774, "psig", 1, "bar(g)" },
        { 1, "bara", 100, "kPa abs" },
        { 1, "kgf/cm²", 0.980665, "bar" },
        { 760, "mmHg", 1.0132501, "bar" },
        { 30, "inHg", 101.59166, "kPa" },
        { 100, "mmH2O", 9.80665, "hPa" },
        { 27.7, "inWC", 6.8997630, "kPa" },
        { 100, "gpm", 22.712471, "m³/h" },
        { 36, "m3/h", 10, "L/s" },
        { 1, "ML", 1000, "m3" },
        { 1, "mL", 1, "ml" },
        { 24, "ML/d", 1000, "m3/h" },
        { 1, "Mg", 1000, "kg" },
        { 1000, "bbl/d", 6.6244706, "m3/h" },
        { 1, "ft3/min", 28.316847, "l/min" },
        { 1, "Nm3/h", 16.666667, "Nl/min" },
        { 1, "t/h", 2204.6226, "lb/h" },
        { 3.6, "t/h", 1, "kg/s" },
        { 1, "in", 25.4, "mm" },
        { 10, "ft", 3.048, "m" },
        { 3, "mil", 76.2, "µm" },
        { 0.3, "in/s", 7.62, "mm/s" },
        { 1, "mm/s RMS", 0.039370079, "in/s rms" },
        { 100, "ft/min", 0.508, "m/s" },
        { 36, "km/h", 10, "m/s" },
        { 1, "hp", 0.74569987, "kW" },
        { 1000, "BTU/h", 293.07107, "W" },
        { 2, "MW", 2000, "kW" },
        { 0.5, "1", 50, "%" },
        { 5, "‰", 0.5, "%" },
        { 1, "kWh", 3.6, "MJ" },
        { 62.427961, "lb/ft3", 1000, "kg/m³" },
        { 180, "°", 3.1415927, "rad" },
        { 1500, "1/min", 25, "r/s" },
        { 1, "kg/h", 1, "KG/H" },
    };
    for (size_t i = 0; i < sizeof(known) / sizeof(*known); i++) {
        struct unit_change change;
        enum unit_match match = units_compare(known[i].from, known[i].to, &change);
        double got = unit_change_value(&change, known[i].value);
        if (match > UNITS_CONVERT || fabs(got - known[i].wanted) > 1e-7 * fabs(known[i].wanted) + 1e-9)
            fail_msg("%g %s: %.9g %s, not %.9g", known[i].value, known[i].from, got, known[i].to, known[i].wanted);
        assert_true(fabs(unit_change_back(&change, got) - known[i].value) < 1e-9 * (1 + fabs(known[i].value)));
    }
}

TEST(what_is_not_the_same_is_kept_apart)
{
    static const struct {
        const char *a, *b;
        enum unit_match match;
    } pairs[] = {
        { "bara", "barg", UNITS_OTHER_KIND },  { "bar", "barg", UNITS_OTHER_KIND },
        { "psia", "psi", UNITS_OTHER_KIND },   { "K", "ΔK", UNITS_OTHER_KIND },
        { "Nm3/h", "m3/h", UNITS_OTHER_KIND }, { "Nm3/h", "Sm3/h", UNITS_OTHER_KIND },
        { "kg/h", "m3/h", UNITS_OTHER_KIND },  { "mm/s", "mm/s RMS", UNITS_OTHER_KIND },
        { "Hz", "rpm", UNITS_OTHER_KIND },     { "kVA", "kW", UNITS_OTHER_KIND },
        { "mW", "MW", UNITS_CONVERT },         { "MPa", "mPa", UNITS_CONVERT },
        /* the case of a prefix never changes: mega is not milli */
        { "ML", "m3", UNITS_CONVERT },          { "Mg", "t", UNITS_SAME },
        { "MG", "kg", UNITS_UNKNOWN },          { "MA", "mA", UNITS_UNKNOWN },
        { "Mm", "mm", UNITS_UNKNOWN },          { "Ms", "s", UNITS_UNKNOWN },
        { "Mbar", "bar", UNITS_UNKNOWN },       { "ml/d", "m3/d", UNITS_UNKNOWN },
        { "mL/d", "m3/d", UNITS_UNKNOWN },      { "ML/MIN", "m3/h", UNITS_UNKNOWN },
        { "MIN", "s", UNITS_CONVERT },          { "MBAR", "mbar", UNITS_SAME },
        { "MM", "mm", UNITS_SAME },             { "KG", "kg", UNITS_SAME },
        { "MPA", "bar", UNITS_UNKNOWN },       { "degC", "foo", UNITS_UNKNOWN },
        { "foo", "foo", UNITS_SAME },          { "NTU", "Ntu", UNITS_SAME },
        { "MFoo", "mFoo", UNITS_UNKNOWN },     { "", "", UNITS_SAME },
        { "degC", "°C", UNITS_SAME },          { "DEGC", "C", UNITS_SAME },
        { "bar g", "BARG", UNITS_SAME },       { "kn", "kN", UNITS_OTHER_KIND },
        { "nm", "N", UNITS_OTHER_KIND },       { "psi gauge", "PSI(G)", UNITS_SAME },
    };
    for (size_t i = 0; i < sizeof(pairs) / sizeof(*pairs); i++) {
        struct unit_change change;
        if (units_compare(pairs[i].a, pairs[i].b, &change) != pairs[i].match || change.converts != (pairs[i].match == UNITS_CONVERT))
            fail_msg("%s and %s: %d", pairs[i].a, pairs[i].b, (int)units_compare(pairs[i].a, pairs[i].b, &change));
    }
    char near[UNIT_NAME_BYTES];
    assert_true(unit_suggest("degX", near) && !strcmp(near, "degC"));
    char longest[500];
    memset(longest, 'k', sizeof(longest) - 1);
    longest[sizeof(longest) - 1] = 0;
    assert_null(unit_kind(longest));
}

/* --- a plant whose tags have various units ---------------------------------------------------------------------------------- */

static const char yaml[] = "plant: { name: P }\nassets: [{ id: A, model: m.glb }]\n"
                           "groups:\n"
                           "  - { id: temp, unit: °C, min: 0, max: 200, limits: { H: 90 }, alarm: { deadband: 2 } }\n"
                           "  - { id: taken, unit: °C, min: 0, max: 200, units: as-written }\n"
                           "sources: [{ id: plc, type: modbus, host: h, byte_order: ABCD, address_base: 1 }]\ntags: tags.csv\n";

#define HEAD                                                                                                                               \
    "Tag Name,Address,Data Type,Group,Asset,X,Y,Z,Scaling,Raw Low,Raw High,Scaled Low,Scaled High,Negate Value,Eng Units,"                 \
    "L,H,Deadband,Alarm Deadband\n"

CASE(rows_are_in_their_own_unit)
{
    plant_case_load(c, yaml,
                    HEAD "F,hr:0,Float,temp,A,0,0,0,,,,,,,°F,50,194,1.8,9\n"
                         "S,hr:2,Short,temp,A,0,0,0,Linear,0,1000,32,392,,degF,,,,\n"
                         "N,hr:3,Short,temp,A,0,0,0,Linear,0,1000,32,392,1,degF,,,,\n"
                         "T,hr:4,Float,taken,A,0,0,0,,,,,,,°F,,,,\n"
                         "C,hr:6,Float,temp,A,0,0,0,,,,,,,°C,,80,1,1\n"
                         "L,hr:8,Float,,,,,,,,,,,,°F,,,,\n"
                         "D,= [F] - 32,,temp,A,0,0,0,,,,,,,°F,,,,\n");
    plant_case_assert_loaded(c, 0);
    const struct plant_tag *t = c->plant->tags;
    assert_string_equal(t[0].unit, "°C");
    assert_string_equal(t[0].scale.own_unit, "°F");
    assert_true(fabs(t[0].alarms.limits[LIMIT_L] - 10) < 1e-9 && fabs(t[0].alarms.limits[LIMIT_H] - 90) < 1e-9); /* a temperature */
    assert_true(fabs(t[0].deadband - 1) < 1e-9 && fabs(t[0].alarms.settings.deadband - 5) < 1e-9);               /* a difference */
    /* limit and deadband come from the tag's group, in the group's unit */
    assert_true(t[1].alarms.limits[LIMIT_H] == 90 && t[1].alarms.settings.deadband == 2);
    assert_true(t[4].alarms.limits[LIMIT_H] == 80 && t[4].deadband == 1 && !t[4].scale.change.converts);
    assert_true(!t[3].scale.change.converts && !t[5].scale.change.converts);
    assert_string_equal(t[3].unit, "°F");
    struct history_tag *kept = test_memory(history_tags(c->plant));
    assert_true(fabs(kept[1].within - 0.2 / 100 * 200) < 1e-9); /* the tag's range spans 360 °F, which is a span of 200 °C */
    assert_string_equal(kept[0].unit, "°C");
    static const struct {
        int tag;
        double device, shown;
    } read[] = { { 0, 212, 100 }, { 0, 50, 10 },   { 1, 212, 100 }, { 2, -212, -1220 / 9.0 },
                 { 3, 212, 212 }, { 4, 100, 100 }, { 5, 212, 212 } };
    for (size_t i = 0; i < sizeof(read) / sizeof(*read); i++) {
        uint16_t words[4];
        struct sample sample;
        assert_true(sim_encode(&t[read[i].tag], read[i].device, words));
        decode_sample(&t[read[i].tag], words, &sample);
        if (fabs(sample.value - read[i].shown) > 1e-4)
            fail_msg("%s: %g is shown as %.9g, not %.9g", t[read[i].tag].name, read[i].device, sample.value, read[i].shown);
        assert_int_equal(sample.quality, QUALITY_GOOD);
    }
}

/* In an expression, each tag has its value in the unit of that tag's row in the tag list. */
CASE(derived_tags_compute_as_rows_say)
{
    plant_case_load(c, yaml,
                    "Tag Name,Address,Data Type,Group,Asset,X,Y,Z,Eng Units\n"
                    "F,hr:0,Float,temp,A,0,0,0,°F\nG,hr:2,Float,temp,A,0,0,0,°F\nC,hr:4,Float,temp,A,0,0,0,°C\n"
                    "M,\"= mean([F], [G])\",,temp,A,0,0,0,°F\n"
                    "B,= [F] - [C],,,,,,,\n");
    plant_case_assert_loaded(c, 1);
    FOUND(c, { "tags.csv", 6, 3, "Address: '= [F] - [C]' combines C in °C with F in °F" });
    struct store *store = test_store(c->plant);
    struct derived_state *derived = derived_create(c->plant);
    const struct sample samples[] = { { 0, 100, QUALITY_GOOD }, { 1, 50, QUALITY_GOOD }, { 2, 0, QUALITY_GOOD } };
    struct snapshot *snapshot = test_snapshot(c->plant->tag_count);
    store_write(store, samples, 3, 1, 1);
    derived_compute(derived, store, 2, 2);
    store_snapshot(store, 3, 3, snapshot);
    assert_true(fabs(snapshot->readings[3].value - 75) < 1e-9);
    derived_destroy(&derived);
}

CASE(what_cannot_be_converted_is_an_error_at_its_cell)
{
    plant_case_load(c, yaml,
                    "Tag Name,Address,Group,Asset,X,Y,Z,Eng Units\n"
                    "A,hr:0,temp,A,0,0,0,bar\nB,hr:0,temp,A,0,0,0,degX\nC,hr:0,taken,A,0,0,0,bar\nD,hr:0,temp,A,0,0,0,°F\n");
    assert_null(c->plant);
    FOUND(c, { "tags.csv", 2, 21, "'bar' (pressure (absolute or gauge not stated)) cannot be converted to '°C' (temperature)" },
          { "tags.csv", 3, 21,
            "'degX' cannot be converted to '°C', the unit of its group, since 'degX' is not known; did you mean 'degC'?" });
    plant_case_load(c, yaml, "Tag Name,Address,Group,Asset,X,Y,Z,Eng Units,H,HH\nA,hr:0,temp,A,0,0,0,°F,,190\n");
    FOUND(c, { "tags.csv", 2, 25, "H of the group is 90, but HH is 87.7777778, in °C; expected LL < L < H < HH" });
}

/* If a tag's unit changes at a reload, its old reading must not be carried over. */
TEST_WITH(readings_are_not_adopted_in_another_unit, plant_case_set_up, plant_case_tear_down)
{
    struct plant_case *c = *state, other = { .folder = c->folder, .path = c->path };
    static const char rows[] = "Tag Name,Address,Data Type,Group,Asset,X,Y,Z,Eng Units\n"
                               "F,hr:0,Float,temp,A,0,0,0,%s\nC,hr:2,Float,temp,A,0,0,0,\n";
    char *before = test_printf(rows, "°C"), *after = test_printf(rows, "°F");
    plant_case_load(c, yaml, before);
    plant_case_load(&other, yaml, after);
    struct store *was = test_store(c->plant), *is = test_store(other.plant);
    struct snapshot *snapshot = test_snapshot(2);
    const struct sample samples[] = { { 0, 212, QUALITY_GOOD }, { 1, 70, QUALITY_GOOD } };
    store_write(was, samples, 2, 1, 1);
    store_adopt(is, was);
    store_snapshot(is, 2, 2, snapshot);
    assert_int_equal(snapshot->readings[0].quality, QUALITY_BAD_WAITING);
    assert_true(snapshot->readings[1].value == 70);
    /* a loop check that was made with the other unit must become void: the fingerprints differ */
    assert_true(loop_check_fingerprint(c->plant, 0) != loop_check_fingerprint(other.plant, 0));
    assert_true(loop_check_fingerprint(c->plant, 1) == loop_check_fingerprint(other.plant, 1));
    plant_case_forget(&other);
}

/* --- files ------------------------------------------------------------------------------------------------------------------ */

/* Values in imported files have the unit of the tag's row unless the file states one. An exported file states its unit, and
   importing it again must give the same values. */
CASE(files_say_their_unit_or_mean_the_row_s)
{
    static const int64_t start_us = INT64_C(1792886400) * US_PER_S;
    struct diag diag = { 0 };
    struct import_counts counts;
    struct history_series series;
    struct text out = { 0 };
    struct log *log = test_log();
    plant_case_load(c, yaml, "Tag Name,Address,Data Type,Group,Asset,X,Y,Z,Eng Units,Deadband\nF,hr:0,Float,temp,A,0,0,0,°F,0\n");
    plant_case_assert_loaded(c, 0);
    char *folder = temp_path(c->folder, "h"), *again = temp_path(c->folder, "again");
    char *path = temp_write_text(c->folder, "s.csv",
                                 "Tag,Time,Value,Unit\nF,2026-10-25T00:00:01Z,212,\nF,2026-10-25T00:00:02Z,373.15,K\n"
                                 "F,2026-10-25T00:00:03Z,50,degC\n");
    struct import_params params = { .log = log, .plant = c->plant, .folder = folder, .path = path, .start_us = INT64_MIN };
    assert_true(history_import(&params, &diag, &counts));
    for (int pass = 0; pass < 2; pass++) {
        struct history_reader *reader = history_reader_create(log, pass ? again : folder);
        assert_int_equal(history_series(reader, "F", start_us, start_us + 9 * US_PER_S, 100, &series), 0);
        history_reader_destroy(&reader);
        assert_int_equal(series.points.count, 4); /* four points, of which the last has no value because the recording ends there */
        for (int i = 0; i < 3; i++)
            assert_true(fabs(series.points.at[i].value - (i < 2 ? 100 : 50)) < 1e-6);
        series_text_csv_head(&out, false);
        series_text_csv(&out, "F", c->plant->tags[0].unit, &series);
        history_series_finish(&series);
        assert_non_null(strstr(out.at, "\nF,2026-10-25T00:00:01.000Z,100,0x00000000,°C\r\n"));
        temp_write_text(c->folder, "s.csv", out.at);
        text_finish(&out);
        params.folder = again;
        assert_true(pass || history_import(&params, &diag, &counts));
    }
    temp_write_text(c->folder, "s.csv", "Tag,Time,Value,Unit\nF,2026-10-25T00:00:01Z,212,bar\n");
    assert_false(history_import(&params, &diag, &counts));
    assert_non_null(strstr(diag.items[0].text, "unit 'bar' cannot be converted to '°C', the unit in which tag F is recorded"));
    diag_finish(&diag);
}

/* Values recorded in several units: every query must return all of them in the tag's present unit, and an exported file must
   use one unit only. */
CASE(what_was_recorded_is_shown_in_the_unit_of_now)
{
    static const int64_t start_us = INT64_C(1792886400) * US_PER_S;
    static const char rows[] = "Tag Name,Address,Data Type,Group,Asset,X,Y,Z,Eng Units,Deadband\nF,hr:0,Float,%s,A,0,0,0,°F,0\n";
    struct diag diag = { 0 };
    struct import_counts counts;
    struct log *log = test_log();
    char *taken = test_printf(rows, "taken"), *converted = test_printf(rows, "temp"), *folder = temp_path(c->folder, "h");
    char *path = temp_write_text(c->folder, "s.csv", "Tag,Time,Value\nF,2026-10-25T00:00:01Z,212\nF,2026-10-25T00:10:00Z,212\n");
    plant_case_load(c, yaml, taken);
    struct import_params params = { .log = log, .plant = c->plant, .folder = folder, .path = path, .start_us = INT64_MIN };
    assert_true(history_import(&params, &diag, &counts));
    plant_case_load(c, yaml, converted);
    for (int pass = 0; pass < 2; pass++) {
        struct history_reader *reader = history_reader_create(log, folder);
        struct history_tag *tags = history_tags(c->plant);
        struct snapshot *snapshot = test_snapshot(1);
        struct history_series points, buckets;
        /* in the second pass the reader has no plant, so it must use the unit that the month file states: the import in °C has kept °F */
        history_reader_show_by(reader, pass ? NULL : c->plant);
        assert_int_equal(history_series(reader, "F", start_us, start_us + 7200 * US_PER_S, 20000, &points), 0);
        assert_int_equal(history_intervals(reader, "F", start_us, start_us + 3600 * US_PER_S, 10, &buckets), 0);
        assert_int_equal(history_at(reader, tags, start_us + 2 * US_PER_S, snapshot), 0);
        assert_true(points.points.count >= 2 && fabs(points.points.at[0].value - (pass ? 212 : 100)) < 1e-9);
        assert_true(fabs(points.points.at[points.points.count - 2].value - (pass ? 50 : 100)) < 1e-9);
        assert_true(buckets.buckets.count > 0 && fabs(buckets.buckets.at[0].high - (pass ? 212 : 100)) < 1e-9);
        assert_true(fabs(snapshot->readings[0].value - 100) < 1e-9);
        history_series_finish(&points);
        history_series_finish(&buckets);
        history_reader_destroy(&reader);
        mem_free(tags);
        temp_write_text(c->folder, "s.csv", "Tag,Time,Value\nF,2026-10-25T02:00:00Z,50\n");
        params.plant = c->plant;
        assert_true(pass || history_import(&params, &diag, &counts));
    }
}
