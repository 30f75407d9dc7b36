/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Scenes from real plant and asset files: everything is in its place, and files of another plant are refused with the reason. */
#include "scene/scene_create.h"

#include "tests/support/test.h"
#include <inttypes.h>
#include <unistd.h>
#include <xxhash.h>

#include "base/text/text.h"
#include "plant/recipe.h"
#include "plant/sensors.h"
#include "tests/support/no_textures.h"

static const char plant_text[] =
    "plant: { name: Test%s }\n"
    "assets:\n"
    "- { id: A, model: m.glb }\n"
    "- { id: B, model: m.glb, placement: { translate: [10, 20, 30], rotate_deg: [0, 0, 90] } }\n"
    "- { id: C, model: m.glb, sensor_frame: asset, placement: { translate: [-5, 0, 0], rotate_deg: [90, 0, 0] } }\n"
    "groups: [{ id: t, unit: K, min: 0, max: 1 }]\n"
    "tags: tags.csv\n";

/* b1 is given in the plant frame: B's placement maps a point (x, y, z) of the asset to (10 - y, 20 + x, 30 + z), so it is the
   same point of the asset as a1. */
static const char tags_text[] = "Tag Name,Group,Asset,Node,X,Y,Z\n"
                                "a1,t,A,,1,2,3\n"
                                "b1,t,B,,8,21,33\n"
                                "c1,t,C,,1,2,3\n"
                                "a2,t,A,TI-2,,,\n"
                                "b2,t,B,TI-2,,,\n"
                                "c2,t,C,TI-2,,,\n"
                                "x,t,,,,,\n";

struct scene_fixture {
    char *folder, *prepared;
    struct plant *plant;
    struct log *log;
};

/* Writes an asset file with a triangle and two sensors: one at (sensor_x_m, 2, 3), one at `node`, which is at (4, 2, 0). The
   asset file's origin is (1, 1, 1). */
static void write_asset(const struct scene_fixture *f, const char *name, double sensor_x_m, const char *node, uint32_t sensor_count)
{
    const float positions[3][3] = { { -1, 0, 0 }, { 3, 0, 0 }, { 0, 1, 2 } }, normals[3][3] = { { 0, 0, 1 }, { 0, 0, 1 }, { 0, 0, 1 } };
    const uint32_t indices[3] = { 0, 1, 2 };
    const struct asset_primitive primitive = { .index_count = 3 };
    const struct asset_material plain = { NO_TEXTURES };
    const struct asset_sensor sensors[2] = {
        { .position_m = { (float)(sensor_x_m - 1), 1, 2 }, .surface_m = { 0, 1, 1.5f }, .surface_distance_m = 0.5f },
        { .position_m = { 3, 1, -1 }, .surface_m = { 3, 0, 0 }, .node_hash = XXH3_64bits(node, strlen(node)) },
    };
    const float geodesic[6] = { 0, 1, 2, 3, 4, 5 };
    const struct asset_parts parts = {
        .key = 7,
        .origin_m = { 1, 1, 1 },
        .positions_m = positions,
        .normals = normals,
        .indices = indices,
        .primitives = &primitive,
        .materials = &plain,
        .sensors = sensors,
        .geodesic_m = geodesic,
        .vertex_count = 3,
        .index_count = 3,
        .primitive_count = 1,
        .material_count = 1,
        .sensor_count = sensor_count,
    };
    size_t bytes;
    void *file = asset_build(&parts, &bytes);
    assert_non_null(file);
    temp_write(f->prepared, name, file, bytes);
    free(file);
}

static void write_manifest(const struct scene_fixture *f, const char *text)
{
    temp_write_text(f->prepared, "manifest.json", text);
}

/* Writes a manifest that lists all assets in reverse order, all with the same file. more: further members of each asset. */
static void write_manifest_with(const struct scene_fixture *f, const char *more)
{
    struct text *text = test_text();
    uint64_t model;
    assert_true(plant_model_hash(f->plant->assets[0].model, &model));
    text_add(text, "{\"format\": 2, \"assets\": [");
    for (size_t i = f->plant->asset_count; i-- > 0;)
        text_add(text, "{\"id\": \"%s\", \"file\": \"1.asset\", \"recipe\": \"%016" PRIx64 "\"%s}%s", f->plant->assets[i].id,
                 plant_recipe(&f->plant->assets[i], model), more, i > 0 ? "," : "]}");
    write_manifest(f, text->at);
}

