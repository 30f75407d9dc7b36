/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The report of plantcast-prep on models with known numbers. */
#include "tests/support/test.h"

#include "preprocess/pipeline/progress.h"
#include "preprocess/report/text_table.h"
#include "tests/support/boxes.h"
#include "tests/support/prep_case.h"

static const char plant_text[] = "plant: { name: Boxes }\n"
                                 "assets:\n"
                                 "  - { id: GAP, model: model.glb, nodes: 'gap-*', up: z }\n"
                                 "  - { id: APART, model: model.glb, nodes: 'apart-*', up: z }\n"
                                 "  - { id: INSIDE, model: model.glb, nodes: 'inside-*', up: z }\n"
                                 "  - { id: BARE, model: model.glb, nodes: 'bare', up: z }\n"
                                 "groups:\n"
                                 "  - { id: temperature, unit: K, min: 0, max: 1 }\n"
                                 "sources:\n"
                                 "  - { id: plc, type: modbus, host: 127.0.0.1, byte_order: CDAB, address_base: 1 }\n"
                                 "tags: tags.csv\n";
static const char tags_rows[] = "T-GAP,400001,Float,plc,temperature,GAP,,0.5,0.5,1\n"
                                "T-APART,400003,Float,plc,temperature,APART,,10.5,0.5,1.5\n"
                                "T-INSIDE,400005,Float,plc,temperature,INSIDE,,22,2,4.02\n";

/* Prepares models for four assets. GAP: two boxes of 1 m, 0.2 mm apart; APART: two boxes 0.5 m apart, one with a duplicate
   face, a degenerate face, lines and points; INSIDE: a small box in a large one; and one box without a sensor. */
static int set_up(void **state)
{
    static const float twice[3][3] = { { 10, 0, 0 }, { 10, 1, 0 }, { 11, 0, 0 } },
                       flat[3][3] = { { 10, 0, 0 }, { 11, 0, 0 }, { 10.5f, 0, 0 } };
    prep_case_set_up(state);
    struct prep_case *c = *state;
    struct model_maker maker;
    maker_init(&maker);
    boxes_add(&maker, "gap-1", (const double[3]){ 0, 0, 0 }, (const double[3]){ 1, 1, 1 });
    boxes_add(&maker, "gap-2", (const double[3]){ 1.0002, 0, 0 }, (const double[3]){ 2, 1, 1 });
    int mesh = boxes_add(&maker, "apart-1", (const double[3]){ 10, 0, 0 }, (const double[3]){ 11, 1, 1 });
    boxes_add_primitive(&maker, mesh, 4, twice, 3);
    boxes_add_primitive(&maker, mesh, 4, flat, 3);
    boxes_add_primitive(&maker, mesh, 1, flat, 2);
    boxes_add_primitive(&maker, mesh, 0, flat, 3);
    boxes_add_primitive(&maker, mesh, 1, flat, 2);
    boxes_add(&maker, "apart-2", (const double[3]){ 11.5, 0, 0 }, (const double[3]){ 12, 1, 1 });
    boxes_add(&maker, "inside-1", (const double[3]){ 20, 0, 0 }, (const double[3]){ 24, 4, 4 });
    boxes_add(&maker, "inside-2", (const double[3]){ 21, 1, 1 }, (const double[3]){ 22, 2, 2 });
    boxes_add(&maker, "bare", (const double[3]){ 30, 0, 0 }, (const double[3]){ 31, 1, 1 });
    maker_write(&maker, c->folder, "model.glb");
    prep_case_plant(c, plant_text);
    prep_case_tags(c, tags_rows);
    return 0;
}

