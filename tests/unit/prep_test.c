/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The program plantcast-prep: which files it builds, leaves alone and rebuilds, and which errors it reports. */
#include "tests/support/test.h"
#include <fcntl.h>
#include <jansson.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/files/atomic_file.h"
#include "base/text/text.h"
#include "preprocess/cache/folder.h"
#include "protocol/asset_distance.h"
#include "tests/support/glb.h"
#include "tests/support/model_seeds.h"
#include "tests/support/prep_case.h"

/* The tests' model: a plate of 2 m x 1 m in 40 x 20 squares, used by several nodes, and an instrument node TT-2 without
   triangles. */
#define ACROSS 40u
#define UP 20u

static const char plant_text[] = "plant: { name: Prep test }\n"
                                 "assets:\n"
                                 "  - { id: A, model: model.glb, nodes: 'plate-1', up: z }\n"
                                 "  - { id: B, model: model.glb, nodes: 'plate-1', up: z, placement: { translate: [10, 0, 0] } }\n"
                                 "  - { id: C, model: model.glb, nodes: 'plate-*', up: z }\n"
                                 "groups:\n"
                                 "  - { id: temperature, unit: K, min: 0, max: 1 }\n"
                                 "sources:\n"
                                 "  - { id: plc, type: modbus, host: 127.0.0.1, byte_order: CDAB, address_base: 1 }\n"
                                 "tags: tags.csv\n";
static const char tags_text[] = "T1,400001,Float,plc,temperature,A,,0,0,0\n"
                                "T2,400003,Float,plc,temperature,A,TT-2,,,\n"
                                "T3,400005,Float,plc,temperature,B,,10,0,0\n"
                                "T4,400007,Float,plc,temperature,B,TT-2,,,\n"
                                "T5,400009,Float,plc,temperature,C,,1,0.5,0.4\n";

/* Node lists of the model: first_nodes; next_nodes, a revision in which plate-2 has moved, a plate is added and the order
   differs; moved_node, in which TT-2 has moved instead. */
static const char first_nodes[] = "\"scenes\":[{\"nodes\":[0,1,2]}],\"nodes\":[{\"name\":\"plate-1\",\"mesh\":0},{\"name\":\"plate-2\","
                                  "\"mesh\":0,\"translation\":[0,5,0]},{\"name\":\"TT-2\",\"translation\":[2,1,0]}],";
static const char next_nodes[] = "\"scenes\":[{\"nodes\":[0,1,2,3]}],\"nodes\":[{\"name\":\"TT-2\",\"translation\":[2,1,0]},"
                                 "{\"name\":\"pump\",\"mesh\":0,\"translation\":[0,9,0]},{\"name\":\"plate-1\",\"mesh\":0},"
                                 "{\"name\":\"plate-2\",\"mesh\":0,\"translation\":[0,6,0]}],";
static const char moved_node[] = "\"scenes\":[{\"nodes\":[0,1,2]}],\"nodes\":[{\"name\":\"TT-2\",\"translation\":[1,1,0]},"
                                 "{\"name\":\"plate-1\",\"mesh\":0},{\"name\":\"plate-2\",\"mesh\":0,\"translation\":[0,6,0]}],";