static void write_good_manifest(const struct scene_fixture *f)
{
    write_manifest_with(f, "");
}

static struct plant *load(const struct scene_fixture *f, const char *more)
{
    struct diag diag = { 0 };
    char *path = temp_write_text(f->folder, "plant.yaml", test_printf(plant_text, more));
    temp_write_text(f->folder, "tags.csv", tags_text);
    temp_write_text(f->folder, "m.glb", "glTF");
    struct plant *plant = plant_load(path, &diag);
    if (!plant)
        diag_print(&diag, stderr);
    diag_finish(&diag);
    assert_non_null(plant);
    return plant;
}

static void begin(struct scene_fixture *f)
{
    f->folder = temp_folder();
    f->plant = load(f, "");
    f->prepared = plant_prepared_folder(f->plant);
    f->log = test_log();
    write_asset(f, "1.asset", 1, "TI-2", 2);
    write_good_manifest(f);
}

static void end(struct scene_fixture *f)
{
    plant_destroy(&f->plant);
    mem_free(f->prepared);
}

TEST_FIXTURE(struct scene_fixture, begin, end)

#define CASE(name) TEST_ON(struct scene_fixture *f, name, set_up, tear_down)

static void assert_point(const double point[3], double x, double y, double z)
{
    const double expected[3] = { x, y, z };
    for (int i = 0; i < 3; i++)
        if (!(fabs(point[i] - expected[i]) < 1e-5))
            fail_msg("(%g, %g, %g) is not (%g, %g, %g)", point[0], point[1], point[2], x, y, z);
}

CASE(everything_is_in_its_place)
{
    struct scene *scene = scene_create(f->log, f->plant, f->prepared);
    assert_non_null(scene);
    assert_int_equal(scene->asset_count, 3);
    const struct scene_asset *a = &scene->assets[0], *b = &scene->assets[1], *c = &scene->assets[2];
    assert_ptr_equal(a->file, b->file);
    assert_ptr_equal(a->file, c->file);
    assert_int_equal(a->file->refs, 3);
    assert_int_equal(b->sensor_count, 2);
    assert_int_equal(b->sensors[0].tag, 1);
    assert_int_equal(b->sensors[1].tag, 4);
    assert_int_equal(b->sensors[1].column, 1);
    assert_point(a->sensors[0].position_m, 1, 2, 3);
    assert_point(a->sensors[1].position_m, 4, 2, 0);
    assert_point(b->sensors[0].position_m, 8, 21, 33);
    assert_point(b->sensors[1].position_m, 8, 24, 30);
    assert_point(b->sensors[0].surface_m, 8, 21, 32.5);
    assert_float_equal(b->sensors[0].surface_distance_m, 0.5, 1e-6);
    assert_point(c->sensors[0].position_m, -4, -3, 2); /* the asset's placement in the plant file maps the model's y to z, and z to -y */
    assert_point(a->bounds_min_m, 0, 1, 1);
    assert_point(a->bounds_max_m, 4, 2, 3);
    assert_point(b->bounds_min_m, 8, 20, 31);
    assert_point(b->bounds_max_m, 9, 24, 33);
    assert_point(scene->bounds_min_m, -5, -3, 1);
    assert_point(scene->bounds_max_m, 9, 24, 33);
    scene_destroy(&scene);
    assert_null(scene);
}

/* Asserts that scene_create() fails, and that the log then contains `words` and `hint`, the advice what to do. The log goes to
   stderr, which is redirected to a file meanwhile. */
static void assert_refused_from(struct scene_fixture *f, const char *prepared, const char *words, const char *hint)
{
    char *path = temp_path(f->folder, "log.txt");
    size_t bytes;
    fflush(stderr);
    int kept = dup(STDERR_FILENO);
    assert_non_null(freopen(path, "w", stderr));
    struct log *log = test_log(); /* a new log, because a log suppresses messages that it has printed before */
    struct scene *scene = scene_create(log, f->plant, prepared);
    fflush(stderr);
    dup2(kept, STDERR_FILENO);
    close(kept);
    char *text = test_memory(text_read_file(path, 1 << 20, &bytes));
    assert_non_null(text);
    assert_null(scene);
    if (!strstr(text, words) || !strstr(text, hint))
        fail_msg("expected '%s' and what to do in: %s", words, text);
}

