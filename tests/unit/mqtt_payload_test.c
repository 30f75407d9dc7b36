/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Payloads of MQTT messages: which texts count as numbers, JSON paths, timestamps and qualities. */
#include "tests/support/test.h"

#include "plant/sources/json_path.h"
#include "value/mqtt/mqtt_payload.h"
#include "value/quality.h"

TEST(only_one_number_is_a_number)
{
    static const struct {
        const char *text;
        double value;
    } numbers[] = { { "1", 1 }, { " -1.5e3\r\n", -1500 }, { "true", 1 }, { "FALSE", 0 }, { "+2", 2 }, { "\t0.25 ", 0.25 } };
    static const char *const wrong[] = { "", " ", "1 2", "1,5", "21.5 C", "nan", "inf", "1e999", "0x10", "on", "[1]", "--1" };
    double value;
    for (size_t i = 0; i < sizeof(numbers) / sizeof(*numbers); i++) {
        assert_true(mqtt_number_read(numbers[i].text, strlen(numbers[i].text), &value));
        assert_true(value == numbers[i].value);
    }
    for (size_t i = 0; i < sizeof(wrong) / sizeof(*wrong); i++)
        assert_false(mqtt_number_read(wrong[i], strlen(wrong[i]), &value));
    assert_false(mqtt_number_read("1\0", 2, &value));
    assert_false(mqtt_number_read(NULL, 0, &value));
    char many[200];
    memset(many, '1', sizeof(many));
    assert_false(mqtt_number_read(many, sizeof(many), &value));
}

TEST(paths_are_as_written)
{
    static const char *const good[] = {
        "a",
        "$",
        "$.a",
        "$[0]",
        "a.b[12].c",
        "[0][1]",
        "[\"odd. name\"].x",
        "$[\"a\"][3]",
        "a b",
        "a-b.c",
        "a[-1]",
        "$['a']['b\\'c']",
        "[ 'a' ]",
        "[\"\\u00b0C\"]",
        "v[?@.id=='A.T2'].v",
        "v[?id=='A.T2'].v",
        "v[?(@.id==\"A.T2\")].v",
        "v[? @.a.b == 3 && @['c d']==true ]",
        "v[?'A'==@.id].v",
        "v[?@.a[0].b==-1.5e2].v",
        "v[?@==1]",
        "v[?id=='a']['v']",
        "v[?(@.a==1 && (@.b==null))]",
        "v[?id==']'].v",
    };
    char why[200];
    for (size_t i = 0; i < sizeof(good) / sizeof(*good); i++)
        if (!json_path_check(good[i], false, why))
            fail_msg("%s: %s", good[i], why);
    assert_true(json_path_check("@.t", true, why));
}

TEST(paths_to_several_values_are_refused)
{
    static const struct {
        const char *path, *why;
    } wrong[] = {
        { "a.", "after the dot" },
        { ".a.", "after the dot" },
        { "a..b", "descendants" },
        { "$..b", "descendants" },
        { "a[", "expected a path" },
        { "a[]", "expected a path" },
        { "a[x]", "expected a path" },
        { "a[1", "and ]" },
        { "[\"a]", "a string" },
        { "[\"\"]", "not empty" },
        { "a.[0]", "after the dot" },
        { "a[1234567]", "expected a path" },
        { "a[*]", "a wildcard selects" },
        { "a.*", "a wildcard selects" },
        { "$.*.b", "a wildcard selects" },
        { "a[0:2]", "a slice selects" },
        { "a[:2]", "a slice selects" },
        { "a[::2]", "a slice selects" },
        { "a[0,1]", "several selectors" },
        { "a['b','c']", "several selectors" },
        { "a[-0]", "expected a path" },
        { "a[?id!='x']", "needs ==" },
        { "a[?@.v<3]", "needs ==" },
        { "a[?@.id]", "needs ==" },
        { "a[?@.a==1 || @.b==2]", "||" },
        { "a[?!@.a==1]", "must look like @.member" },
        { "a[?length(@.a)==1]", "has a function" },
        { "a[?@.a==@.b]", "a string, a number" },
        { "a[?$.a==1]", "must look like @.member" },
        { "a[?@.a[?@.b==1]==1]", "filter inside" },
        { "a[?@.*==1]", "expected" },
        { "a[?@..b==1]", "descendants" },
        { "a[?id=='x]", "a string" },
        { "a[?id=='x'", "and ]" },
        { "a[?(id=='x']", "expected )" },
        { "a[?a==1&&b==1&&c==1&&d==1&&e==1]", "more than 4 comparisons" },
        { "@.t", "not from the current value" },
        { "a[0]b", "expected . or [" },
        { "['\\x']", "a string" },
        { "['\\ud800']", "a string" },
    };
    char why[200];
    for (size_t i = 0; i < sizeof(wrong) / sizeof(*wrong); i++) {
        if (json_path_check(wrong[i].path, false, why))
            fail_msg("%s is accepted", wrong[i].path);
        if (!strstr(why, wrong[i].why))
            fail_msg("%s: %s", wrong[i].path, why);
    }
}

