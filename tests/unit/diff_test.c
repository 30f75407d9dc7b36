/* SPDX-License-Identifier: GPL-3.0-or-later */
/* plantcast-prep --diff: it reports what a new revision of the model changes, and which tags lose their position. */
#include "tests/support/test.h"
#include <unistd.h>

#include "tests/support/boxes.h"
#include "tests/support/cad.h"
#include "tests/support/prep_case.h"

static const char plant_format[] = "plant: { name: Boxes }\n"
                                   "assets:\n"
                                   "%s"
                                   "groups:\n"
                                   "  - { id: temperature, unit: K, min: 0, max: 1 }\n"
                                   "sources:\n"
                                   "  - { id: plc, type: modbus, host: 127.0.0.1, byte_order: CDAB, address_base: 1 }\n"
                                   "tags: %s\n";
static const char tags_head[] = "Tag Name,Address,Data Type,Source,Group,Asset,Node,X,Y,Z\n";

static void write_plant(struct prep_case *c, const char *name, const char *assets, const char *tags)
{
    char *yaml = test_printf("%s.yaml", name), *csv = test_printf("%s.csv", name), *list = test_printf("%s%s", tags_head, tags);
    char *text = test_printf(plant_format, assets, csv);
    temp_write_text(c->folder, yaml, text);
    temp_write_text(c->folder, csv, list);
}

#define ASSET(id, model, more) "  - { id: " id ", model: " model ", nodes: " id ", up: z" more " }\n"
#define OLD_ASSETS                                                                                                                         \
    ASSET("SAME", "old.glb", "")                                                                                                           \
    ASSET("MOVED", "old.glb", "")                                                                                                          \
    ASSET("PLACED", "old.glb", "")                                                                                                         \
    ASSET("TURNED", "old.glb", "") ASSET("CHANGED", "old.glb", "") ASSET("GONE", "old.glb", "") ASSET("DROPPED", "old.glb", "")
#define NEW_ASSETS                                                                                                                         \
    ASSET("SAME", "new.glb", "")                                                                                                           \
    ASSET("MOVED", "new.glb", "")                                                                                                          \
    ASSET("PLACED", "new.glb", ", placement: { translate: [0, 0, 0.5], rotate_deg: [0, 0, 0] }")                                           \
    ASSET("TURNED", "new.glb", "") ASSET("CHANGED", "new.glb", "") ASSET("GONE", "new.glb", "") ASSET("ADDED", "new.glb", "")
static const char tags_rows[] = "T-SAME,400001,Float,plc,temperature,SAME,,0.5,0.5,1\n"
                                "T-MOVED,400003,Float,plc,temperature,MOVED,,10.5,0.5,1\n"
                                "T-CARRIED,400005,Float,plc,temperature,MOVED,TT-1,,,\n"
                                "T-CHANGED,400007,Float,plc,temperature,CHANGED,,40.5,0.5,1\n"
                                "T-MIDDLE,400017,Float,plc,temperature,SAME,,0.5,0.5,0.5\n"
                                "T-BELOW,400009,Float,plc,temperature,CHANGED,,40.5,0.5,0\n";
static const char lost_rows[] = "T-GONE,400011,Float,plc,temperature,GONE,,50.5,0.5,1\n"
                                "T-DROPPED,400013,Float,plc,temperature,DROPPED,,60.5,0.5,1\n"
                                "T-NODE,400015,Float,plc,temperature,SAME,TT-2,,,\n";

/* Writes the old or the new model. In the old one, boxes of 1 x 1 x 1 m stand at x = 0, 10, 20 and so on. In the new one, MOVED
   is 2 m farther along y, TURNED (1 x 2 x 3 m) lies on its side, CHANGED is 50 mm higher, GONE is renamed, and the node TT-2 is
   missing. renamed: new name of GONE; NULL: write the old model. */