static void assert_refused(struct scene_fixture *f, const char *words)
{
    assert_refused_from(f, f->prepared, words, "run plantcast-prep -o ");
}

CASE(a_service_prepares_by_itself)
{
    char *own = f->plant->files.path, *folder;
    f->plant->files.path = mem_strdup("/etc/plantcast/none-here/plant.yaml");
    folder = plant_service_folder(f->plant->files.path, "prepared");
    assert_refused_from(f, folder, "manifest.json: cannot be read", "the service prepares them when it starts");
    assert_refused_from(f, f->folder, "manifest.json: cannot be read", "run plantcast-prep -o ");
    mem_free(folder);
    mem_free(f->plant->files.path);
    f->plant->files.path = own;
}

CASE(other_sensors_are_refused)
{
    /* the sensor in the file is 0.05 mm from the tag list's position, half of the tolerance: accepted */
    write_asset(f, "1.asset", 1.00005, "TI-2", 2);
    struct scene *scene = scene_create(f->log, f->plant, f->prepared);
    assert_non_null(scene);
    scene_destroy(&scene);
    write_asset(f, "1.asset", 1.0003, "TI-2", 2);
    assert_refused(f, "asset A: the tag list has another position for sensor a1 than the prepared file");
    write_asset(f, "1.asset", 1, "TI-3", 2);
    assert_refused(f, "asset B: the tag list has another position for sensor b2 than the prepared file");
    write_asset(f, "1.asset", 1, "TI-2", 1);
    assert_refused(f, "1.asset has 1 sensors, but the tag list has 2");
}

CASE(broken_files_are_refused)
{
    char *path = temp_path(f->prepared, "1.asset");
    assert_int_equal(truncate(path, 1000), 0);
    assert_refused(f, "1.asset: damaged asset file from plantcast-prep: truncated");
    assert_int_equal(truncate(path, 0), 0);
    assert_refused(f, "1.asset: this prepared asset file cannot be read");
    temp_write_text(f->prepared, "1.asset", "glTF and so on");
    assert_refused(f, "1.asset: not an asset file");
    unlink(path);
    assert_refused(f, "asset C: the prepared file is missing, damaged or outdated");
}

CASE(broken_manifests_are_refused)
{
    static const char *const cases[][2] = {
        { "{\"format\": 2, \"assets\": [{\"id\": \"A\", \"file\": \"1.asset\", \"recipe\": \"1\"}]}", "asset B is not in" },
        { "{\"format\": 1, \"assets\": []}", "not in format 2, which this program requires" },
        { "{\"format\": 2}", "expected a list of assets" },
        { "{\"format\": 2, \"assets\": [{\"id\": \"A\", \"file\": \"../1.asset\"}]}", "asset number 0 has no id, file or recipe" },
        { "{\"format\": 2, \"assets\": [{\"file\": \"1.asset\"}]}", "asset number 0 has no id, file or recipe" },
        { "{\"format\": 2,\n \"assets\": [}", "manifest.json:2:" },
        { "[]", "not in format 2, which this program requires" },
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
        write_manifest(f, cases[i][0]);
        assert_refused(f, cases[i][1]);
    }
    char *path = temp_path(f->prepared, "manifest.json");
    unlink(path);
    assert_refused(f, "manifest.json: cannot be read");
}

/* If the plant file or the model has changed since plantcast-prep ran, the scene must be refused. */
CASE(what_was_not_prepared_is_refused)
{
    struct plant_asset *asset = &f->plant->assets[1];
    asset->up = asset->up == AXIS_Y ? AXIS_Z : AXIS_Y;
    assert_refused(f, "asset B: ");
    asset->up = asset->up == AXIS_Y ? AXIS_Z : AXIS_Y;
    asset->unit_m = 0.001;
    assert_refused(f, "'units', 'scale' or 'up', has changed since plantcast-prep ran");
    asset->unit_m = 1;
    asset->nodes = mem_strdup("E-*");
    assert_refused(f, "asset B: ");
    mem_free(asset->nodes);
    asset->nodes = NULL;
    struct scene *scene = scene_create(f->log, f->plant, f->prepared);
    assert_non_null(scene);
    scene_destroy(&scene);
    temp_write_text(f->folder, "m.glb", "glTG");
    assert_refused(f, "m.glb, or the asset's 'nodes'");
}