static void write_model(struct prep_case *s, const char *nodes)
{
    const uint32_t vertices = (ACROSS + 1) * (UP + 1), indices = ACROSS * UP * 6;
    struct text *bin = test_text();
    for (uint32_t y = 0; y <= UP; y++)
        for (uint32_t x = 0; x <= ACROSS; x++) {
            const float p[3] = { 2.0f * (float)x / (float)ACROSS, (float)y / (float)UP, 0 };
            text_add_bytes(bin, p, sizeof(p));
        }
    for (uint32_t y = 0; y < UP; y++)
        for (uint32_t x = 0; x < ACROSS; x++) {
            uint32_t a = y * (ACROSS + 1) + x, c = a + ACROSS + 1;
            const uint32_t six[6] = { a, a + 1, c, c, a + 1, c + 1 };
            text_add_bytes(bin, six, sizeof(six));
        }
    char *json = test_printf(
        "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":%u}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":%u}],"
        "%s\"meshes\":[{\"primitives\":[{\"attributes\":"
        "{\"POSITION\":0},\"indices\":1}]}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":%u,\"type\":\"VEC3\"},"
        "{\"bufferView\":0,\"byteOffset\":%u,\"componentType\":5125,\"count\":%u,\"type\":\"SCALAR\"}]}",
        (unsigned)bin->length, (unsigned)bin->length, nodes, vertices, 12 * vertices, indices);
    size_t size;
    char *glb = test_memory(glb_build(json, bin->at, bin->length, &size));
    temp_write(s->folder, "model.glb", glb, size);
}

static int set_up(void **state)
{
    prep_case_set_up(state);
    struct prep_case *c = *state;
    write_model(c, first_nodes);
    prep_case_plant(c, plant_text);
    prep_case_tags(c, tags_text);
    return 0;
}

#define CASE(name) TEST_ON(struct prep_case *s, name, set_up, prep_case_tear_down)

static const json_t *asset_of(const json_t *report, size_t i)
{
    return json_array_get(json_object_get(report, "assets"), i);
}

static const char *state_of(const json_t *report, size_t i)
{
    return json_string_value(json_object_get(asset_of(report, i), "state"));
}

static void assert_states(struct prep_case *s, const char *a, const char *b, const char *c)
{
    prep_case_expect(s, "$PLANT --report json", 0);
    json_t *report = prep_case_json(&s->out);
    assert_string_equal(state_of(report, 0), a);
    assert_string_equal(state_of(report, 1), b);
    assert_string_equal(state_of(report, 2), c);
}

static char *file_of(struct prep_case *s, size_t asset)
{
    struct text *text = test_text();
    prep_case_read(s, "plant.prepared/manifest.json", text);
    json_t *manifest = prep_case_json(text);
    char *name = mem_printf("%s/plant.prepared/%s", s->folder, json_string_value(json_object_get(asset_of(manifest, asset), "file")));
    assert_int_equal(json_integer_value(json_object_get(manifest, "format")), 2);
    return name;
}

CASE(a_plant_is_prepared)
{
    prep_case_expect(s, "$PLANT", 0);
    prep_case_says(&s->err, "tag T5: the sensor is 0.400 m from the surface of asset C (limit: 0.250 m)");
    prep_case_says(&s->err, "tags.csv:6: warning");
    assert_null(strchr(s->err.at, '\r'));
    assert_null(strchr(s->err.at, 27));
    char *a = test_memory(file_of(s, 0)), *b = test_memory(file_of(s, 1)), *c = test_memory(file_of(s, 2));
    /* A and B are instances of one mesh with sensors at the same positions on it, so they share one asset file */
    assert_string_equal(a, b);
    assert_string_not_equal(a, c);
    struct folder_file file;
    char why[200], *folder = temp_path(s->folder, "plant.prepared");
    assert_int_equal(folder_open(&file, folder, strtoull(strrchr(a, '/') + 1, NULL, 16), why), 1);
    const struct asset_view *v = &file.view;
    assert_int_equal(v->header->sensor_count, 2);
    uint32_t own = v->header->vertex_count;
    for (uint32_t l = 0; l < v->header->level_count; l++)
        own -= v->levels[l].added_count;
    assert_int_equal(own, (ACROSS + 1) * (UP + 1));
    assert_true(v->header->level_count > 1 && own < v->header->vertex_count);
    assert_true(v->sensors[1].node_hash != 0 && v->sensors[0].node_hash == 0);
    /* on a flat plate, stored distances along the surface must equal straight-line distances */
    for (uint32_t i = 0; i < v->header->vertex_count; i++) {
        float x = v->positions_m[i][0] + 1, y = v->positions_m[i][1] + 0.5f;
        assert_float_equal(asset_distance_m(v, 0, i), hypotf(x, y), 1e-3);
        assert_float_equal(asset_distance_m(v, 1, i), hypotf(2 - x, 1 - y), 1e-3);
    }
    folder_close(&file);
}

