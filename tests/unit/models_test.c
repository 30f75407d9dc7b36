/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The preparation report on real models (shared/data/models), compared with known facts about them and checked for consistency. */
#include "tests/support/test.h"
#include <unistd.h>

#include "tests/support/prep_case.h"

/* Facts known about real models. triangles: number stated with the model; without_area: number of triangles without an area,
   -1: not stated; pieces: number of separate surfaces that preparation must leave, 0: several, because the model itself has
   gaps. */
static const struct known_model {
    const char *plant, *asset;
    int triangles, without_area, pieces;
} known[] = {
    { "industrial_tanker", "TANKER", 3720, 0, 1 }, { "offshore_platform_overview", "PLATFORM", 13708, 0, 0 },
    { "plm_plant_5parts", "ART", 50177, -1, 1 },   { "plm_plant_5parts", "DUCT", 1502, -1, 1 },
    { "plm_plant_5parts", "TRAYS", 9160, -1, 1 },  { "plm_plant_5parts", "STEEL", 632, -1, 0 },
    { "plm_plant_5parts", "WALLS", 2408, -1, 0 },  { "plm_plant_hierarchy", "V-1105", 7495, -1, 0 },
    { "huldra_wd1_psup", "DECK", 52830, 4, 0 },    { "duplex_mep", "BACKFLOW", 18400, -1, 0 },
    { "duplex_mep", "SERVICES", 335822, 172, 0 },  { "../cookie_line", "M-200", 22083, 0, 0 },
    { "../cookie_line", "W-301", 1275, 0, 0 },
};

static double of(const json_t *asset, const char *path)
{
    return prep_case_number(asset, path);
}

static void check_levels(const json_t *asset)
{
    const json_t *levels = json_object_get(asset, "levels");
    assert_true(json_array_size(levels) >= 1);
    assert_true(of(asset, "levels.0.error_m") == 0);
    assert_true(of(asset, "levels.0.triangles") == of(asset, "triangles"));
    for (size_t l = 1; l < json_array_size(levels); l++) {
        const json_t *level = json_array_get(levels, l), *finer = json_array_get(levels, l - 1);
        assert_true(of(level, "triangles_before") < of(finer, "triangles_before"));
        assert_true(of(level, "error_m") >= of(finer, "error_m"));
        assert_true(of(level, "vertices") <= of(finer, "vertices"));
    }
}

static void check_surface(const json_t *asset)
{
    const json_t *surface = json_object_get(asset, "surface");
    assert_true(of(surface, "triangles") == of(asset, "model_triangles"));
    assert_true(of(surface, "open_edges_after") <= of(surface, "open_edges_before"));
    assert_true(of(surface, "longest_bridge_m") <= of(surface, "tolerance_m") * (1 + 1e-9));
    assert_true(of(surface, "k") >= 0 && of(surface, "k") <= 256);
    assert_true(of(surface, "samples") > 0);
    assert_true(of(surface, "hidden_vertices") < of(asset, "model_vertices"));
    assert_true(of(surface, "unreachable_vertices") < of(asset, "model_vertices"));
    assert_true(of(surface, "heat_disagreement") >= 0 && of(surface, "heat_disagreement") < 0.2);
    assert_true((of(surface, "bridges") == 0) == (of(surface, "longest_bridge_m") == 0) || of(surface, "bridges") > 0);
}

static void check_asset(const json_t *asset, const char *plant)
{
    const json_t *sensors = json_object_get(asset, "sensors");
    bool surface = !json_is_null(json_object_get(asset, "surface"));
    const char *state = json_string_value(json_object_get(asset, "state"));
    /* allowed distance of a sensor from the surface: in this plant, sensors in thermowells of pumps are up to 12 mm above it */
    double off_m = strcmp(plant, "../plant_room") ? 0.01 : 0.02;
    assert_true(!strcmp(state, "built") || !strcmp(state, "shared"));
    assert_true(surface == (json_array_size(sensors) > 0));
    assert_true(of(asset, "vertices") == of(asset, "model_vertices") + of(asset, "vertices_added"));
    check_levels(asset);
    if (surface)
        check_surface(asset);
    /* the sensors were placed on vertices of the models; a vertex that is hidden inside a body has no place on the surface, so
       a small distance must remain */
    for (size_t s = 0; s < json_array_size(sensors); s++)
        assert_true(of(json_array_get(sensors, s), "surface_distance_m") < off_m);
    print_message("# %-26s %-9s %6.0f triangles, split %6.0f; ", plant, json_string_value(json_object_get(asset, "id")),
                  of(asset, "model_triangles"), of(asset, "triangles"));
    if (surface)
        print_message("pieces %4.0f > %3.0f, %6.0f bridges up to %6.2f of %6.2f mm, %5.0f hidden, %5.0f unreached, methods differ %.2f %%",
                      of(asset, "surface.components_before"), of(asset, "surface.components_after"), of(asset, "surface.bridges"),
                      1e3 * of(asset, "surface.longest_bridge_m"), 1e3 * of(asset, "surface.tolerance_m"),
                      of(asset, "surface.hidden_vertices"), of(asset, "surface.unreachable_vertices"),
                      100 * of(asset, "surface.heat_disagreement"));
    print_message("\n");
}