struct expected {
    const char *json, *path;
    enum mqtt_found found;
    double value;
    uint32_t quality;
    int64_t utc_ns;
};

static void check(const struct plant_mqtt *mqtt, const struct expected *expected)
{
    char why[200] = "";
    struct stamped_value value;
    json_t *root = mqtt_json_parse(expected->json, strlen(expected->json), why);
    assert_non_null(root);
    const char *path = *expected->path ? expected->path : mqtt->value ? mqtt->value : "";
    enum mqtt_found found = mqtt_json_read(root, &(struct mqtt_reader){ mqtt, path, "T1" }, &value, why);
    if (found != expected->found)
        fail_msg("%s of %s: %d, wanted %d", expected->path, expected->json, found, expected->found);
    if (found == MQTT_WRONG && expected->quality)
        assert_string_equal(quality_name(value.quality), quality_name(expected->quality));
    if (expected->found == MQTT_FOUND) {
        assert_true(value.quality == expected->quality);
        assert_true(value.utc_ns == expected->utc_ns);
        assert_true(quality_is_bad(value.quality) || value.value == expected->value);
    }
    assert_true(expected->found != MQTT_WRONG || *why);
    json_decref(root);
}

TEST(values_are_found_by_path)
{
    static const struct plant_mqtt plain = { .payload = MQTT_JSON }, named = { .payload = MQTT_JSON, .value = "d[1]" };
    static const struct expected plainly[] = {
        { "21.5", "", MQTT_FOUND, 21.5, 0, 0 },
        { "{\"value\": 3}", "", MQTT_FOUND, 3, 0, 0 },
        { "{\"a\": {\"b\": [0, true]}}", "a.b[1]", MQTT_FOUND, 1, 0, 0 },
        { "{\"a.b\": \"7\"}", "[\"a.b\"]", MQTT_FOUND, 7, 0, 0 },
        { "{\"a\": null}", "a", MQTT_FOUND, 0, QUALITY_BAD_SENSOR_FAILURE, 0 },
        { "{\"a\": 1}", "b", MQTT_ABSENT, 0, 0, 0 },
        { "{\"a\": 1}", "a.b", MQTT_ABSENT, 0, 0, 0 },
        { "[1]", "[1]", MQTT_ABSENT, 0, 0, 0 },
        { "{\"a\": \"NaN\"}", "a", MQTT_WRONG, 0, 0, 0 },
        { "{\"a\": {}}", "a", MQTT_WRONG, 0, 0, 0 },
        { "[1]", "", MQTT_WRONG, 0, 0, 0 },
        { "123456789012345678901234567890", "", MQTT_FOUND, 123456789012345678901234567890.0, 0, 0 },
    };
    for (size_t i = 0; i < sizeof(plainly) / sizeof(*plainly); i++)
        check(&plain, &plainly[i]);
    check(&named, &(struct expected){ "{\"d\": [1, 2]}", "", MQTT_FOUND, 2, 0, 0 });
    check(&named, &(struct expected){ "{\"d\": [1, 2]}", "d[0]", MQTT_FOUND, 1, 0, 0 });
}

