/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Expressions of derived tags: their values, syntax errors with positions, and how quality and age of the inputs determine
   those of the result. */
#include "tests/support/test.h"

#include "plant/tags/expression.h"
#include "tests/support/plant_by_hand.h"
#include "tests/support/plant_case.h"
#include "value/derived.h"
#include "value/quality.h"

#define S INT64_C(1000000000)

/* names of the variables that the tests use; their values: a is 8, b is 3, "TT-1/A (x)" is -2 */
static const char *const names[] = { "a", "b", "TT-1/A (x)" };
static const double numbers[] = { 8, 3, -2 };

static int find(const void *arg, const char *name)
{
    (void)arg;
    for (int i = 0; i < 3; i++)
        if (!strcmp(names[i], name))
            return i;
    return -1;
}

static double worth(const char *text)
{
    char why[200] = "";
    size_t at;
    const int *inputs;
    double values[EXPRESSION_INPUTS];
    struct expression *expression = expression_parse(text, find, NULL, why, &at);
    if (!expression)
        print_message("# %s: %s at %zu\n", text, why, at);
    assert_non_null(expression);
    size_t count = expression_inputs(expression, &inputs);
    for (size_t i = 0; i < count; i++)
        values[i] = numbers[inputs[i]];
    double value = expression_value(expression, values);
    expression_destroy(&expression);
    return value;
}

TEST(arithmetic)
{
    static const struct {
        const char *text;
        double value;
    } cases[] = {
        { "1", 1 }, { ".5", .5 }, { "1.5e3", 1500 }, { "2e-1", .2 }, { " 1 + 2 * 3 ", 7 }, { "(1+2)*3", 9 }, { "7-3-2", 2 }, { "8/4/2", 1 },
        { "2^3^2", 512 }, { "-2^2", -4 }, { "2^-1", .5 }, { "--3", 3 }, { "2*-3", -6 }, { "1-(-1)", 2 }, { "[a]-[b]", 5 }, { "[a]-[a]", 0 },
        { "[TT-1/A (x)]", -2 }, { "-[TT-1/A (x)]^2", -4 }, { "mean([a],[b],1)", 4 }, { "mean( [a] ; [b] )", 5.5 }, { "sum(1,2,3)", 6 },
        { "min([a],[b],[TT-1/A (x)])", -2 }, { "max([b],[a])", 8 }, { "abs([TT-1/A (x)])", 2 }, { "sqrt([a]*2)", 4 },
        { "difference([a],[b])", 5 }, { "approach(100, 60, 20, 50)", 40 }, { "approach(100, 60, 20, 70)", 30 },
        { "lmtd(100, 60, 20, 60)", 40 }, { "lmtd(100, 40, 20, 60)", 20 / 0.69314718055994531 }, { "mean(mean([a],[b]),min(1,2))", 3.25 },
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++)
        if (!(fabs(worth(cases[i].text) - cases[i].value) < 1e-12))
            fail_msg("%s is %.17g, expected %.17g", cases[i].text, worth(cases[i].text), cases[i].value);
    assert_false(isfinite(worth("1/0")));
    assert_false(isfinite(worth("sqrt(-1)")));
    assert_false(isfinite(worth("lmtd(100, 20, 20, 60)")));
    /* If any argument is NaN or infinite, the expression must have no value, even if the result would not depend on that
       argument. */
    static const char *const parts[] = { "min(1, sqrt(-1))",  "max(1, sqrt(-1))",          "min(1, 1/0)",
                                         "1/(1/0)",           "sqrt(-1)^0",                "1^sqrt(-1)",
                                         "max(1, -1/0)",      "approach(sqrt(-1),2,1,0)",  "approach(2,sqrt(-1),1,0)" };
    for (size_t i = 0; i < sizeof(parts) / sizeof(*parts); i++)
        if (isfinite(worth(parts[i])))
            fail_msg("%s is %g, expected no value", parts[i], worth(parts[i]));
}

TEST(mistakes_are_found)
{
    static const struct {
        const char *text, *why;
        size_t at;
    } cases[] = {
        { "", "needs [TAG]", 0 },
        { "1+", "needs [TAG]", 2 },
        { "1 2", "or the end here, found '2'", 2 },
        { "[c]", "unknown tag 'c'", 0 },
        { "[a", "needs ]", 0 },
        { "(1", "expected )", 2 },
        { "1)", "or the end", 1 },
        { "TT-101", "needs [TAG], a number, or one of", 0 },
        { "mean 1", "expected ( after mean", 5 },
        { "mean()", "needs [TAG]", 5 },
        { "mean(1", "the expression needs ) after the arguments of mean", 6 },
        { "abs(1,2)", "expected 1 argument for abs, found 2", 7 },
        { "1..2", "needs a number", 0 },
        { "1e", "needs a number", 0 },
        { "0x10", "or the end", 1 },
        { "2**3", "needs [TAG]", 2 },
        { "[]", "unknown tag ''", 0 },
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
        char why[200] = "";
        size_t at;
        assert_null(expression_parse(cases[i].text, find, NULL, why, &at));
        if (!strstr(why, cases[i].why) || at != cases[i].at)
            fail_msg("%s: '%s' at %zu, expected '%s' at %zu", cases[i].text, why, at, cases[i].why, cases[i].at);
    }
}