static void check_known(const json_t *report, const char *plant)
{
    for (size_t k = 0; k < sizeof(known) / sizeof(known[0]); k++)
        for (size_t i = 0; i < json_array_size(json_object_get(report, "assets")); i++) {
            const json_t *asset = json_array_get(json_object_get(report, "assets"), i);
            if (strcmp(known[k].plant, plant) || strcmp(known[k].asset, json_string_value(json_object_get(asset, "id"))))
                continue;
            assert_int_equal((int)(of(asset, "model_triangles") + of(asset, "zero_area_triangles")), known[k].triangles);
            if (known[k].pieces)
                assert_int_equal((int)of(asset, "surface.components_after"), known[k].pieces);
            if (known[k].without_area >= 0)
                assert_int_equal((int)of(asset, "zero_area_triangles"), known[k].without_area);
        }
}

static json_t *prepare(struct prep_case *c, const char *plant)
{
    if (access("../shared/data/models", R_OK) != 0) {
        print_message("# ../shared/data/models is not there\n");
        skip();
    }
    char *arguments = test_printf("tests/plants/models/%s.yaml --output $FOLDER/prepared --report json", plant);
    prep_case_expect(c, arguments, 0);
    json_t *report = prep_case_json(&c->out);
    for (size_t i = 0; i < json_array_size(json_object_get(report, "assets")); i++)
        check_asset(json_array_get(json_object_get(report, "assets"), i), plant);
    check_known(report, plant);
    return report;
}

static void tanker(void **state)
{
    json_t *report = prepare(*state, "industrial_tanker");
    assert_int_equal((int)prep_case_number(report, "assets.0.surface.components_after"), 1); /* shell, saddles, manways, bolts */
}

static void platform(void **state)
{
    prepare(*state, "offshore_platform_overview");
}

static void plant_in_five_parts(void **state)
{
    json_t *report = prepare(*state, "plm_plant_5parts");
    assert_int_equal((int)prep_case_number(report, "models.0.skipped_lines"), 1);
    /* this asset's flanges are thinner than the tolerance for joining; its surface must be one connected piece all the same */
    assert_int_equal((int)prep_case_number(report, "assets.1.surface.components_after"), 1);
}

static void plant_with_its_tree(void **state)
{
    json_t *report = prepare(*state, "plm_plant_hierarchy");
    /* V-1105 has distances that jump at walls, and thin triangles attached to the middle of others. Subdividing triangles there
       would not make the field more exact, so few may be subdivided. */
    assert_true(prep_case_number(report, "assets.0.levels.0.limited_by_triangles") < 10);
    assert_true(prep_case_number(report, "assets.0.levels.0.triangles") < 40000);
}

static void weather_deck(void **state)
{
    json_t *report = prepare(*state, "huldra_wd1_psup");
    assert_true(prep_case_number(report, "assets.3.surface.components_after") > 50); /* supports stand apart */
}

/* The largest model: each face of its elbows and tees occurs twice, and these copies must be found. */
static void building_services(void **state)
{
    json_t *report = prepare(*state, "duplex_mep");
    double repeated = prep_case_number(report, "assets.4.surface.repeated_triangles");
    assert_true(repeated > 113000 && repeated <= 113821);
}

static void equipment(void **state)
{
    double triangles = 0;
    json_t *report = prepare(*state, "../plant_room");
    for (size_t i = 0; i < json_array_size(json_object_get(report, "assets")); i++) {
        const json_t *asset = json_array_get(json_object_get(report, "assets"), i);
        triangles += of(asset, "model_triangles") + of(asset, "zero_area_triangles");
    }
    assert_true(triangles == 79103); /* the assets together have all triangles of the model */
    assert_true(prep_case_number(report, "assets.4.repeated_triangles") == 192);
}

/* The six mixers share one asset file. */
static void mixers_and_water_tank(void **state)
{
    json_t *report = prepare(*state, "../cookie_line");
    assert_int_equal(json_array_size(json_object_get(report, "assets")), 7);
    assert_string_equal(json_string_value(json_object_get(json_array_get(json_object_get(report, "assets"), 5), "state")), "shared");
}

static int tear_down(void **state)
{
    return test_end(prep_case_tear_down, state);
}

#define WITH_FOLDER(test) cmocka_unit_test_setup_teardown(test, prep_case_set_up, tear_down)

int main(void)
{
    cmocka_set_message_output(CM_OUTPUT_TAP);
    const struct CMUnitTest tests[] = {
        WITH_FOLDER(tanker),
        WITH_FOLDER(platform),
    };
    const struct CMUnitTest dearest[] = {
        WITH_FOLDER(plant_in_five_parts),
        WITH_FOLDER(mixers_and_water_tank),
        WITH_FOLDER(plant_with_its_tree),
        WITH_FOLDER(equipment),
        WITH_FOLDER(weather_deck),
        WITH_FOLDER(building_services),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    return failed + (sweep_is_whole() ? cmocka_run_group_tests(dearest, NULL, NULL) : 0);
}