static uint64_t models_hash(const struct scene_fixture *f)
{
    struct scene *scene = scene_create(f->log, f->plant, f->prepared);
    assert_non_null(scene);
    uint64_t hash = scene->models_hash;
    scene_destroy(&scene);
    return hash;
}

/* Returns the hash of the parameters for which an asset's triangles are cut. */
static uint64_t cuts_of(const struct scene_fixture *f, int asset)
{
    struct plant_sensor *sensors;
    size_t count = plant_sensors(f->plant, asset, &sensors);
    uint64_t cuts = plant_cuts_recipe(f->plant, sensors, count);
    mem_free(sensors);
    return cuts;
}

/* After a reload with other parameters than those for which triangles were cut, no level counts as resolved. */
CASE(cuts_for_other_parameters_are_known)
{
    const uint64_t cuts = cuts_of(f, 0);
    assert_true(cuts == cuts_of(f, 1) && cuts == cuts_of(f, 2));
    write_manifest_with(f, test_printf(", \"cuts\": \"%016" PRIx64 "\", \"resolved_levels\": 1", cuts));
    for (int other = 0; other < 2; other++) {
        f->plant->groups[0].power = other ? 4 : 2;
        struct scene *scene = scene_create(f->log, f->plant, f->prepared);
        assert_non_null(scene);
        assert_int_equal(scene->assets[0].file->cuts_differ, other);
        assert_int_equal(scene->assets[0].file->resolved_levels, !other);
        scene_destroy(&scene);
    }
    f->plant->groups[0].power = 2;
    assert_true(cuts_of(f, 1) == cuts);
    /* two tags of one asset exchange their parameters */
    f->plant->tags[1].strength = 0.5;
    const uint64_t first = cuts_of(f, 1);
    f->plant->tags[1].strength = 1;
    f->plant->tags[4].strength = 0.5;
    assert_true(first != cuts && cuts_of(f, 1) != cuts && cuts_of(f, 1) != first);
}

/* The models' hash contains what the manifest says about buffers and textures. Without that it contains the model files alone, and a
   model without such files has the same hash either way. */
CASE(the_hash_of_the_models_covers_the_files_that_they_refer_to)
{
    uint64_t model, alone = models_hash(f);
    assert_true(plant_model_hash(f->plant->assets[0].model, &model));
    write_manifest_with(f, test_printf(", \"model\": \"%016" PRIx64 "\"", model));
    assert_true(models_hash(f) == alone);
    write_manifest_with(f, test_printf(", \"model\": \"%016" PRIx64 "\"", model + 1));
    assert_true(models_hash(f) != alone);
}

/* Writes a manifest in which one asset is missing. All assets of the plant have the same model. */
static void write_missing(const struct scene_fixture *f, size_t missing)
{
    uint64_t model;
    struct text *text = test_text();
    assert_true(plant_model_hash(f->plant->assets[0].model, &model));
    text_add(text, "{\"format\": 2, \"assets\": [");
    for (size_t i = 0; i < f->plant->asset_count; i++)
        text_add(text, "{\"id\": \"%s\", \"file\": \"%s\", \"recipe\": \"%016" PRIx64 "\"%s}%s", f->plant->assets[i].id,
                 i == missing ? "0.asset" : "1.asset", i == missing ? 0 : plant_recipe(&f->plant->assets[i], model),
                 i == missing ? ", \"missing\": \"no node's name matches 'B'\"" : "", i + 1 < f->plant->asset_count ? "," : "]}");
    write_manifest(f, text->at);
}

