/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Payloads of MQTT messages: which texts are numbers, paths in JSON, stated times and qualities. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <cmocka.h>

#include "plant/json_path.h"
#include "value/mqtt/mqtt_payload.h"
#include "value/quality.h"

static void only_one_number_is_a_number(void **state)
{
    (void)state;
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

static void paths_are_as_written(void **state)
{
    (void)state;
    static const char *const good[] = { "a", "$", "$.a", "$[0]", "a.b[12].c", "[0][1]", "[\"odd. name\"].x", "$[\"a\"][3]",
                                        "a b" };
    static const char *const wrong[] = { "a.", ".a.", "a..b", "a[", "a[]", "a[x]", "a[-1]", "a[1", "[\"a]", "[\"\"]", "a.[0]",
                                         "a[1234567]" };
    char why[200];
    for (size_t i = 0; i < sizeof(good) / sizeof(*good); i++)
        assert_true(json_path_check(good[i], why));
    for (size_t i = 0; i < sizeof(wrong) / sizeof(*wrong); i++)
        assert_false(json_path_check(wrong[i], why));
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
    assert_int_equal(mqtt_json_read(root, mqtt, expected->path, &value, why), expected->found);
    if (expected->found == MQTT_FOUND) {
        assert_true(value.quality == expected->quality);
        assert_true(value.utc_ns == expected->utc_ns);
        assert_true(quality_is_bad(value.quality) || value.value == expected->value);
    }
    assert_true(expected->found != MQTT_WRONG || *why);
    json_decref(root);
}

static void values_are_found_by_path(void **state)
{
    (void)state;
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

static void times_and_qualities_are_as_stated(void **state)
{
    (void)state;
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

static void what_is_no_json_is_refused(void **state)
{
    (void)state;
    static const char *const wrong[] = { "", "{", "{\"a\": 1e999}", "nan", "{\"a\": 1} x", "\xff\xfe" };
    char why[200] = "", deep[100000];
    for (size_t i = 0; i < sizeof(wrong) / sizeof(*wrong); i++)
        assert_null(mqtt_json_parse(wrong[i], strlen(wrong[i]), why));
    memset(deep, '[', sizeof(deep));
    assert_null(mqtt_json_parse(deep, sizeof(deep), why));
    assert_non_null(strstr(why, "no JSON"));
}

int main(void)
{
    cmocka_set_message_output(CM_OUTPUT_TAP);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(only_one_number_is_a_number), cmocka_unit_test(paths_are_as_written),
        cmocka_unit_test(values_are_found_by_path),    cmocka_unit_test(times_and_qualities_are_as_stated),
        cmocka_unit_test(what_is_no_json_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