/* A path must select exactly one value, and one that does not belong to another tag; otherwise none is taken. The tag is T1. */
TEST(a_value_of_another_member_is_never_taken)
{
    static const char T2[] = "{\"values\": [{\"id\": \"A.T2\", \"v\": 22}]}";
    static const char BOTH[] = "{\"values\": [{\"id\": \"A.T1\", \"v\": 21}, {\"id\": \"A.T2\", \"v\": 22}]}";
    static const char TWICE[] = "{\"values\": [{\"id\": \"A.T1\", \"v\": 21}, {\"id\": \"A.T1\", \"v\": 22}]}";
    static const char NUMBERED[] = "[{\"id\": 1, \"v\": 5, \"ok\": true}, {\"id\": \"1\", \"v\": 6, \"ok\": false}]";
    static const char NESTED[] =
        "{\"d\": [{\"m\": {\"n\": \"a\", \"k\": 1}, \"v\": [7, 8]}, {\"m\": {\"n\": \"a\", \"k\": 2}, \"v\": [9]}]}";
    static const char MEMBERS[] = "{\"x\": {\"p\": {\"u\": \"bar\", \"v\": 3}, \"q\": {\"u\": \"K\", \"v\": \"4\"}}}";
    static const struct plant_mqtt plain = { .payload = MQTT_JSON };
    static const struct expected cases[] = {
        { T2, "values[0].v", MQTT_WRONG, 0, QUALITY_BAD_NO_MATCH, 0 },
        { T2, "values[-1].v", MQTT_WRONG, 0, QUALITY_BAD_NO_MATCH, 0 },
        { T2, "values[1].v", MQTT_ABSENT, 0, 0, 0 },
        { T2, "values[?@.id=='A.T1'].v", MQTT_ABSENT, 0, 0, 0 },
        { T2, "values[?id=='A.T2'].v", MQTT_FOUND, 22, 0, 0 },
        { T2, "$.values[?(@.id==\"A.T2\")]['v']", MQTT_FOUND, 22, 0, 0 },
        { T2, "values[?id=='A.T'].v", MQTT_ABSENT, 0, 0, 0 },
        { T2, "values[?id=='A.T2'].w", MQTT_ABSENT, 0, 0, 0 },
        { T2, "values[?id=='A.T2']", MQTT_WRONG, 0, QUALITY_BAD_CONFIGURATION, 0 },
        /* values[0] selects by position, but its id "A.T1" ends in the tag's name, so the value is accepted */
        { BOTH, "values[0].v", MQTT_FOUND, 21, 0, 0 },
        { BOTH, "values[1].v", MQTT_WRONG, 0, QUALITY_BAD_NO_MATCH, 0 },
        { BOTH, "values[?@.id=='A.T1'].v", MQTT_FOUND, 21, 0, 0 },
        { BOTH, "values[?@.id=='A.T1' && @.v==22].v", MQTT_ABSENT, 0, 0, 0 },
        { TWICE, "values[?id=='A.T1'].v", MQTT_WRONG, 0, QUALITY_BAD_TOO_MANY_MATCHES, 0 },
        { TWICE, "values[?id=='A.T1' && v==22].v", MQTT_FOUND, 22, 0, 0 },
        { NUMBERED, "[?id==1].v", MQTT_FOUND, 5, 0, 0 },
        { NUMBERED, "[?id=='1'].v", MQTT_FOUND, 6, 0, 0 },
        { NUMBERED, "[?ok==false].v", MQTT_FOUND, 6, 0, 0 },
        { NUMBERED, "[?ok=='false'].v", MQTT_ABSENT, 0, 0, 0 },
        { NUMBERED, "[0].v", MQTT_WRONG, 0, QUALITY_BAD_NO_MATCH, 0 },
        { NESTED, "d[?@.m.n=='a'].v[0]", MQTT_WRONG, 0, QUALITY_BAD_TOO_MANY_MATCHES, 0 },
        { NESTED, "d[?@.m.n=='a' && @.m['k']==1].v[-1]", MQTT_FOUND, 8, 0, 0 },
        { NESTED, "d[?@.m.k==2].v[1]", MQTT_ABSENT, 0, 0, 0 },
        { NESTED, "d[?@.v[0]==9].v[0]", MQTT_FOUND, 9, 0, 0 },
        { NESTED, "d[?@.m=='a'].v[0]", MQTT_ABSENT, 0, 0, 0 },
        { MEMBERS, "x[?@.u=='K'].v", MQTT_FOUND, 4, 0, 0 },
        { "{\"a\": [5]}", "a[0]", MQTT_FOUND, 5, 0, 0 },
        { "{\"a\": [5]}", "a", MQTT_WRONG, 0, QUALITY_BAD_CONFIGURATION, 0 },
        { "{\"a\": [5]}", "a[-2]", MQTT_ABSENT, 0, 0, 0 },
        { "{\"a\": [5, 6]}", "a[?@==6]", MQTT_FOUND, 6, 0, 0 },
        /* [0] selects by position, and the item has no other member that could name another tag */
        { "[{\"n\": 21.5}]", "[0].n", MQTT_FOUND, 21.5, 0, 0 },
        { "[{\"n\": 21.5, \"id\": \"A.T9\"}]", "[0].n", MQTT_WRONG, 0, QUALITY_BAD_NO_MATCH, 0 },
        { "[{\"n\": 21.5, \"v\": 3}]", "[0].v", MQTT_WRONG, 0, QUALITY_BAD_NO_MATCH, 0 },
        { "{\"a\": {\"0\": 5}}", "a[0]", MQTT_ABSENT, 0, 0, 0 },
        { "{\"a\": {\"0\": 5}}", "a['0']", MQTT_FOUND, 5, 0, 0 },
        { "{\"a\": [{\"id\": \"T1\", \"v\": null}]}", "a[?id=='T1'].v", MQTT_FOUND, 0, QUALITY_BAD_SENSOR_FAILURE, 0 },
        /* this item has no member that names it, so selecting it by position is accepted */
        { "{\"a\": [{\"v\": 3, \"unit\": \"K\"}]}", "a[0].v", MQTT_FOUND, 3, 0, 0 },
        { "{\"\u00b0'C\": 2}", "['\\u00b0\\'C']", MQTT_FOUND, 2, 0, 0 },
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++)
        check(&plain, &cases[i]);
}