CASE(a_second_run_does_nothing)
{
    struct stat before, after;
    assert_states(s, "built", "shared", "built");
    char *a = test_memory(file_of(s, 0));
    assert_int_equal(stat(a, &before), 0);
    assert_states(s, "unchanged", "shared", "unchanged");
    assert_int_equal(stat(a, &after), 0);
    assert_int_equal(before.st_ino, after.st_ino);
}

CASE(damaged_files_are_made_anew_and_said)
{
    prep_case_expect(s, "$PLANT", 0);
    char *a = test_memory(file_of(s, 0)), *c = test_memory(file_of(s, 2));
    assert_int_equal(truncate(a, 1000), 0);
    size_t size;
    char *bytes = test_memory(text_read_file(c, (size_t)1 << 30, &size));
    bytes[size / 2] ^= 1;
    assert_int_equal(atomic_file_put(c, bytes, size), 0);
    prep_case_expect(s, "$PLANT", 0);
    prep_case_says(&s->err, "truncated: the file has 1000 bytes");
    prep_case_says(&s->err, "checksum");
    assert_states(s, "unchanged", "shared", "unchanged");
}

CASE(only_what_changed_is_made_anew)
{
    prep_case_expect(s, "$PLANT", 0);
    char *old = test_memory(file_of(s, 0));
    prep_case_tags(s, "T1,400001,Float,plc,temperature,A,,0.5,0,0\nT5,400009,Float,plc,temperature,C,,1,0.5,0.4\n");
    assert_states(s, "built", "built", "unchanged");
    /* the tag list changed A's file and no asset uses the old one any more: it must be deleted */
    assert_int_not_equal(access(old, F_OK), 0);
}

static void group_says(struct prep_case *s, const char *more)
{
    const char *at = strstr(plant_text, "max: 1 }");
    char *text = test_printf("%.*smax: 1%s%s", (int)(at - plant_text), plant_text, more, at + strlen("max: 1"));
    prep_case_plant(s, text);
}

/* Returns the number of triangles in the finest level of the first asset. */
static size_t triangles_of_first(struct prep_case *s)
{
    struct folder_file file;
    char why[200], *name = test_memory(file_of(s, 0)), *folder = temp_path(s->folder, "plant.prepared");
    assert_int_equal(folder_open(&file, folder, strtoull(strrchr(name, '/') + 1, NULL, 16), why), 1);
    const struct asset_view *v = &file.view;
    size_t indices = 0;
    for (uint32_t p = 0; p < v->levels[0].primitive_count; p++)
        indices += v->primitives[v->levels[0].first_primitive + p].index_count;
    folder_close(&file);
    return indices / 3;
}

/* A group's reach changes the field and so the subdivision: the asset needs a new file. An alarm limit does not, so the file
   stays. */
CASE(another_reach_is_another_file)
{
    assert_states(s, "built", "shared", "built");
    group_says(s, ", limits: { H: 0.5 }");
    assert_states(s, "unchanged", "shared", "unchanged");
    group_says(s, ", reach_m: 1.5");
    assert_states(s, "built", "shared", "built");
    group_says(s, ", reach_m: 1.25");
    assert_states(s, "built", "shared", "built");
    assert_states(s, "unchanged", "shared", "unchanged");
}

/* With straight-line distances to few sensors, the field is evaluated per pixel and needs no vertices: no triangle may be
   subdivided for it. */
