/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Comparison of two plants: which items were added, removed or changed, and which of these changes give the plant another
   configuration id. */
#include "tests/support/test.h"

#include "base/text/text.h"
#include "plant/plant_diff.h"
#include "tests/support/plant_case.h"

#define CASE(name) TEST_ON(struct plant_case *c, name, plant_case_set_up, plant_case_tear_down)

#define YAML(groups, more) \
    "plant: { name: P }\nassets:\n  - { id: E-101, model: m.glb }\ngroups:\n" groups \
    "sources:\n  - { id: plc, type: modbus, host: h, byte_order: CDAB, address_base: 1 }\ntags: tags.csv\n" more
#define TEMP "  - { id: temp, unit: bar, min: 0, max: 100 }\n"
#define TAGS "Tag Name,Address,Eng Units,H\n"

static void release_plant(void *resource)
{
    struct plant *plant = resource;
    plant_destroy(&plant);
}

/* Loads a plant from the text of a plant file and of a tag list. The plant is freed automatically after the test. */
static struct plant *load(struct plant_case *c, const char *yaml, const char *tags)
{
    plant_case_load(c, yaml, tags);
    plant_case_assert_loaded(c, 0);
    struct plant *plant = c->plant;
    c->plant = NULL;
    owned_add(release_plant, plant);
    return plant;
}

static void assert_diff(struct plant_case *c, struct plant *before, struct plant *after, const char *const *wanted, size_t count)
{
    struct plant_diff diff = { 0 };
    (void)c;
    plant_diff(before, after, &diff);
    assert_int_equal(diff.count, count);
    for (size_t i = 0; i < count; i++)
        assert_string_equal(diff.lines[i], wanted[i]);
    plant_diff_finish(&diff);
}

CASE(each_difference_is_said)
{
    struct plant *before = load(c, YAML(TEMP, ""), TAGS "A,40001,bar,90\nB,40002,bar,\nC,40005,bar,\nD,40006,bar,80\nGONE,40003,bar,\n");
    struct plant *after = load(c, YAML("  - { id: temp, unit: bar, min: 0, max: 120 }\n  - { id: flow, unit: m, min: 0, max: 1 }\n",
                                       "alarms: local\n"),
                               TAGS "NEW,40009,bar,\nB,40004,bar,\nA,40001,bar,95\nC,40005,bar,70\nD,40006,bar,\n");
    static const char *const wanted[] = { "the key `alarms` of the plant file (display, mirror or local) has changed",
                                          "group temp changed",
                                          "group flow added",
                                          "tag GONE removed",
                                          "tag NEW added",
                                          "tag B changed: address",
                                          "tag A: H 90 > 95",
                                          "tag C: H none > 70",
                                          "tag D: H 80 > none" };
    assert_diff(c, before, after, wanted, 9);
    assert_string_not_equal(before->files.hash, after->files.hash);
    assert_null(plant_needs_restart(before, after));
    assert_diff(c, before, before, NULL, 0);
}

CASE(another_start_of_an_asset_is_said)
{
    struct plant *before = load(c, YAML(TEMP, ""), TAGS "A,40001,bar,90\n");
    struct plant *after = load(c,
                               "plant: { name: P }\nassets:\n  - { id: E-101, model: m.glb, start: ghost }\ngroups:\n" TEMP
                               "sources:\n  - { id: plc, type: modbus, host: h, byte_order: CDAB, address_base: 1 }\ntags: tags.csv\n",
                               TAGS "A,40001,bar,90\n");
    assert_diff(c, before, after, (const char *const[]){ "asset E-101 changed" }, 1);
}

/* A key of the source may change what the addresses of its tags mean. A sentinel is part of the scaling. */
CASE(a_changed_meaning_of_addresses_is_said)
{
    static const char tags[] = "Tag Name,Address,Eng Units,Open Circuit\nA,40001,bar,%s\nB,hr:7,bar,\n";
    char *none = test_printf(tags, ""), *one = test_printf(tags, "32767");
    struct plant *before = load(c, YAML(TEMP, ""), none), *sentinel = load(c, YAML(TEMP, ""), one);
    struct plant *base = load(c,
                              "plant: { name: P }\nassets:\n  - { id: E-101, model: m.glb }\ngroups:\n" TEMP
                              "sources:\n  - { id: plc, type: modbus, host: h, byte_order: CDAB, address_base: 0 }\ntags: tags.csv\n",
                              none);
    assert_diff(c, before, base, (const char *const[]){ "tag A changed: address" }, 1);
    assert_diff(c, before, sentinel, (const char *const[]){ "tag A changed: scaling" }, 1);
}

/* The key `value` of an MQTT source is the path of the tags whose address states none. */
CASE(a_changed_path_of_the_source_is_said)
{
    static const char yaml[] = "plant: { name: P }\nassets:\n  - { id: E-101, model: m.glb }\ngroups:\n" TEMP
                               "sources:\n  - { id: mq, type: mqtt, host: h, payload: json, value: %s }\ntags: tags.csv\n";
    static const char tags[] = "Tag Name,Address,Eng Units\nA,a/b,bar\nB,a/b#other,bar\n";
    char *first = test_printf(yaml, "now"), *second = test_printf(yaml, "later");
    struct plant *before = load(c, first, tags), *after = load(c, second, tags);
    assert_diff(c, before, after, (const char *const[]){ "tag A changed: address" }, 1);
    bool kept[2];
    plant_kept_signals(before, after, kept);
    assert_false(kept[0]);
    assert_true(kept[1]);
}

CASE(the_same_files_have_the_same_hash)
{
    struct plant *one = load(c, YAML(TEMP, ""), TAGS "A,40001,bar,90\n"), *two = load(c, YAML(TEMP, ""), TAGS "A,40001,bar,90\n");
    struct plant *moved = load(c, YAML(TEMP, "\n"), TAGS "A,40001,bar,90\n");
    assert_string_equal(one->files.hash, two->files.hash);
    assert_int_equal(strlen(one->files.hash), 16);
    assert_string_not_equal(one->files.hash, moved->files.hash);
}

CASE(what_a_daemon_cannot_change_is_named)
{
    struct plant *one = load(c, YAML(TEMP, ""), TAGS "A,40001,bar,90\n");
    struct plant *elsewhere = load(c, YAML(TEMP, "history: { folder: there }\n"), TAGS "A,40001,bar,90\n");
    struct plant *off = load(c, YAML(TEMP, "history: { record: no }\n"), TAGS "A,40001,bar,90\n");
    assert_non_null(plant_needs_restart(one, elsewhere));
    assert_non_null(plant_needs_restart(one, off));
}

CASE(many_differences_end_in_their_number)
{
    struct text *tags = test_text();
    text_add(tags, TAGS);
    for (int i = 0; i < 500; i++)
        text_add(tags, "T-%d,%d,bar,\n", i, 40001 + i);
    struct plant *before = load(c, YAML(TEMP, ""), TAGS "T-0,40001,bar,\n"), *after = load(c, YAML(TEMP, ""), tags->at);
    struct plant_diff diff = { 0 };
    plant_diff(before, after, &diff);
    assert_int_equal(diff.count, PLANT_DIFF_LINES);
    assert_string_equal(diff.lines[PLANT_DIFF_LINES - 1], "and 300 more");
    plant_diff_finish(&diff);
}