TEST(time_and_quality_are_those_beside_the_value)
{
    static const char ALL[] = "{\"t\": 5, \"values\": [{\"id\": \"A.T2\", \"v\": 22, \"q\": true, \"t\": 1795341600500},"
                              "{\"id\": \"A.T1\", \"v\": 21, \"q\": false, \"t\": 1795341600600}]}";
    static const int64_t T_NS = 1795341600500000000;
    static const struct plant_mqtt beside = { .payload = MQTT_JSON, .time = "@.t" }, judged = { .payload = MQTT_JSON, .quality = "@.q" },
                                   first = { .payload = MQTT_JSON, .time = "values[0].t" },
                                   many = { .payload = MQTT_JSON, .quality = "values[?@.v==22 && @.q==true].q" };
    check(&beside, &(struct expected){ ALL, "values[?id=='A.T2'].v", MQTT_FOUND, 22, 0, T_NS });
    check(&beside, &(struct expected){ ALL, "values[?id=='A.T1'].v", MQTT_FOUND, 21, 0, T_NS + 100000000 });
    check(&beside, &(struct expected){ "7", "$", MQTT_WRONG, 0, QUALITY_BAD_CONFIGURATION, 0 });
    check(&judged, &(struct expected){ ALL, "values[?id=='A.T1'].v", MQTT_FOUND, 0, QUALITY_BAD, 0 });
    check(&judged, &(struct expected){ ALL, "values[?id=='A.T2'].v", MQTT_FOUND, 22, 0, 0 });
    check(&first, &(struct expected){ ALL, "values[?id=='A.T1'].v", MQTT_WRONG, 0, QUALITY_BAD_CONFIGURATION, 0 });
    check(&many, &(struct expected){ ALL, "values[?id=='A.T1'].v", MQTT_FOUND, 21, 0, 0 });
}