CASE(straight_distances_of_few_sensors_cut_nothing)
{
    size_t cut, whole;
    assert_states(s, "built", "shared", "built");
    cut = triangles_of_first(s);
    group_says(s, ", distance: euclidean");
    assert_states(s, "built", "shared", "built");
    whole = triangles_of_first(s);
    assert_true(whole < cut);
    group_says(s, ", distance: euclidean, prepare: [harmonic]");
    assert_states(s, "built", "shared", "built");
    assert_true(triangles_of_first(s) > whole);
}

CASE(two_at_a_time_take_turns)
{
    char *program = prep_case_program();
    char *both = test_printf("'%s' '%s' --report json >'%s/first' & '%s' '%s' --report json >'%s/second' && wait $!", program, s->plant,
                            s->folder, program, s->plant, s->folder);
    int built[2];
    assert_int_equal(system(both), 0);
    for (int i = 0; i < 2; i++) {
        prep_case_read(s, i ? "second" : "first", &s->out);
        json_t *report = prep_case_json(&s->out);
        built[i] = strcmp(state_of(report, 2), "built") == 0;
        assert_string_equal(state_of(report, 2), built[i] ? "built" : "unchanged");
    }
    assert_int_equal(built[0] + built[1], 1);
}

CASE(who_waits_says_for_whom_and_can_be_stopped)
{
    char *program = prep_case_program(), *folder = temp_path(s->folder, "plant.prepared"), words[100];
    assert_int_equal(mkdir(folder, 0777), 0);
    struct log *log = test_log();
    int lock = folder_lock(folder, log, NULL), status;
    assert_true(lock >= 0);
    temp_write_text(s->folder, "err", "");
    pid_t child = fork();
    if (child == 0) {
        char *err = temp_path(s->folder, "err");
        dup2(open(err, O_WRONLY), 2);
        execl(program, program, s->plant, (char *)NULL);
        _exit(99);
    }
    snprintf(words, sizeof(words), "process %ld is preparing this folder", (long)getpid());
    for (int tries = 0; tries < 1000 && (!s->err.at || !strstr(s->err.at, words)); tries++) {
        usleep(10000);
        prep_case_read(s, "err", &s->err);
    }
    prep_case_says(&s->err, words);
    assert_int_equal(waitpid(child, &status, WNOHANG), 0);
    kill(child, SIGINT);
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_int_equal(WEXITSTATUS(status), 1);
    close(lock);
    prep_case_expect(s, "$PLANT", 0);
}

CASE(distances_are_printed)
{
    prep_case_expect(s, "distances $PLANT --asset B --sensor T3", 0);
    prep_case_says(&s->out, "x,y,z,geodesic_m,euclidean_m\n");
    size_t lines = 0;
    for (char *line = strchr(s->out.at, '\n') + 1; *line; line = strchr(line, '\n') + 1) {
        double x, y, z, geodesic_m, euclidean_m;
        assert_int_equal(sscanf(line, "%lf,%lf,%lf,%lf,%lf", &x, &y, &z, &geodesic_m, &euclidean_m), 5);
        assert_float_equal(euclidean_m, hypot(x - 10, y), 1e-5); /* expects distances from T3, which is on B at x = 10 in the plant frame */
        assert_float_equal(geodesic_m, euclidean_m, 1e-3);
        lines++;
    }
    assert_int_equal(lines, (ACROSS + 1) * (UP + 1));
    prep_case_expect(s, "distances $PLANT --asset B --sensor T1", 1);
    prep_case_says(&s->err, "tag T1 is not a sensor of asset B");
    prep_case_expect(s, "distances $PLANT --asset B --sensor T9", 1);
    prep_case_expect(s, "distances $PLANT --asset B", 2);
}

static char *model_of(struct prep_case *s)
{
    struct text *text = test_text();
    prep_case_expect(s, "$PLANT", 0);
    prep_case_read(s, "plant.prepared/manifest.json", text);
    return test_printf("%s", json_string_value(json_object_get(asset_of(prep_case_json(text), 0), "model")));
}