static void write_model(struct prep_case *c, const char *renamed)
{
    struct model_maker maker;
    bool is_new = renamed;
    const double s = is_new ? 0.70710678118654752 : 0;
    maker_init(&maker);
    boxes_add(&maker, "SAME", (const double[3]){ 0, 0, 0 }, (const double[3]){ 1, 1, 1 });
    boxes_add(&maker, "MOVED", (const double[3]){ 10, is_new ? 2 : 0, 0 }, (const double[3]){ 11, is_new ? 3 : 1, 1 });
    boxes_add(&maker, "PLACED", (const double[3]){ 20, 0, 0 }, (const double[3]){ 21, 1, 1 });
    boxes_add(&maker, "TURNED", (const double[3]){ 30, 0, 0 }, (const double[3]){ 31, 2, 3 });
    json_object_set_new(maker_get(&maker, "nodes", 3), "rotation", json_pack("[ffff]", s, 0.0, 0.0, is_new ? s : 1));
    boxes_add(&maker, "CHANGED", (const double[3]){ 40, 0, 0 }, (const double[3]){ 41, 1, is_new ? 1.05 : 1 });
    boxes_add(&maker, is_new ? renamed : "GONE", (const double[3]){ 50, 0, 0 }, (const double[3]){ 51, 1, 1 });
    boxes_add(&maker, is_new ? "ADDED" : "DROPPED", (const double[3]){ 60, 0, 0 }, (const double[3]){ 61, 1, 1 });
    if (is_new) /* a box whose name resembles that of the missing GONE; the diff must not take it for GONE */
        boxes_add(&maker, "GONE1", (const double[3]){ 70, 0, 0 }, (const double[3]){ 71, 1, 1 });
    maker_node(&maker, "TT-1", -1, json_pack("{s:[fff]}", "translation", 11.0, is_new ? 2.5 : 0.5, 0.5));
    if (!is_new)
        maker_node(&maker, "TT-2", -1, json_pack("{s:[fff]}", "translation", 1.0, 0.5, 0.5));
    maker_write(&maker, c->folder, is_new ? "new.glb" : "old.glb");
}

static int set_up(void **state)
{
    prep_case_set_up(state);
    struct prep_case *c = *state;
    char *rows = test_printf("%s%s", tags_rows, lost_rows);
    write_model(c, NULL);
    write_model(c, "VESSEL");
    write_plant(c, "old", OLD_ASSETS, rows);
    write_plant(c, "new", NEW_ASSETS, rows);
    return 0;
}

#define CASE(name) TEST_ON(struct prep_case *c, name, set_up, prep_case_tear_down)

static const json_t *named(const json_t *root, const char *list, const char *key, const char *name)
{
    const json_t *items = json_object_get(root, list);
    for (size_t i = 0; i < json_array_size(items); i++)
        if (strcmp(json_string_value(json_object_get(json_array_get(items, i), key)), name) == 0)
            return json_array_get(items, i);
    return NULL;
}

static const json_t *asset_of(const json_t *root, const char *id, const char *change)
{
    const json_t *asset = named(root, "assets", "id", id);
    if (!asset || strcmp(json_string_value(json_object_get(asset, "change")), change) != 0)
        fail_msg("%s: %s, expected %s", id, asset ? json_string_value(json_object_get(asset, "change")) : "not there", change);
    return asset;
}

static void assert_orphan(const json_t *root, const char *tag, const char *why)
{
    const json_t *orphan = named(root, "orphans", "tag", tag);
    if (!orphan || !strstr(json_string_value(json_object_get(orphan, "why")), why))
        fail_msg("%s: %s, expected: %s", tag, orphan ? json_string_value(json_object_get(orphan, "why")) : "not orphaned", why);
}

static json_t *compare(struct prep_case *c, const char *arguments, int status)
{
    char *all = test_printf("--report json --diff %s", arguments);
    prep_case_expect(c, all, status);
    return prep_case_json(&c->out);
}

/* Checks what a diff reports about each asset. exact: the old revision is compared from its model; otherwise from a prepared
   folder, whose coordinates are less exact. */
static void check_assets(const json_t *root, bool exact)
{
    asset_of(root, "SAME", "same");
    const json_t *moved = asset_of(root, "MOVED", "moved"), *changed = asset_of(root, "CHANGED", "changed");
    assert_float_equal(prep_case_number(moved, "moved_m"), 2, 1e-5);
    assert_float_equal(prep_case_number(moved, "move_m.1"), 2, 1e-5);
    assert_float_equal(prep_case_number(moved, "turned_deg"), 0, 1e-4);
    assert_float_equal(prep_case_number(asset_of(root, "PLACED", "moved"), "move_m.2"), 0.5, 1e-5);
    if (exact)
        assert_float_equal(prep_case_number(asset_of(root, "TURNED", "moved"), "turned_deg"), 90, 1e-2);
    /* the height changed by 50 mm, so with both boxes centred on each other their surfaces are 25 mm apart */
    assert_float_equal(prep_case_number(changed, "apart_m"), 0.025, 1e-4);
    assert_non_null(strstr(json_string_value(json_object_get(asset_of(root, "GONE", "removed"), "why")),
                           "no node's name matches 'GONE': node 'VESSEL' has the same shape at the same place"));
    asset_of(root, "DROPPED", "removed");
    asset_of(root, "ADDED", "added");
}