TEST_ON(struct prep_case *c, numbers_are_those_of_the_model, set_up, prep_case_tear_down)
{
    static const struct {
        const char *path;
        double least, most;
    } expected[] = {
        { "assets.0.model_triangles", 24, 24 },
        { "assets.0.nodes", 2, 2 },
        { "assets.0.surface.triangles", 24, 24 },
        { "assets.0.surface.welded_vertices", 16, 16 },
        { "assets.0.surface.components_before", 2, 2 },
        { "assets.0.surface.components_after", 1, 1 },
        { "assets.0.surface.bridges", 4, 10000 },
        { "assets.0.surface.longest_bridge_m", 0.00019, 0.00021 },
        { "assets.0.surface.tolerance_m", 0.0012, 0.0013 },
        { "assets.0.surface.open_edges_before", 0, 0 },
        { "assets.0.surface.samples", 5000, 100000 },
        { "assets.0.surface.hidden_vertices", 0, 0 },
        { "assets.0.surface.unreachable_vertices", 0, 0 },
        /* k, the number of neighbours per point with which gaps are searched, is 0: the boxes have no open edges, so nothing is
           searched or joined */
        { "assets.0.surface.k", 0, 0 },
        { "assets.0.skipped_lines", 0, 0 },
        { "assets.0.sensors.0.surface_distance_m", 0, 1e-6 },
        { "assets.1.model_triangles", 25, 25 },
        { "assets.1.zero_area_triangles", 1, 1 },
        { "assets.1.skipped_lines", 2, 2 },
        { "assets.1.skipped_points", 1, 1 },
        { "assets.1.surface.repeated_triangles", 1, 1 },
        { "assets.1.surface.components_before", 2, 2 },
        { "assets.1.surface.components_after", 2, 2 },
        { "assets.1.surface.bridges", 0, 0 },
        { "assets.1.surface.longest_bridge_m", 0, 0 },
        /* the 24 vertices of the second box (three at each corner) cannot be reached from the sensor on the first */
        { "assets.1.surface.unreachable_vertices", 24, 24 },
        { "assets.1.sensors.0.surface_distance_m", 0.5 - 1e-6, 0.5 + 1e-6 },
        { "assets.1.sensors.0.limit_m", 0.122, 0.123 }, /* 5 % of the diagonal, hypot(2, 1, 1) m */
        { "assets.2.surface.components_before", 2, 2 },
        { "assets.2.surface.hidden_vertices", 24, 24 },
        { "assets.2.sensors.0.surface_distance_m", 0.02 - 1e-6, 0.02 + 1e-6 },
        { "assets.3.triangles", 12, 12 },
        { "assets.3.vertices", 24, 24 },
        { "assets.3.vertices_added", 0, 0 },
        { "models.0.skipped_lines", 2, 2 },
        { "models.0.skipped_points", 1, 1 },
    };
    prep_case_expect(c, "$PLANT --report json", 0);
    json_t *report = prep_case_json(&c->out);
    for (size_t i = 0; i < sizeof(expected) / sizeof(expected[0]); i++) {
        double found = prep_case_number(report, expected[i].path);
        if (!(found >= expected[i].least && found <= expected[i].most))
            fail_msg("%s is %.9g, expected %g to %g", expected[i].path, found, expected[i].least, expected[i].most);
    }
    for (int asset = 0; asset < 4; asset++) { /* for each asset, the totals of the asset file agree with those of its finest level */
        char path[60];
        snprintf(path, sizeof(path), "assets.%d.levels.0.triangles", asset);
        double split = prep_case_number(report, path);
        snprintf(path, sizeof(path), "assets.%d.triangles", asset);
        assert_int_equal((int)split, (int)prep_case_number(report, path));
        snprintf(path, sizeof(path), "assets.%d.levels.0.triangles_before", asset);
        assert_true(prep_case_number(report, path) <= split);
        snprintf(path, sizeof(path), "assets.%d.vertices_added", asset);
        double added = prep_case_number(report, path);
        assert_true(asset == 3 ? added == 0 : added >= 1);
    }
    assert_true(json_is_null(json_object_get(json_array_get(json_object_get(report, "assets"), 3), "surface")));
}