TEST(long_and_deep_ones_are_refused)
{
    char text[4000], why[200];
    size_t at;
    memset(text, '(', 3000);
    text[3000] = 0;
    assert_null(expression_parse(text, find, NULL, why, &at));
    memset(text, '-', 3000);
    assert_null(expression_parse(text, find, NULL, why, &at));
    for (int i = 0; i < 3000; i++)
        text[i] = i % 2 ? '+' : '1';
    text[2999] = 0;
    assert_null(expression_parse(text, find, NULL, why, &at));
}

/* --- derived tags ----------------------------------------------------------------------------------------------------------- */

static const char yaml[] = "plant: { name: P }\nassets: [{ id: A, model: m.glb }]\ngroups: [{ id: g, unit: K, min: 0, max: 9 }]\n"
                           "sources: [{ id: plc, type: modbus, host: h }]\ntags: tags.csv\n";

static void write_one(struct store *store, int tag, double value, uint32_t quality, int64_t now_ns)
{
    store_write(store, &(struct sample){ tag, value, quality }, 1, now_ns, now_ns + 1000 * S);
}

TEST_ON(struct plant_case *c, quality_and_age_are_carried_through, plant_case_set_up, plant_case_tear_down)
{
    plant_case_load(c, yaml, "Tag Name,Address,Stale s\nmean,\"=mean([d],[b])\",\na,40001,20\nb,40002,60\nd,= [a] - [b],\n");
    plant_case_assert_loaded(c, 0);
    const struct plant *plant = c->plant;
    assert_true(plant->tags[0].source == -1 && plant->derived_count == 2 && plant->derived[0] == 3 && plant->derived[1] == 0);
    assert_true(plant->tags[3].validity.stale_s == 60 &&
                plant->tags[0].validity.stale_s == 60); /* a derived tag without a `Stale s` of its own has the same one as its inputs */
    struct store *store = test_store(plant);
    struct snapshot *snapshot = test_snapshot(plant->tag_count);
    struct derived_state *derived = derived_create(plant);
    const struct {
        int64_t at_s;
        int tag;
        double value;
        uint32_t quality, wanted;
        double d, mean;
        int64_t age_s;
    } steps[] = {
        { 0, 1, 10, QUALITY_GOOD, QUALITY_BAD_WAITING, 0, 0, -1 },
        { 1, 2, 4, QUALITY_GOOD, QUALITY_GOOD, 6, 5, 0 },
        { 3, 1, 11, QUALITY_GOOD, QUALITY_GOOD, 7, 5.5, 0 },
        { 5, -1, 0, 0, QUALITY_GOOD, 7, 5.5, 2 }, /* no new input: computing the value again must not make it younger */
        { 6, 1, 12, QUALITY_UNCERTAIN_UNITS_EXCEEDED, QUALITY_UNCERTAIN_UNITS_EXCEEDED, 8, 6, 0 },
        { 7, 1, 12, QUALITY_BAD_SENSOR_FAILURE, QUALITY_BAD_SENSOR_FAILURE, 0, 0, -1 },
        { 8, 1, 12, QUALITY_GOOD, QUALITY_GOOD, 8, 6, 0 },
        /* the reading of tag a is stale by now, so the derived value must be stale too */
        { 29, -1, 0, 0, QUALITY_BAD_COMMUNICATION_ERROR, 0, 0, -1 },
    };
    for (size_t i = 0; i < sizeof(steps) / sizeof(*steps); i++) {
        int64_t now_ns = steps[i].at_s * S;
        if (steps[i].tag >= 0)
            write_one(store, steps[i].tag, steps[i].value, steps[i].quality, now_ns);
        derived_compute(derived, store, now_ns, now_ns + 1000 * S);
        store_snapshot(store, now_ns, now_ns + 1000 * S, snapshot);
        const struct reading *d = &snapshot->readings[3], *mean = &snapshot->readings[0];
        assert_string_equal(quality_name(d->quality), quality_name(steps[i].wanted));
        assert_string_equal(quality_name(mean->quality), quality_name(steps[i].wanted));
        if (steps[i].age_s >= 0)
            assert_true(d->value == steps[i].d && mean->value == steps[i].mean && d->age_ns == steps[i].age_s * S);
    }
    derived_destroy(&derived);
}

/* Inputs are dated by their devices. A late sample, which is older than the newest input, must nevertheless change the result.
   */