static void check_tags(const json_t *root)
{
    const json_t *same = named(root, "sensors", "tag", "T-SAME"), *carried = named(root, "sensors", "tag", "T-CARRIED");
    const json_t *changed = named(root, "sensors", "tag", "T-CHANGED"), *below = named(root, "sensors", "tag", "T-BELOW");
    assert_float_equal(prep_case_number(same, "surface_moved_m"), 0, 1e-6);
    assert_true(json_is_false(json_object_get(same, "moved")));
    /* this sensor is in the middle of the box, so it is equally near to six faces and may be placed on any of them */
    assert_true(json_is_false(json_object_get(named(root, "sensors", "tag", "T-MIDDLE"), "moved")));
    /* the sensor has moved 2 m with its node and its asset, so it is still on the surface */
    assert_float_equal(prep_case_number(carried, "surface_moved_m"), 2, 1e-5);
    assert_float_equal(prep_case_number(carried, "surface_distance_new_m"), 0, 1e-5);
    assert_true(json_is_true(json_object_get(carried, "moved")));
    assert_float_equal(prep_case_number(changed, "surface_moved_m"), 0.05, 1e-5);
    assert_float_equal(prep_case_number(changed, "place_moved_m"), 0, 1e-5);
    assert_true(json_is_true(json_object_get(changed, "moved")));
    assert_true(json_is_false(json_object_get(below, "moved")));
    assert_orphan(root, "T-MOVED", "m from the surface");
    assert_orphan(root, "T-GONE", "asset GONE is missing: no node's name matches");
    assert_orphan(root, "T-DROPPED", "asset DROPPED is not in the plant file");
    assert_orphan(root, "T-NODE", "the model has no node 'TT-2'");
    assert_int_equal(json_array_size(json_object_get(root, "orphans")), 4);
}

CASE(a_revision_is_compared)
{
    json_t *root = compare(c, "$FOLDER/old.yaml $FOLDER/new.yaml", 1);
    check_assets(root, true);
    check_tags(root);
    prep_case_expect(c, "--diff $FOLDER/old.yaml $FOLDER/new.yaml", 1);
    prep_case_says(&c->out, "! T-NODE: position lost: the model has no node 'TT-2'");
    prep_case_says(&c->out, "1 assets added, 2 removed, 3 moved, 1 changed, 1 unchanged; "
                           "surface of 3 sensors moved; 4 tags lost their position");
}

/* Compares a prepared folder of the old revision with the new plant file. This is the usual case, because the user has
   overwritten the old model file. */
CASE(a_prepared_folder_stands_for_the_old_plant)
{
    prep_case_expect(c, "$FOLDER/old.yaml", 0);
    char *model = temp_path(c->folder, "old.glb");
    assert_int_equal(remove(model), 0);
    json_t *root = compare(c, "$FOLDER/old.prepared $FOLDER/new.yaml", 1);
    check_assets(root, false);
    check_tags(root);
}

CASE(texts_that_are_not_utf8_are_reported)
{
    /* the message shortens the name inside a character */
    char name[60 * 3 + 2] = "A";
    for (int i = 0; i < 60; i++)
        memcpy(name + strlen(name), "배", 4);
    write_model(c, name);
    json_t *root = compare(c, "$FOLDER/old.yaml $FOLDER/new.yaml", 1);
    assert_orphan(root, "T-GONE", test_printf("node 'A%.147s", name + 1));
    assert_non_null(strstr(json_string_value(json_object_get(asset_of(root, "GONE", "removed"), "why")), "has the same shape at the same"));
    assert_int_equal(symlink(c->folder, temp_path(c->folder, "caf\xe9")), 0);
    root = compare(c, "$FOLDER/caf\xe9/old.yaml $FOLDER/new.yaml", 1);
    assert_non_null(strstr(json_string_value(json_object_get(root, "old")), "/caf?/old.yaml"));
    prep_case_expect(c, "$FOLDER/caf\xe9/old.yaml --report json", 0);
    const json_t *models = json_object_get(prep_case_json(&c->out), "models");
    assert_int_equal(json_array_size(models), 1);
    assert_non_null(strstr(json_string_value(json_object_get(json_array_get(models, 0), "path")), "/caf?/old.glb"));
}