TEST_ON(struct prep_case *c, what_is_wrong_comes_first, set_up, prep_case_tear_down)
{
    prep_case_expect(c, "$PLANT --report json", 0);
    json_t *report = prep_case_json(&c->out);
    const json_t *look_at = json_object_get(report, "look_at");
    assert_true(json_array_size(look_at) >= 2);
    assert_string_equal(json_string_value(json_object_get(json_array_get(look_at, 0), "asset")), "APART");
    assert_non_null(strstr(json_string_value(json_object_get(json_array_get(look_at, 0), "text")),
                           "sensor T-APART is 0.500 m from the surface of the asset"));
    assert_non_null(strstr(json_string_value(json_object_get(json_array_get(look_at, 1), "text")), "no sensor reaches 24 of the asset's"));
    prep_case_expect(c, "$PLANT --report text", 0);
    const char *apart = strstr(c->out.at, "!  APART"), *gap = strstr(c->out.at, "   GAP");
    assert_true(apart && gap && apart < gap);
    prep_case_says(&c->out, "2 > 1");
    prep_case_says(&c->out, "! APART: sensor T-APART is 0.500 m from the surface of the asset (limit: 0.122 m)");
    prep_case_says(&c->out, "Boxes: 4 assets, ");
}

/* The report on an asset that needed no work repeats what its last build reported, except for the time taken. */
TEST_WITH(an_unchanged_asset_keeps_its_report, set_up, prep_case_tear_down)
{
    struct prep_case *c = *state;
    prep_case_expect(c, "$PLANT --report json", 0);
    json_t *first = prep_case_json(&c->out);
    prep_case_expect(c, "$PLANT --report json", 0);
    json_t *second = prep_case_json(&c->out);
    for (size_t i = 0; i < 4; i++) {
        static const char *const same[] = { "levels", "surface", "stage_seconds", "sensors", "vertices_added", "triangles" };
        const json_t *a = json_array_get(json_object_get(first, "assets"), i), *b = json_array_get(json_object_get(second, "assets"), i);
        assert_string_equal(json_string_value(json_object_get(b, "state")), "unchanged");
        for (size_t k = 0; k < sizeof(same) / sizeof(same[0]); k++) {
            char *p = json_dumps(json_object_get(a, same[k]), JSON_ENCODE_ANY),
                 *q = json_dumps(json_object_get(b, same[k]), JSON_ENCODE_ANY);
            if (p && q && strcmp(p, q) != 0)
                fail_msg("asset %zu: %s: %s, then %s", i, same[k], p, q);
            assert_true(!p == !q);
            free(p);
            free(q);
        }
    }
    prep_case_expect(c, "$PLANT", 0);
    assert_null(strstr(c->out.at, "Surfaces")); /* no asset was built */
    prep_case_says(&c->out, "4 unchanged");
    prep_case_tags(c, "T-GAP,400001,Float,plc,temperature,GAP,,0.5,0.5,1\n");
    /* now only the asset GAP has a sensor: asset files that are not used any more are deleted, and their reports, too */
    prep_case_expect(c, "$PLANT", 0);
    char *command = test_printf("test $(ls '%s/plant.prepared' | grep -c report.json) = $(ls '%s/plant.prepared' | grep -c 'asset$')",
                               c->folder, c->folder);
    assert_int_equal(system(command), 0);
}

/* With a tolerance of 0.501 m in the plant file, the two boxes of APART, half a metre from each other, must be joined; only
   this asset may be built again. */
TEST_WITH(the_plant_file_sets_the_tolerance, set_up, prep_case_tear_down)
{
    struct prep_case *c = *state;
    prep_case_expect(c, "$PLANT", 0);
    const char *after = strstr(plant_text, "nodes: 'apart-*', up: z") + strlen("nodes: 'apart-*', up: z");
    char *text = test_printf("%.*s, tolerance_m: 0.501%s", (int)(after - plant_text), plant_text, after);
    prep_case_plant(c, text);
    prep_case_expect(c, "$PLANT --report json", 0);
    json_t *report = prep_case_json(&c->out);
    assert_string_equal(json_string_value(json_object_get(json_array_get(json_object_get(report, "assets"), 0), "state")), "unchanged");
    assert_float_equal(prep_case_number(report, "assets.1.surface.tolerance_m"), 0.501, 1e-12);
    assert_int_equal((int)prep_case_number(report, "assets.1.surface.components_before"), 2);
    assert_int_equal((int)prep_case_number(report, "assets.1.surface.components_after"), 1);
    assert_int_equal((int)prep_case_number(report, "assets.1.surface.unreachable_vertices"), 0);
    assert_float_equal(prep_case_number(report, "assets.1.surface.longest_bridge_m"), 0.5, 1e-6);
}

