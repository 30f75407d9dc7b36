/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Debug views of plantcast-prep: GLB files that show what preparation did to a surface. They must follow glTF 2.0 and contain
   what the report counts. */
#include "tests/support/test.h"
#include <sys/stat.h>

#include "preprocess/model/gltf_shim.h"
#include "tests/support/boxes.h"
#include "tests/support/prep_case.h"

static const char plant_text[] = "plant: { name: Boxes }\n"
                                 "assets:\n"
                                 "  - { id: 'GAP/1', model: model.glb, nodes: 'gap-*', up: z }\n"
                                 "  - { id: APART, model: model.glb, nodes: 'apart-*', up: z }\n"
                                 "  - { id: INSIDE, model: model.glb, nodes: 'inside-*', up: z }\n"
                                 "  - { id: BARE, model: model.glb, nodes: 'gap-1', up: z }\n"
                                 "groups:\n"
                                 "  - { id: temperature, unit: K, min: 0, max: 1 }\n"
                                 "sources:\n"
                                 "  - { id: plc, type: modbus, host: 127.0.0.1, byte_order: CDAB, address_base: 1 }\n"
                                 "tags: tags.csv\n";
static const char tags_rows[] = "T-GAP,400001,Float,plc,temperature,GAP/1,,0.5,0.5,1\n"
                                "T-GAP2,400007,Float,plc,temperature,GAP/1,,2,0.5,0.5\n"
                                "T-APART,400003,Float,plc,temperature,APART,,10.5,0.5,1\n"
                                "T-INSIDE,400005,Float,plc,temperature,INSIDE,,22,2,4\n";

static int set_up(void **state)
{
    prep_case_set_up(state);
    struct prep_case *c = *state;
    struct model_maker maker;
    maker_init(&maker);
    boxes_add(&maker, "gap-1", (const double[3]){ 0, 0, 0 }, (const double[3]){ 1, 1, 1 });
    boxes_add(&maker, "gap-2", (const double[3]){ 1.0002, 0, 0 }, (const double[3]){ 2, 1, 1 });
    boxes_add(&maker, "apart-1", (const double[3]){ 10, 0, 0 }, (const double[3]){ 11, 1, 1 });
    boxes_add(&maker, "apart-2", (const double[3]){ 11.5, 0, 0 }, (const double[3]){ 12, 1, 1 });
    boxes_add(&maker, "inside-1", (const double[3]){ 20, 0, 0 }, (const double[3]){ 24, 4, 4 });
    boxes_add(&maker, "inside-2", (const double[3]){ 21, 1, 1 }, (const double[3]){ 22, 2, 2 });
    maker_write(&maker, c->folder, "model.glb");
    prep_case_plant(c, plant_text);
    prep_case_tags(c, tags_rows);
    return 0;
}

#define CASE(name) TEST_ON(struct prep_case *c, name, set_up, prep_case_tear_down)

struct parsed_glb {
    struct text file;
    json_t *root;
    const unsigned char *bytes;
    size_t size;
};

static uint32_t number_at(const struct text *file, size_t at)
{
    uint32_t number;
    assert_true(at + 4 <= file->length);
    memcpy(&number, file->at + at, 4);
    return number;
}