/* If the manifest states why one asset is missing, the other assets are still loaded. */
CASE(a_missing_asset_does_not_keep_the_others_away)
{
    write_missing(f, 1);
    struct scene *scene = scene_create(f->log, f->plant, f->prepared);
    assert_non_null(scene);
    assert_null(scene->assets[0].missing);
    assert_string_equal(scene->assets[1].missing, "no node's name matches 'B'");
    assert_int_equal(scene->assets[1].sensor_count, 0);
    assert_true(scene->assets[0].sensor_count > 0);
    /* the plant's bounds no longer include (10, 20, 30), where the missing asset B would be; B itself gets the plant's bounds
       */
    for (int axis = 0; axis < 3; axis++) {
        assert_true(scene->bounds_max_m[axis] < 9);
        assert_true(scene->assets[1].bounds_max_m[axis] == scene->bounds_max_m[axis]);
    }
    scene_destroy(&scene);
    write_manifest(f, "{\"format\": 2, \"assets\": [{\"id\": \"A\", \"file\": \"0\", \"recipe\": \"0\", \"missing\": \"a\"},"
                      "{\"id\": \"B\", \"file\": \"0\", \"recipe\": \"0\", \"missing\": \"b\"},"
                      "{\"id\": \"C\", \"file\": \"0\", \"recipe\": \"0\", \"missing\": \"c\"}]}");
    assert_refused(f, "plantcast-prep could not prepare any asset");
    write_missing(f, 0); /* the first asset with a model is missing, so that its model is hashed for a later one */
    scene = scene_create(f->log, f->plant, f->prepared);
    assert_non_null(scene);
    assert_non_null(scene->assets[0].missing);
    assert_null(scene->assets[1].missing);
    scene_destroy(&scene);
    write_good_manifest(f);
}

CASE(home_is_the_view_of_the_plant)
{
    struct camera camera;
    struct scene *scene = scene_create(f->log, f->plant, f->prepared);
    assert_non_null(scene);
    scene_home(scene, 1.5, &camera);
    assert_true(camera_valid(&camera));
    assert_true(scene->extreme_count >= 4);
    /* scene->extremes_m, the outermost points of the assets by direction, must lie within the plant's bounds and come close to
       each side */
    for (int i = 0; i < 3; i++) {
        double least = INFINITY, most = -INFINITY, slack = 0.15 * (scene->bounds_max_m[i] - scene->bounds_min_m[i]) + 1e-6;
        for (size_t n = 0; n < scene->extreme_count; n++) {
            least = fmin(least, scene->extremes_m[n][i]);
            most = fmax(most, scene->extremes_m[n][i]);
        }
        assert_true(least >= scene->bounds_min_m[i] - 1e-4 && most <= scene->bounds_max_m[i] + 1e-4);
        assert_true(least <= scene->bounds_min_m[i] + slack && most >= scene->bounds_max_m[i] - slack);
    }
    for (int i = 0; i < 3; i++) /* by default the camera looks from the south-west and from above */
        assert_true(i < 2 ? camera.eye_m[i] < scene->bounds_min_m[i] : camera.eye_m[i] > scene->bounds_max_m[i]);
    scene_destroy(&scene);
    plant_destroy(&f->plant);
    f->plant = load(f, ", view: { eye: [0, 0, 50], target: [0, 0, 0], fov: 30 }");
    scene = scene_create(f->log, f->plant, f->prepared);
    assert_non_null(scene);
    scene_home(scene, 1.5, &camera);
    assert_true(camera_valid(&camera)); /* straight down, with north above */
    assert_point(camera.eye_m, 0, 0, 50);
    assert_point(camera.up, 0, 1, 0);
    assert_float_equal(camera.fov_deg, 30, 0);
    scene_destroy(&scene);
}

/* The home view covers only assets that are visible at start. B stands 10 m away from the others. */
CASE(home_is_of_what_is_shown_at_the_start)
{
    f->plant->assets[1].start = PLANT_START_HIDDEN;
    struct scene *scene = scene_create(f->log, f->plant, f->prepared);
    assert_non_null(scene);
    assert_true(scene->extreme_count >= 4);
    for (size_t n = 0; n < scene->extreme_count; n++)
        assert_true(scene->extremes_m[n][0] < scene->assets[1].bounds_min_m[0]);
    scene_destroy(&scene);
    /* all assets are hidden at the start, so the home view covers all of them */
    f->plant->assets[0].start = f->plant->assets[2].start = PLANT_START_HIDDEN;
    scene = scene_create(f->log, f->plant, f->prepared);
    assert_non_null(scene);
    assert_true(scene->extreme_count >= 4);
    scene_destroy(&scene);
}