TEST(tables_fit_what_is_in_them)
{
    static const struct text_table_column columns[] = { { "name", false }, { "empty", false }, { "number", true } };
    struct text_table table = { .columns = columns, .column_count = 3 };
    char text[400] = { 0 };
    FILE *out = fmemopen(text, sizeof(text), "w");
    for (int row = 0; row < 3; row++) {
        text_table_add(&table, "%s", row == 0 ? "K\xc3\xbchler" : "P");
        text_table_add(&table, "%s", "");
        text_table_add(&table, "%s", text_table_number(row == 0 ? 1234567 : 12).text);
    }
    text_table_print(&table, 2, out);
    fclose(out);
    assert_string_equal(text, "name       number\nK\xc3\xbchler  1,234,567\nP              12\n"
                              "... and 1 more rows: --report text lists all rows\n");
    text_table_finish(&table);
    assert_string_equal(text_table_number(0).text, "0");
    assert_string_equal(text_table_number(100).text, "100");
    assert_string_equal(text_table_number(1000).text, "1,000");
}

TEST(the_time_left_follows_the_work)
{
    struct progress progress;
    const int64_t s = 1000000000;
    char text[1000] = { 0 };
    FILE *out = fmemopen(text, sizeof(text), "w");
    progress_begin(&progress, out, 10, 4, 0);
    assert_true(progress_left_s(&progress, s) < 0);
    for (int i = 0; i < 3; i++)
        /* announces the work of three of the six assets: 400, 100 and 100. The others are expected to need as much, so 1,200 in
           all. */
        progress_expect(&progress, i == 0 ? 400 : 100);
    progress_step(&progress, 400, 4 * s);
    assert_float_equal(progress_left_s(&progress, 4 * s), 8, 1e-9);
    progress_step(&progress, 100, 5 * s);
    assert_float_equal(progress_left_s(&progress, 5 * s), 7, 1e-9);
    progress_step(&progress, 100, 6 * s);
    for (int i = 0; i < 3; i++)
        progress_expect(&progress, 1); /* the other three assets announce little work, so the estimated remaining time becomes short */
    assert_float_equal(progress_left_s(&progress, 6 * s), 0.03, 1e-9);
    progress_end(&progress);
    fclose(out);
    assert_string_equal(text, "preparing 6 of 10 assets; all other assets are up to date\n"
                              "6 of 10 assets prepared, 0.4 a second, about 7 s left\n");
}

/* A finding shortens a node's name to 80 bytes, which may end inside a character. JSON does not allow half a character. */
TEST_ON(struct prep_case *c, a_finding_with_a_long_korean_name_is_reported, prep_case_set_up, prep_case_tear_down)
{
    struct model_maker maker;
    char name[31 * 3 + 1] = "";
    for (int i = 0; i < 31; i++)
        memcpy(name + strlen(name), "배", 4);
    maker_init(&maker);
    boxes_add(&maker, "near", (const double[3]){ 0, 0, 0 }, (const double[3]){ 1, 1, 1 });
    boxes_add(&maker, name, (const double[3]){ 5000, 0, 0 }, (const double[3]){ 5001, 1, 1 });
    maker_write(&maker, c->folder, "model.glb");
    prep_case_plant(c, "plant: { name: Boxes }\n"
                       "assets:\n"
                       "  - { id: ALL, model: model.glb, up: z }\n"
                       "groups:\n"
                       "  - { id: temperature, unit: K, min: 0, max: 1 }\n"
                       "sources:\n"
                       "  - { id: plc, type: modbus, host: 127.0.0.1, byte_order: CDAB, address_base: 1 }\n"
                       "tags: tags.csv\n");
    prep_case_tags(c, "");
    prep_case_expect(c, "$PLANT --report json", 0);
    prep_case_says(&c->out, "12 triangles of the asset lie up to ");
    prep_case_says(&c->out, test_printf("(node '%.78s')", name));
}