/* The manifest's hash of a model changes with each file that the pictures depend on: buffer, texture, panorama. */
CASE(the_hash_of_a_model_covers_the_files_that_it_refers_to)
{
    static const char gltf[] =
        "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],"
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],\"images\":[{\"uri\":\"a.png\"}],"
        "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\",\"min\":[0,0,0],\"max\":[1,1,0]}],"
        "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],\"buffers\":[{\"byteLength\":36,\"uri\":\"a.bin\"}]}";
    static const char plant[] = "plant: { name: Parts }\nassets: [{ id: A, model: model.gltf }]\n"
                                "groups: [{ id: temperature, unit: K, min: 0, max: 1 }]\ntags: tags.csv\n";
    static const char hdr[] = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n\x80\x40\x20\x84\x80\x80\x80\x80";
    float corners[9] = { 0, 0, 0, 1, 0, 0, 0.5f, 1, 0 };
    prep_case_plant(s, plant);
    prep_case_tags(s, "");
    temp_write(s->folder, "model.gltf", gltf, sizeof(gltf) - 1);
    temp_write(s->folder, "a.bin", corners, sizeof(corners));
    const char *plain = model_of(s), *before = plain;
    corners[6] = 0.25f;
    temp_write(s->folder, "a.bin", corners, sizeof(corners));
    const char *after = model_of(s);
    assert_string_not_equal(after, before);
    before = after;
    temp_write(s->folder, "a.png", "no picture", 10);
    assert_string_not_equal(after = model_of(s), before);
    before = after;
    temp_write(s->folder, "sky1.hdr", hdr, sizeof(hdr) - 1);
    prep_case_plant(s, test_printf("%senvironment: sky1.hdr\n", plant));
    assert_string_not_equal(after = model_of(s), before);
    assert_int_equal(remove(temp_path(s->folder, "a.png")), 0);
    corners[6] = 0.5f;
    temp_write(s->folder, "a.bin", corners, sizeof(corners));
    prep_case_plant(s, plant);
    assert_string_equal(model_of(s), plain);
}

/* Prepares the plant with these assets, and returns in the manifest's assets the one with the list of ignored extensions. Fails
   unless exactly one has it. */
static const char *asset_with_left_out(struct prep_case *s, const char *assets, const char *more)
{
    const char *id = NULL;
    struct text *text = test_text();
    prep_case_plant(s, test_printf("plant: { name: Parts }\nassets:\n%sgroups: [{ id: temperature, unit: K, min: 0, max: 1 }]\n"
                                   "tags: tags.csv\n%s",
                                   assets, more));
    prep_case_expect(s, "$PLANT", 0);
    prep_case_read(s, "plant.prepared/manifest.json", text);
    const json_t *root = prep_case_json(text);
    for (size_t i = 0; i < json_array_size(json_object_get(root, "assets")); i++)
        if (json_array_size(json_object_get(asset_of(root, i), "left_out")) > 0) {
            assert_null(id);
            id = test_printf("%s", json_string_value(json_object_get(asset_of(root, i), "id")));
        }
    assert_non_null(id);
    return id;
}

CASE(the_list_of_ignored_extensions_stays_while_assets_are_renamed)
{
    static const char hdr[] = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n\x80\x40\x20\x84\x80\x80\x80\x80";
    static const char a[] = "  - { id: A, model: model.glb, nodes: 'plate-1', up: z }\n";
    static const char renamed[] = "  - { id: A2, model: model.glb, nodes: 'plate-1', up: z }\n";
    static const char b[] = "  - { id: B, model: model.glb, nodes: 'plate-2', up: z }\n";
    write_model(s, test_printf("\"extensionsUsed\":[\"ACME_bent\"],%s", first_nodes));
    prep_case_tags(s, "");
    temp_write(s->folder, "sky1.hdr", hdr, sizeof(hdr) - 1);
    assert_string_equal(asset_with_left_out(s, test_printf("%s%s", a, b), ""), "A");
    assert_string_equal(asset_with_left_out(s, test_printf("%s%s", renamed, b), ""), "A2");
    assert_string_equal(asset_with_left_out(s, test_printf("%s%s", renamed, b), "environment: sky1.hdr\n"), "A2");
    assert_string_equal(asset_with_left_out(s, b, "environment: sky1.hdr\n"), "B");
    assert_string_equal(asset_with_left_out(s, test_printf("%s%s", a, b), "environment: sky1.hdr\n"), "A");
}