CASE(nothing_lost_is_no_error)
{
    write_plant(c, "new", NEW_ASSETS,
                "T-SAME,400001,Float,plc,temperature,SAME,,0.5,0.5,1\nT-X,400003,Float,plc,temperature,ADDED,,60,0,0\n");
    json_t *root = compare(c, "$FOLDER/old.yaml $FOLDER/new.yaml", 0);
    assert_int_equal(json_array_size(json_object_get(root, "orphans")), 0);
    assert_int_equal(json_array_size(json_object_get(root, "tags_added")), 1);
    assert_int_equal(json_array_size(json_object_get(root, "tags_removed")), 8);
    root = compare(c, "$FOLDER/old.yaml $FOLDER/old.yaml", 0);
    assert_int_equal((int)prep_case_number(root, "counts.same"), 7);
    prep_case_expect(c, "$FOLDER/old.yaml", 0);
    /* comparing a plant with its own prepared folder must report no difference, although preparation has subdivided triangles
       */
    root = compare(c, "$FOLDER/old.prepared $FOLDER/old.yaml", 0);
    assert_int_equal((int)prep_case_number(root, "counts.same"), 7);
}

#define ONE_ROW(asset) "T-SAME,400001,Float,plc,temperature," asset ",,0.5,0.5,1\n"

/* An import leaves a tag whose equipment is gone in the tag list, without an asset. */
CASE(a_tag_that_lost_its_asset_is_an_orphan)
{
    write_plant(c, "new", OLD_ASSETS, ONE_ROW(""));
    json_t *root = compare(c, "$FOLDER/old.yaml $FOLDER/new.yaml", 1);
    assert_orphan(root, "T-SAME", "the tag list no longer gives an asset for this tag (before: SAME)");
    assert_int_equal(json_array_size(json_object_get(root, "orphans")), 1);
}

CASE(a_tag_that_gets_its_first_asset_is_added)
{
    write_plant(c, "new", OLD_ASSETS, ONE_ROW(""));
    write_plant(c, "later", OLD_ASSETS, ONE_ROW("SAME"));
    const json_t *added = json_object_get(compare(c, "$FOLDER/new.yaml $FOLDER/later.yaml", 0), "tags_added");
    assert_int_equal(json_array_size(added), 1);
    assert_string_equal(json_string_value(json_array_get(added, 0)), "T-SAME");
}

CASE(a_tag_on_another_asset_is_shown)
{
    write_plant(c, "new", OLD_ASSETS, ONE_ROW("MOVED"));
    json_t *root = compare(c, "$FOLDER/old.yaml $FOLDER/new.yaml", 1);
    const json_t *sensor = named(root, "sensors", "tag", "T-SAME");
    assert_string_equal(json_string_value(json_object_get(sensor, "asset_old")), "SAME");
    assert_float_equal(prep_case_number(sensor, "surface_moved_m"), 9.5, 1e-5);
    assert_orphan(root, "T-SAME", "before, the sensor was on the surface");
    prep_case_expect(c, "--diff $FOLDER/old.yaml $FOLDER/new.yaml", 1);
    prep_case_says(&c->out, "T-SAME: now on asset MOVED, before on SAME");
}

static void truncate_first(const char *folder)
{
    char *manifest_path = test_printf("%s/manifest.json", folder);
    json_t *manifest = test_json(json_load_file(manifest_path, 0, NULL));
    assert_non_null(manifest);
    const json_t *first = json_array_get(json_object_get(manifest, "assets"), 0);
    assert_string_equal(json_string_value(json_object_get(first, "id")), "SAME");
    assert_int_equal(truncate(temp_path(folder, json_string_value(json_object_get(first, "file"))), 100), 0);
}