/* Reads a GLB file of the debug view and parses its header and chunks as glTF 2.0 defines them. */
static void glb_open(struct parsed_glb *glb, struct prep_case *c, const char *name)
{
    *glb = (struct parsed_glb){ 0 };
    prep_case_read(c, name, &glb->file);
    assert_memory_equal(glb->file.at, "glTF", 4);
    assert_int_equal(number_at(&glb->file, 4), 2);
    assert_int_equal(number_at(&glb->file, 8), glb->file.length);
    uint32_t json_bytes = number_at(&glb->file, 12);
    assert_int_equal(json_bytes % 4, 0);
    assert_memory_equal(glb->file.at + 16, "JSON", 4);
    glb->root = json_loadb(glb->file.at + 20, json_bytes, 0, NULL);
    assert_non_null(glb->root);
    uint32_t bin_bytes = number_at(&glb->file, 20 + json_bytes);
    assert_memory_equal(glb->file.at + 24 + json_bytes, "BIN\0", 4);
    assert_int_equal(28 + json_bytes + bin_bytes, glb->file.length);
    assert_int_equal(bin_bytes % 4, 0);
    glb->bytes = (unsigned char *)glb->file.at + 28 + json_bytes;
    glb->size = (size_t)prep_case_number(glb->root, "buffers.0.byteLength");
    assert_true(glb->size <= bin_bytes && bin_bytes < glb->size + 4);
}

static void glb_close(struct parsed_glb *glb)
{
    json_decref(glb->root);
    text_finish(&glb->file);
}

static const json_t *object_of(const struct parsed_glb *glb, const char *list, const json_t *number)
{
    const json_t *object = json_array_get(json_object_get(glb->root, list), (size_t)json_integer_value(number));
    assert_non_null(object);
    return object;
}

static const void *elements(const struct parsed_glb *glb, const json_t *accessor, size_t each)
{
    const json_t *view = object_of(glb, "bufferViews", json_object_get(accessor, "bufferView"));
    size_t offset = (size_t)json_integer_value(json_object_get(view, "byteOffset"));
    size_t length = (size_t)json_integer_value(json_object_get(view, "byteLength"));
    assert_int_equal(offset % 4, 0);
    assert_true(length > 0 && offset + length <= glb->size);
    assert_true((size_t)json_integer_value(json_object_get(accessor, "count")) * each == length);
    return glb->bytes + offset;
}

static void check_positions(const struct parsed_glb *glb, const json_t *accessor)
{
    const float(*places)[3] = elements(glb, accessor, 12);
    for (size_t axis = 0; axis < 3; axis++) {
        float low = INFINITY, high = -INFINITY;
        for (size_t i = 0; i < (size_t)json_integer_value(json_object_get(accessor, "count")); i++) {
            assert_true(isfinite(places[i][axis]));
            low = fminf(low, places[i][axis]);
            high = fmaxf(high, places[i][axis]);
        }
        assert_true((float)json_number_value(json_array_get(json_object_get(accessor, "min"), axis)) == low);
        assert_true((float)json_number_value(json_array_get(json_object_get(accessor, "max"), axis)) == high);
    }
}

/* Asserts glTF's rules for each primitive, accessor and buffer view. */
static void check_rules(const struct parsed_glb *glb)
{
    const json_t *meshes = json_object_get(glb->root, "meshes");
    assert_true(json_array_size(meshes) > 0);
    for (size_t m = 0; m < json_array_size(meshes); m++) {
        const json_t *primitive = json_array_get(json_object_get(json_array_get(meshes, m), "primitives"), 0);
        const json_t *attributes = json_object_get(primitive, "attributes"), *indices = json_object_get(primitive, "indices");
        const json_t *positions = object_of(glb, "accessors", json_object_get(attributes, "POSITION"));
        const json_t *material = object_of(glb, "materials", json_object_get(primitive, "material"));
        size_t count = (size_t)json_integer_value(json_object_get(positions, "count")), corners = count;
        assert_non_null(json_object_get(json_object_get(material, "extensions"), "KHR_materials_unlit"));
        check_positions(glb, positions);
        if (json_object_get(attributes, "COLOR_0")) {
            const json_t *colors = object_of(glb, "accessors", json_object_get(attributes, "COLOR_0"));
            assert_true(json_is_true(json_object_get(colors, "normalized")));
            assert_int_equal(json_integer_value(json_object_get(colors, "count")), count);
            elements(glb, colors, 8);
        }
        if (indices) {
            const json_t *accessor = object_of(glb, "accessors", indices);
            const uint32_t *at = elements(glb, accessor, 4);
            corners = (size_t)json_integer_value(json_object_get(accessor, "count"));
            for (size_t i = 0; i < corners; i++)
                assert_true(at[i] < count);
        }
        json_int_t mode = json_integer_value(json_object_get(primitive, "mode"));
        assert_true(mode == 0 || (mode == 1 && corners % 2 == 0) || (mode == 4 && corners % 3 == 0));
    }
}