/* Textures are read: PNG by plantcast-prep itself, other formats by a module in a package of its own, which may be missing. */
CASE(textures_are_read)
{
    struct prep_case *c = s;
    struct wavy_sheet sheet = sheet_create(8, 4);
    struct seed seed = { 0 };
    for (int i = 0; i < SEED_COUNT && (!seed.name || strcmp(seed.name, "textured.glb") != 0); i++) {
        mem_free(seed.bytes);
        seed_make(&seed, i, &sheet);
    }
    assert_string_equal(seed.name, "textured.glb");
    temp_write(c->folder, "model.glb", seed.bytes, seed.size);
    const char *plant = "plant: { name: Textured }\nassets: [{ id: A, model: model.glb }]\n"
                        "groups: [{ id: temperature, unit: K, min: 0, max: 1 }]\ntags: tags.csv\n";
    prep_case_plant(c, plant);
    prep_case_tags(c, "");
    char *bin = mem_strdup(getenv("PLANTCAST_BIN") ? getenv("PLANTCAST_BIN") : "build"), *installed = temp_path(c->folder, "bin");
    char *copy =
        mem_printf("mkdir -p '%s'/bin '%s'/lib/plantcast && cp '%s'/plantcast-prep '%s'/bin", c->folder, c->folder, bin, c->folder);
    char *module = test_printf("cp '%s'/plantcast-images.so '%s'/lib/plantcast", bin, c->folder);
    assert_int_equal(system(copy), 0);
    setenv("PLANTCAST_BIN", installed, 1);
    prep_case_expect(c, "$PLANT --report json", 0);
    json_t *report = prep_case_json(&c->out);
    assert_true(prep_case_number(report, "assets.0.textures") == 1);
    static const char hdr[] = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n\x80\x40\x20\x84\x80\x80\x80\x80";
    char *lit = test_printf("%senvironment: sky1.hdr\n", plant);
    temp_write(c->folder, "sky1.hdr", hdr, sizeof(hdr) - 1);
    prep_case_plant(c, lit);
    prep_case_expect(c, "$PLANT", 1);
    prep_case_says(&c->err, "sky1.hdr': not a PNG or JPEG file: plantcast-images.so is missing: install the package plantcast-images (");
    assert_int_equal(system(module), 0);
    prep_case_expect(c, "$PLANT", 0);
    setenv("PLANTCAST_BIN", bin, 1);
    mem_free(copy);
    mem_free(bin);
    mem_free(seed.bytes);
}

/* With shepard, a single sensor gives a constant field, so no triangles are subdivided. With `interpolation: paper` or
   `singles: cut` they are. */