TEST(times_and_qualities_are_as_stated)
{
    static const struct plant_mqtt timed = { .payload = MQTT_JSON, .time = "t" }, judged = { .payload = MQTT_JSON, .quality = "q" };
    static const int64_t T_NS = 1795341600500000000;
    static const struct expected at[] = {
        { "{\"value\": 1, \"t\": 1795341600.5}", "", MQTT_FOUND, 1, 0, T_NS },
        { "{\"value\": 1, \"t\": 1795341600500}", "", MQTT_FOUND, 1, 0, T_NS },
        { "{\"value\": 1, \"t\": \"1795341600500000\"}", "", MQTT_FOUND, 1, 0, T_NS },
        { "{\"value\": 1, \"t\": \"2026-11-22T10:00:00.5Z\"}", "", MQTT_FOUND, 1, 0, T_NS },
        { "{\"value\": 1, \"t\": \"2026-11-22T11:00:00.5+01:00\"}", "", MQTT_FOUND, 1, 0, T_NS },
        { "{\"value\": 1, \"t\": 5}", "", MQTT_WRONG, 0, 0, 0 },
        { "{\"value\": 1, \"t\": 1e30}", "", MQTT_WRONG, 0, 0, 0 },
        { "{\"value\": 1, \"t\": true}", "", MQTT_WRONG, 0, 0, 0 },
        { "{\"value\": 1, \"t\": \"now\"}", "", MQTT_WRONG, 0, 0, 0 },
        { "{\"value\": 1}", "", MQTT_WRONG, 0, 0, 0 },
    };
    static const struct expected how[] = {
        { "{\"value\": 1, \"q\": 0}", "", MQTT_FOUND, 1, 0, 0 },
        { "{\"value\": 1, \"q\": \"Good\"}", "", MQTT_FOUND, 1, 0, 0 },
        { "{\"value\": 1, \"q\": true}", "", MQTT_FOUND, 1, 0, 0 },
        { "{\"value\": 1, \"q\": \"True\"}", "", MQTT_FOUND, 1, 0, 0 },
        { "{\"value\": 1, \"q\": \"false\"}", "", MQTT_FOUND, 0, QUALITY_BAD, 0 },
        { "{\"value\": 1, \"q\": \"0\"}", "", MQTT_FOUND, 1, 0, 0 },
        { "{\"value\": 1, \"q\": 1083179008}", "", MQTT_FOUND, 1, QUALITY_UNCERTAIN_LAST_USABLE, 0 },
        { "{\"value\": null, \"q\": 2156199936}", "", MQTT_FOUND, 0, 0x80850000, 0 },
        { "{\"value\": 1, \"q\": \"BAD, no signal\"}", "", MQTT_FOUND, 0, QUALITY_BAD, 0 },
        { "{\"value\": 1, \"q\": \"perhaps\"}", "", MQTT_FOUND, 1, QUALITY_UNCERTAIN, 0 },
        { "{\"value\": 1, \"q\": 192}", "", MQTT_FOUND, 1, QUALITY_UNCERTAIN, 0 },
        { "{\"value\": 1}", "", MQTT_FOUND, 1, QUALITY_UNCERTAIN, 0 },
    };
    for (size_t i = 0; i < sizeof(at) / sizeof(*at); i++)
        check(&timed, &at[i]);
    for (size_t i = 0; i < sizeof(how) / sizeof(*how); i++)
        check(&judged, &how[i]);
}

TEST(what_is_no_json_is_refused)
{
    static const char *const wrong[] = { "", "{", "{\"a\": 1e999}", "nan", "{\"a\": 1} x", "\xff\xfe", "{\"v\": 1, \"v\": 2}" };
    char why[200] = "", deep[100000];
    for (size_t i = 0; i < sizeof(wrong) / sizeof(*wrong); i++)
        assert_null(mqtt_json_parse(wrong[i], strlen(wrong[i]), why));
    memset(deep, '[', sizeof(deep));
    assert_null(mqtt_json_parse(deep, sizeof(deep), why));
    assert_non_null(strstr(why, "not valid JSON"));
}