/* Returns the first primitive of the node whose name begins with `name`, or NULL. */
static const json_t *node_shape(const struct parsed_glb *glb, const char *name)
{
    const json_t *nodes = json_object_get(glb->root, "nodes");
    for (size_t i = 0; i < json_array_size(nodes); i++) {
        const json_t *node = json_array_get(nodes, i);
        if (strncmp(json_string_value(json_object_get(node, "name")), name, strlen(name)) == 0)
            return json_array_get(json_object_get(object_of(glb, "meshes", json_object_get(node, "mesh")), "primitives"), 0);
    }
    return NULL;
}

static const json_t *positions_of(const struct parsed_glb *glb, const json_t *primitive)
{
    assert_non_null(primitive);
    return object_of(glb, "accessors", json_object_get(json_object_get(primitive, "attributes"), "POSITION"));
}

static size_t count_of(const struct parsed_glb *glb, const char *name)
{
    return (size_t)json_integer_value(json_object_get(positions_of(glb, node_shape(glb, name)), "count"));
}

CASE(views_follow_the_rules)
{
    static const char *const names[] = { "plant.debug/GAP%2F1.glb", "plant.debug/APART.glb", "plant.debug/INSIDE.glb",
                                         "plant.debug/BARE.glb" };
    prep_case_expect(c, "$PLANT --debug-view", 0);
    for (size_t i = 0; i < 4; i++) {
        struct parsed_glb glb;
        glb_open(&glb, c, names[i]);
        check_rules(&glb);
        glb_close(&glb);
        struct model_source source;
        struct gltf_model model;
        char why[MODEL_WHY_BYTES], *path = temp_path(c->folder, names[i]);
        /* Plantcast's own loader reads the file too; it counts the primitives that are not triangles */
        assert_true(model_source_open(&source, path, why));
        if (!gltf_load(&model, &source, why))
            fail_msg("%s: %s", path, why);
        assert_true(model.skipped_points == 2 || model.skipped_points == 1);
        gltf_free(&model);
        model_source_finish(&source);
    }
}

CASE(bridges_and_points_are_those_of_the_report)
{
    struct parsed_glb glb;
    prep_case_expect(c, "$PLANT --debug-view=$FOLDER/views --report json", 0);
    json_t *report = prep_case_json(&c->out);
    glb_open(&glb, c, "views/GAP%2F1.glb");
    size_t bridges = (size_t)prep_case_number(report, "assets.0.surface.bridges");
    assert_int_equal(count_of(&glb, "bridges"), 2 * bridges);
    assert_int_equal(count_of(&glb, "where the bridges are"), 6 * bridges);
    assert_int_equal(json_integer_value(json_object_get(node_shape(&glb, "bridges"), "mode")), 1);
    assert_int_equal(json_integer_value(json_object_get(node_shape(&glb, "points added"), "mode")), 0);
    assert_true(count_of(&glb, "points added") > 5000);
    assert_true(count_of(&glb, "points of the model") <= 16);
    /* coordinates are relative to the asset's centre, at x = 1.0 m in the model, so the bridges over the gap lie from x = 0 to
       0.2 mm */
    const json_t *positions = positions_of(&glb, node_shape(&glb, "bridges"));
    assert_float_equal(prep_case_number(positions, "min.0"), 0, 1e-6);
    assert_float_equal(prep_case_number(positions, "max.0"), 0.0002, 1e-6);
    assert_null(node_shape(&glb, "unreachable"));
    /* the node "hidden" exists, because at the contact one box covers faces of the other */
    assert_non_null(node_shape(&glb, "hidden"));
    glb_close(&glb);
}