CASE(a_field_that_is_constant_needs_no_triangles)
{
    struct prep_case *c = s;
    static const char plant[] = "plant: { name: Singles }\nassets: [{ id: A, model: model.glb, nodes: plate-1, up: z }]\n"
                                "groups: [{ id: t, unit: K, min: 0, max: 1 }, { id: p, unit: bar, min: 0, max: 1%s }]\n"
                                "sources: [{ id: plc, type: modbus, host: h, byte_order: CDAB, address_base: 1 }]\ntags: tags.csv\n";
    static const char *const mores[3] = { "", ", interpolation: paper", ", singles: cut" };
    double triangles[3];
    prep_case_tags(c, "T1,400001,Float,plc,t,A,,0.31,0.42,0\nT2,400003,Float,plc,p,A,,1.63,0.57,0\n");
    for (int more = 0; more < 3; more++) {
        char *yaml = test_printf(plant, mores[more]);
        prep_case_plant(c, yaml);
        prep_case_expect(c, "$PLANT --report json", 0);
        json_t *report = prep_case_json(&c->out);
        triangles[more] = prep_case_number(report, "assets.0.levels.0.triangles");
        const json_t *surface = json_object_get(json_array_get(json_object_get(report, "assets"), 0), "surface");
        /* the surface's check by the heat method is reported only if distances matter, i.e. not for a constant field */
        for (int n = 0; n < 2; n++)
            assert_int_equal(json_is_null(json_object_get(surface, n ? "heat_disagreement" : "time_m2")), more == 0);
    }
    assert_in_range((int)triangles[0], 2 * ACROSS * UP, 2 * ACROSS * UP + 8); /* a vertex for each sensor */
    /* with the interpolation paper the field peaks at the sensor, so triangles are subdivided there */
    assert_true(triangles[1] > triangles[0] + 8);
    assert_true(triangles[2] == triangles[1]);
}

/* A sensor whose position is only assumed stands for its whole asset: no surface is prepared for distances, and nothing is
   subdivided. As soon as one sensor on the asset has a known position, both are needed. */
CASE(assumed_places_need_no_surface)
{
    struct prep_case *c = s;
    static const char rows[] = "Tag Name,Address,Data Type,Source,Group,Asset,Node,X,Y,Z,Place\n"
                               "T1,400001,Float,plc,temperature,A,,0.31,0.42,0.1,equipment\n"
                               "T2,400003,Float,plc,temperature,A,,1.63,0.57,0,%s\n";
    for (int known = 0; known < 2; known++) {
        char *tags = test_printf(rows, known ? "position" : "equipment");
        temp_write_text(c->folder, "tags.csv", tags);
        prep_case_plant(c, "plant: { name: Assumed }\nassets: [{ id: A, model: model.glb, nodes: plate-1, up: z }]\n"
                           "groups: [{ id: temperature, unit: K, min: 0, max: 1 }]\n"
                           "sources: [{ id: plc, type: modbus, host: h, byte_order: CDAB, address_base: 1 }]\ntags: tags.csv\n");
        prep_case_expect(c, "$PLANT --report json", 0);
        json_t *report = prep_case_json(&c->out);
        const json_t *surface = json_object_get(json_array_get(json_object_get(report, "assets"), 0), "surface");
        assert_int_equal(json_is_null(surface), !known);
        assert_int_equal(prep_case_number(report, "assets.0.vertices_added") > 0, known);
        assert_float_equal(prep_case_number(report, "assets.0.sensors.0.surface_distance_m"), 0.1, 1e-6);
        assert_float_equal(prep_case_number(report, "assets.0.sensors.1.surface_distance_m"), 0, 1e-6);
        uint64_t key;
        struct folder_file file;
        char *folder = temp_path(c->folder, "plant.prepared"), why[200];
        prep_case_file(c, ".asset", &key);
        assert_int_equal(folder_open(&file, folder, key, why), 1);
        const struct asset_view *view = &file.view;
        assert_int_equal(view->header->sensor_count, 2);
        float most_m = 0;
        for (uint32_t v = 0; v < view->header->vertex_count; v++)
            most_m = fmaxf(most_m, fmaxf(asset_distance_m(view, 0, v), asset_distance_m(view, 1, v)));
        assert_true(known ? most_m > 1 && most_m < 3 : most_m == 0);
        const float *nearest = view->positions_m[view->sensors[0].nearest_vertex], *at = view->sensors[0].surface_m;
        assert_true(hypot((double)(nearest[0] - at[0]), (double)(nearest[1] - at[1])) < (known ? 1e-6 : 0.036)); /* squares of 5 cm */
        folder_close(&file);
        prep_case_expect(c, "distances $PLANT --asset A --sensor T1", !known);
        if (!known)
            prep_case_says(&c->err, "tags.csv:2: error: tag T1: the position on asset A is only assumed");
    }
}