CASE(an_unreadable_prepared_file_is_an_error_not_a_new_asset)
{
    prep_case_expect(c, "$FOLDER/old.yaml", 0);
    truncate_first(temp_path(c->folder, "old.prepared"));
    json_t *root = compare(c, "$FOLDER/old.prepared $FOLDER/old.yaml", 1);
    assert_non_null(strstr(json_string_value(json_object_get(asset_of(root, "SAME", "unknown"), "why")), "prepared file "));
    assert_int_equal((int)prep_case_number(root, "counts.added"), 0);
    assert_int_equal((int)prep_case_number(root, "counts.unknown"), 1);
    assert_true(json_is_null(json_object_get(named(root, "sensors", "tag", "T-SAME"), "surface_moved_m")));
    prep_case_says(&c->err, "old.prepared: error: asset SAME: prepared file ");
    temp_write_text(c->folder, "broken.glb", "no model");
    /* SAME has a sensor; PLACED has none, so its new file is read only to compare shapes */
    write_plant(c, "new", ASSET("SAME", "broken.glb", "") ASSET("PLACED", "broken.glb", ""), ONE_ROW("SAME"));
    root = compare(c, "$FOLDER/old.yaml $FOLDER/new.yaml", 1);
    asset_of(root, "SAME", "unknown");
    asset_of(root, "PLACED", "unknown");
    assert_int_equal((int)prep_case_number(root, "counts.removed"), 5);
    assert_int_equal(json_array_size(json_object_get(root, "orphans")), 0);
    prep_case_says(&c->err, "new.yaml: error: asset PLACED: ");
    prep_case_expect(c, "--diff $FOLDER/old.yaml $FOLDER/new.yaml", 1);
    prep_case_says(&c->out, "0 unchanged, 2 unknown; ");
}

/* All tags of an asset with an unreadable file move to another asset. */
CASE(tags_whose_old_place_is_unknown_are_shown)
{
    prep_case_expect(c, "$FOLDER/old.yaml", 0);
    truncate_first(temp_path(c->folder, "old.prepared"));
    write_plant(c, "new", ASSET("MOVED", "old.glb", ""),
                "T-SAME,400001,Float,plc,temperature,MOVED,,10.5,0.5,1\nT-MIDDLE,400003,Float,plc,temperature,MOVED,,10.5,0.5,1\n");
    json_t *root = compare(c, "$FOLDER/old.prepared $FOLDER/new.yaml", 1);
    const json_t *sensor = named(root, "sensors", "tag", "T-SAME");
    assert_string_equal(json_string_value(json_object_get(sensor, "asset_old")), "SAME");
    assert_true(json_is_null(json_object_get(sensor, "surface_moved_m")));
    assert_float_equal(prep_case_number(sensor, "surface_distance_new_m"), 0, 1e-5);
    assert_non_null(named(root, "sensors", "tag", "T-MIDDLE"));
    const char *error = strstr(c->err.at, "error: asset SAME");
    assert_true(error && !strstr(error + 1, "error: asset SAME"));
}

/* Coarser levels of detail have vertices that lie off the original surface. These must not be reported as a change. */
CASE(levels_are_no_change)
{
    struct cad_random chance = { 1 };
    struct cad *ball = test_cad();
    cad_sphere(ball, &chance, 20);
    maker_write_cad(c->folder, "ball.glb", "BALL", ball);
    write_plant(c, "ball", ASSET("BALL", "ball.glb", ""), "T-1,400001,Float,plc,temperature,BALL,,1,0,0\n");
    prep_case_expect(c, "$FOLDER/ball.yaml --report json", 0);
    json_t *report = prep_case_json(&c->out);
    const json_t *levels = json_object_get(json_array_get(json_object_get(report, "assets"), 0), "levels");
    assert_true(prep_case_number(json_array_get(levels, json_array_size(levels) - 1), "error_m") > 0.02); /* the tolerance is 0.01 */
    json_t *root = compare(c, "$FOLDER/ball.prepared $FOLDER/ball.yaml", 0);
    asset_of(root, "BALL", "same");
}

CASE(the_tolerance_decides)
{
    json_t *root = compare(c, "$FOLDER/old.yaml $FOLDER/new.yaml --tolerance 0.06", 1);
    asset_of(root, "CHANGED", "same");
    assert_true(json_is_false(json_object_get(named(root, "sensors", "tag", "T-CHANGED"), "moved")));
    asset_of(root, "PLACED", "moved");
}

CASE(wrong_use_and_wrong_input_are_told_apart)
{
    prep_case_expect(c, "--diff $FOLDER/old.yaml", 2);
    prep_case_expect(c, "--diff $FOLDER/old.yaml $FOLDER/new.yaml more", 2);
    prep_case_expect(c, "--diff $FOLDER/old.yaml $FOLDER/new.yaml --tolerance -1", 2);
    prep_case_expect(c, "$FOLDER/old.yaml --tolerance 1", 2);
    prep_case_expect(c, "--diff $FOLDER/none.yaml $FOLDER/new.yaml", 1);
    prep_case_expect(c, "--diff $FOLDER $FOLDER/new.yaml", 1);
    prep_case_says(&c->err, "manifest.json: error: cannot be read");
}