CASE(what_cannot_be_reached_is_shown)
{
    struct parsed_glb glb;
    prep_case_expect(c, "$PLANT --debug-view", 0);
    glb_open(&glb, c, "plant.debug/APART.glb");
    /* the second box extends from x = 11.5 to 12 in the model; coordinates are relative to the asset's origin at x = 11 */
    const json_t *positions = positions_of(&glb, node_shape(&glb, "unreachable"));
    assert_float_equal(prep_case_number(positions, "min.0"), 0.5, 1e-6);
    assert_float_equal(prep_case_number(positions, "max.0"), 1, 1e-6);
    glb_close(&glb);
    glb_open(&glb, c, "plant.debug/INSIDE.glb");
    /* the hidden box extends from x = 21 to 22 and from 1 to 2 in height; coordinates are relative to the asset's origin at x =
       22 and height 2 */
    positions = positions_of(&glb, node_shape(&glb, "hidden"));
    assert_float_equal(prep_case_number(positions, "min.0"), -1, 1e-6);
    assert_float_equal(prep_case_number(positions, "max.1"), 0, 1e-6);
    glb_close(&glb);
    glb_open(&glb, c, "plant.debug/BARE.glb"); /* no sensor: no distance */
    assert_non_null(node_shape(&glb, "surface"));
    assert_null(node_shape(&glb, "distance"));
    glb_close(&glb);
}

/* Vertices near the sensor must have the first colour of the colour map (dark), and those at the far end the last one (bright).
   */
CASE(colors_follow_the_distance)
{
    struct parsed_glb glb;
    for (int far = 0; far < 2; far++) {
        prep_case_expect(c, far ? "$PLANT --debug-view --sensor T-GAP2" : "$PLANT --debug-view --sensor T-GAP", 0);
        glb_open(&glb, c, "plant.debug/GAP%2F1.glb");
        const json_t *shape = node_shape(&glb, far ? "distance from T-GAP2" : "distance from T-GAP,");
        const json_t *positions = positions_of(&glb, shape);
        const json_t *colors = object_of(&glb, "accessors", json_object_get(json_object_get(shape, "attributes"), "COLOR_0"));
        const float(*places)[3] = elements(&glb, positions, 12);
        const uint16_t(*rgba)[4] = elements(&glb, colors, 8);
        double near_x = far ? 1 : -0.5,
               /* position of the sensor: T-GAP2 in the middle of the end face at x = 2, T-GAP on top of the first box */
               near_y = far ? 0 : 0.5;
        for (size_t i = 0; i < (size_t)json_integer_value(json_object_get(positions, "count")); i++) {
            double dx = (double)places[i][0] - near_x, dy = (double)places[i][1] - near_y, dz = (double)places[i][2];
            if (sqrt(dx * dx + dy * dy + dz * dz) < 0.05) /* dark purple, the first colour of the map: more blue than green */
                assert_true(rgba[i][2] > rgba[i][1] && rgba[i][1] < 3000);
            if (far && (double)places[i][0] < -0.99) /* and ends in yellow */
                assert_true(rgba[i][1] > 10000 && rgba[i][1] > 2 * rgba[i][2]);
        }
        glb_close(&glb);
    }
    char *other = temp_path(c->folder, "plant.debug/APART.glb"); /* a sensor names its asset */
    struct stat st;
    assert_int_not_equal(stat(other, &st), 0);
    prep_case_expect(c, "$PLANT --debug-view --sensor T-NONE", 1);
    prep_case_says(&c->err, "tag T-NONE is not a sensor");
    prep_case_expect(c, "$PLANT --debug-view=/proc/no/such --asset APART", 1);
    prep_case_says(&c->err, "cannot be created");
    prep_case_expect(c, "$PLANT --sensor T-GAP", 2);
}