CASE(a_new_revision_costs_what_it_changes)
{
    assert_states(s, "built", "shared", "built");
    write_model(s, next_nodes);
    assert_states(s, "unchanged", "shared", "built"); /* the second plate is elsewhere */
    assert_states(s, "unchanged", "shared", "unchanged");
    write_model(s, moved_node);
    /* the node TT-2, at which A and B each have a sensor, has moved, so the file that both share is built again */
    assert_states(s, "built", "shared", "unchanged");
    write_model(s, next_nodes);
    assert_states(s, "built", "shared", "unchanged");
}

CASE(what_is_wrong_is_said_with_its_place)
{
    prep_case_tags(s, "T1,400001,Float,plc,temperature,A,,0,0,0\nT2,400003,Float,plc,temperature,A,TT-99,,,\n");
    prep_case_expect(s, "$PLANT", 1);
    prep_case_says(&s->err, "tags.csv:3: error: tag T2: asset A: the model has no node 'TT-99'");
    prep_case_tags(s, tags_text);
    char *text = test_printf("%.*s  - { id: D, model: model.glb, nodes: 'tank*' }\n  - { id: E, model: bad.glb }\n%s",
                            (int)(strstr(plant_text, "groups:") - plant_text), plant_text, strstr(plant_text, "groups:"));
    temp_write_text(s->folder, "plant.yaml", text);
    temp_write(s->folder, "bad.glb", "glTF", 4);
    prep_case_expect(s, "$PLANT", 1);
    prep_case_says(&s->err, "plant.yaml:6: error: asset D:");
    prep_case_says(&s->err, "no node's name matches 'tank*'");
    prep_case_says(&s->err, "plant.yaml:7: error: asset E:");
    prep_case_says(&s->err, "the GLB file is truncated: it has only 4 bytes");
    struct text manifest = { 0 }; /* the manifest lists the valid assets with their files, and states for the others why they are missing */
    prep_case_read(s, "plant.prepared/manifest.json", &manifest);
    json_t *root = prep_case_json(&manifest);
    for (size_t i = 0; i < 5; i++)
        assert_int_equal(json_object_get(asset_of(root, i), "missing") != NULL, i > 2);
    assert_non_null(strstr(json_string_value(json_object_get(asset_of(root, 3), "missing")), "no node's name matches 'tank*'"));
    text_finish(&manifest);
    prep_case_expect(s, "$PLANT --report json", 1); /* the valid assets are built */
    json_t *report = prep_case_json(&s->out);
    assert_string_equal(state_of(report, 0), "unchanged");
    assert_string_equal(state_of(report, 3), "failed");
    prep_case_expect(s, "$PLANT --memory 100", 1);
    prep_case_says(&s->err, "plant.yaml: error: 0.00 million triangles are too many: 0.10 GB of memory hold at most 0.00 million.");
    prep_case_expect(s, "$PLANT --output /proc/no/such/place", 1);
    prep_case_says(&s->err, "cannot be created");
}

CASE(wrong_use_is_told_from_wrong_input)
{
    prep_case_expect(s, "--help", 0);
    prep_case_says(&s->out, "usage: plantcast-prep PLANT.yaml");
    prep_case_expect(s, "", 2);
    prep_case_expect(s, "--no-such-option", 2);
    prep_case_expect(s, "$PLANT more", 2);
    prep_case_expect(s, "$PLANT --report xml", 2);
    prep_case_expect(s, "$PLANT --memory much", 2);
    prep_case_expect(s, "/no/such/plant.yaml", 1);
}