TEST_ON(struct plant_case *c, late_inputs_change_the_result, plant_case_set_up, plant_case_tear_down)
{
    plant_case_load(c, yaml, "Tag Name,Address,Stale s\na,40001,60\nb,40002,60\nd,= [a] - [b],\n");
    plant_case_assert_loaded(c, 0);
    struct store *store = test_store(c->plant);
    struct snapshot *snapshot = test_snapshot(c->plant->tag_count);
    struct derived_state *derived = derived_create(c->plant);
    static const struct {
        int tag, sampled_s, now_s;
        double value;
        uint32_t quality;
        double d;
    } steps[] = {
        { 1, 1, 1, 4, QUALITY_GOOD, NAN },
        { 0, 10, 11, 10, QUALITY_GOOD, 6 },
        { 1, 10, 12, 3, QUALITY_GOOD, 7 }, /* this sample has the same time as the newest input */
        { 0, 20, 21, 10, QUALITY_GOOD, 7 },
        { 1, 19, 22, 2, QUALITY_GOOD, 8 }, /* older than the newest input */
        { 1, 23, 30, 0, QUALITY_BAD_SENSOR_FAILURE, NAN },
        { 1, 24, 31, 2, QUALITY_GOOD, 8 },
        { 1, 25, 32, 1, QUALITY_GOOD, 9 }, /* this sample is dated before the result became Good again */
    };
    for (size_t i = 0; i < sizeof(steps) / sizeof(*steps); i++) {
        write_one(store, steps[i].tag, steps[i].value, steps[i].quality, steps[i].sampled_s * S);
        derived_compute(derived, store, steps[i].now_s * S, (1000 + steps[i].now_s) * S);
        store_snapshot(store, steps[i].now_s * S, (1000 + steps[i].now_s) * S, snapshot);
        const struct reading *d = &snapshot->readings[2];
        if (isnan(steps[i].d) ? !quality_is_bad(d->quality) : quality_is_bad(d->quality) || d->value != steps[i].d)
            fail_msg("step %zu: the result is %g (%s), expected %g", i, d->value, quality_name(d->quality), steps[i].d);
    }
    derived_destroy(&derived);
}

/* The result of a derived tag is compared with the tag's measuring range, which the tag list states in the unit of its row: 212
   °F are 100 °C and 373.15 K. Results beyond the range are Uncertain. */
TEST_ON(struct plant_case *c, results_beyond_the_range_are_uncertain, plant_case_set_up, plant_case_tear_down)
{
    plant_case_load(c, yaml,
                    "Tag Name,Address,Stale s,Group,Asset,X,Y,Z,Eng Units,Scaled Low,Scaled High\n"
                    "a,40001,60,,,,,,,,\nd,= [a] * 2,,g,A,0,0,0,°F,32,212\n");
    plant_case_assert_loaded(c, 0);
    struct store *store = test_store(c->plant);
    struct snapshot *snapshot = test_snapshot(c->plant->tag_count);
    struct derived_state *derived = derived_create(c->plant);
    static const double values[] = { 106, 106.1, 16, 15.9, 50 };
    static const bool beyond[] = { false, true, false, true, false };
    for (int i = 0; i < 5; i++) {
        write_one(store, 0, values[i], QUALITY_GOOD, (i + 1) * S);
        derived_compute(derived, store, (i + 1) * S, (i + 1001) * S);
        store_snapshot(store, (i + 1) * S, (i + 1001) * S, snapshot);
        assert_string_equal(quality_name(snapshot->readings[1].quality),
                            quality_name(beyond[i] ? QUALITY_UNCERTAIN_UNITS_EXCEEDED : QUALITY_GOOD));
        assert_true(fabs(snapshot->readings[1].value - (2 * values[i] + 459.67) * 5 / 9) < 1e-9);
    }
    derived_destroy(&derived);
}

TEST_ON(struct plant_case *c, rows_are_checked, plant_case_set_up, plant_case_tear_down)
{
    plant_case_load(c, yaml,
                    "Tag Name,Address,Source,Scaling\n"
                    "a,= [b] + 1,,\nb,= [c],,\nc,=[a]*2,,\nd,=[e],,\nf,=1+,,\ng,=2,plc,\nh,=3,,Linear\ni,=[i],,\n");
    FOUND(c, { "tags.csv", 2, 3, "'a' is computed from itself" }, { "tags.csv", 5, 3, "unknown tag 'e', at character 2" },
          { "tags.csv", 6, 3, "Address: '=1+': the expression needs [TAG], a number, or one of" },
          { "tags.csv", 7, 6, "Source: must be empty, because Address is an expression that computes the tag from other tags" },
          { "tags.csv", 8, 7, "Scaling: expected None, because the value is already in engineering units" },
          { "tags.csv", 8, 1, "Raw Low" }, { "tags.csv", 8, 1, "Scaled Low" });
}
