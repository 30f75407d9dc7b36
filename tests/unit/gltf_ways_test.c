/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The same surface is encoded in every way that glTF allows and must always be read as the same surface. This includes
   compression by the reference encoders and by common compression programs. */
#include "preprocess/geometry/geometry.h"

#include "tests/support/test.h"
#include <unistd.h>

#include "plant/models/transform.h"
#include "tests/support/gltf_case.h"
#include "tests/support/model_maker.h"
#include "tests/support/model_seeds.h"

static int set_up(void **state)
{
    gltf_case_set_up(state);
    temp_write_text(((struct gltf_case *)*state)->folder, "a picture.png", "no picture, and never looked at");
    return 0;
}

#define CASE(name) TEST_ON(struct gltf_case *l, name, set_up, gltf_case_tear_down)

static void try_bytes(struct gltf_case *l, char *bytes, size_t size)
{
    gltf_case_load(l, "model.glb", bytes, size);
    mem_free(bytes);
}

static void try_model(struct gltf_case *l, struct model_maker *maker)
{
    size_t size;
    char *bytes = maker_glb(maker, &size);
    maker_finish(maker);
    try_bytes(l, bytes, size);
}

static void assert_refused(const struct gltf_case *l, const char *reason)
{
    if (l->good || !strstr(l->why, reason))
        fail_msg("'%s', expected '%s'", l->good ? "accepted" : l->why, reason);
}

static void assert_good(const struct gltf_case *l)
{
    if (!l->good)
        fail_msg("%s", l->why);
}

static void assert_model_refused(struct gltf_case *l, struct model_maker *maker, const char *reason)
{
    try_model(l, maker);
    assert_refused(l, reason);
}

static void assert_model_good(struct gltf_case *l, struct model_maker *maker)
{
    try_model(l, maker);
    assert_good(l);
}

/* --- the same surface ---------------------------------------------------------------------------------------------------- */

struct gltf_corner {
    double at[3];
    const float *normal;
    const uint8_t *color;
};

/* Returns the number of the wavy test sheet's triangle that has these corners in the same winding order, or -1 if there is
   none. */
static int triangle_of(const struct wavy_sheet *sheet, struct gltf_corner corners[3], double tolerance_m)
{
    for (uint32_t t = 0; t < sheet->index_count / 3; t++)
        for (int turn = 0; turn < 3; turn++) {
            double worst = 0;
            for (int c = 0; c < 3; c++)
                for (int axis = 0; axis < 3; axis++)
                    worst = fmax(worst, fabs((double)sheet->positions[sheet->indices[3 * t + (uint32_t)((c + turn) % 3)]][axis] -
                                             corners[c].at[axis]));
            if (worst <= tolerance_m)
                return (int)t;
        }
    return -1;
}

static void assert_look(const struct gltf_corner *corner, double tolerance_m)
{
    double slope = -0.3 * sin(3 * corner->at[0]), length = sqrt(1 + slope * slope);
    if (corner->normal) {
        assert_true(fabs((double)corner->normal[0] + slope / length) < 0.02 + 10 * tolerance_m);
        assert_true(fabs((double)corner->normal[2] - 1 / length) < 0.02 + 10 * tolerance_m);
    }
    if (corner->color) {
        assert_true(fabs(corner->color[0] - 127 * corner->at[0]) < 1.5);
        assert_true(fabs(corner->color[1] - 255 * corner->at[1]) < 1.5);
    }
}

/* Asserts that the primitives of one node contain every triangle of the sheet exactly once. */
static void assert_sheet(const struct gltf_model *model, const struct gltf_node *node, const struct wavy_sheet *sheet, double tolerance_m)
{
    bool *seen = mem_array(sheet->index_count / 3, sizeof(*seen));
    uint32_t count = 0;
    const struct gltf_mesh *mesh = &model->meshes[node->mesh];
    for (uint32_t i = 0; i < mesh->primitive_count; i++) {
        const struct gltf_primitive *p = &model->primitives[mesh->first_primitive + i];
        for (uint32_t index = 0; index < p->index_count; index += 3, count++) {
            struct gltf_corner corners[3];
            for (uint32_t c = 0; c < 3; c++) {
                uint32_t v = p->indices[index + c];
                const float *at = p->positions[v];
                corners[c] = (struct gltf_corner){ .normal = p->normals ? p->normals[v] : NULL, .color = p->colors ? p->colors[v] : NULL };
                transform_point(node->world, (double[3]){ (double)at[0], (double)at[1], (double)at[2] }, corners[c].at);
                assert_look(&corners[c], tolerance_m);
            }
            int triangle = triangle_of(sheet, corners, tolerance_m + 1e-6);
            if (triangle < 0 || seen[triangle])
                fail_msg("triangle %u is %s", count, triangle < 0 ? "not of the sheet" : "there twice");
            seen[triangle] = true;
        }
    }
    assert_int_equal(count, sheet->index_count / 3);
    mem_free(seen);
}

static uint32_t drawn_triangles(const struct gltf_model *model)
{
    uint32_t corners = 0;
    for (uint32_t n = 0; n < model->node_count; n++)
        for (uint32_t p = 0; model->nodes[n].mesh >= 0 && p < model->meshes[model->nodes[n].mesh].primitive_count; p++)
            corners += model->primitives[model->meshes[model->nodes[n].mesh].first_primitive + p].index_count;
    return corners / 3;
}

static const struct gltf_node *first_drawn(const struct gltf_model *model)
{
    uint32_t n = 0;
    while (n < model->node_count && model->nodes[n].mesh < 0)
        n++;
    assert_true(n < model->node_count);
    return &model->nodes[n];
}

CASE(every_way_gives_the_same_surface)
{
    struct wavy_sheet sheet = sheet_create(24, 10);
    for (int i = 0; i < SEED_COUNT; i++) {
        struct seed seed;
        seed_make(&seed, i, &sheet);
        try_bytes(l, seed.bytes, seed.size);
        print_message("# %-24s %7zu bytes: %s\n", seed.name, seed.size, l->good ? "read" : l->why);
        assert_good(l);
        assert_int_equal(drawn_triangles(&l->model), seed.triangles);
        assert_sheet(&l->model, first_drawn(&l->model), &sheet, seed.tolerance_m);
    }
}

CASE(great_meshes_are_decompressed)
{
    static const char *const names[] = { "meshopt.glb", "meshopt_filters.glb", "draco_edgebreaker.glb", "draco_sequential.glb" };
    struct wavy_sheet sheet = sheet_create(300, 200); /* 120,000 triangles, 60,501 vertices */
    for (int i = 0; i < SEED_COUNT; i++) {
        struct seed seed;
        bool wanted = false;
        seed_make(&seed, i, &sheet);
        for (size_t n = 0; n < sizeof(names) / sizeof(names[0]); n++)
            wanted = wanted || strcmp(names[n], seed.name) == 0;
        if (!wanted) {
            mem_free(seed.bytes);
            continue;
        }
        try_bytes(l, seed.bytes, seed.size);
        print_message("# %-24s %7zu bytes\n", seed.name, seed.size);
        assert_good(l);
        assert_int_equal(drawn_triangles(&l->model), 120000);
        assert_int_equal(l->model.primitives[0].vertex_count, 60501);
    }
}

/* --- by other programs --------------------------------------------------------------------------------------------------- */

static bool has_program(const char *name)
{
    char *command = test_printf("command -v %s >/dev/null", name);
    int status = system(command);
    return status == 0;
}

static size_t write_plain(struct gltf_case *l, const struct wavy_sheet *sheet)
{
    struct model_maker maker;
    size_t size, count = sheet->vertex_count;
    maker_init(&maker);
    int positions = maker_numbers(&maker, sheet->positions, count * 12, FLOAT, count, "VEC3");
    int normals = maker_numbers(&maker, sheet->normals, count * 12, FLOAT, count, "VEC3");
    int colors = maker_numbers(&maker, sheet->colors, count * 4, UBYTE, count, "VEC4");
    int indices = maker_numbers(&maker, sheet->indices, sheet->index_count * (size_t)4, UINT, sheet->index_count, "SCALAR");
    json_object_set_new(maker_get(&maker, "accessors", colors), "normalized", json_true());
    maker_node(&maker, "sheet",
               maker_mesh(&maker, json_pack("{s:{s:i,s:i,s:i},s:i}", "attributes", "POSITION", positions, "NORMAL", normals, "COLOR_0",
                                            colors, "indices", indices)),
               NULL);
    maker_add(&maker, "scenes", json_pack("{s:[i]}", "nodes", 0));
    json_object_set_new(maker.root, "scene", json_integer(0)); /* without, draco_transcoder finds nothing */
    char *bytes = test_memory(maker_glb(&maker, &size));
    maker_finish(&maker);
    temp_write(l->folder, "plain.glb", bytes, size);
    return size;
}

/* Compresses FOLDER/plain.glb to FOLDER/packed.glb with an external program, asserts that the result declares the extension,
   and reads it. */
static void try_packed(struct gltf_case *l, const char *program, const char *options, const char *extension, double tolerance_m)
{
    struct wavy_sheet sheet = sheet_create(24, 10);
    size_t size;
    size_t before = write_plain(l, &sheet);
    char *command = test_printf("cd '%s' && %s %s -i plain.glb -o packed.glb >said 2>&1", l->folder, program, options);
    char *path = temp_path(l->folder, "packed.glb");
    assert_int_equal(system(command), 0);
    char *bytes = test_memory(text_read_file(path, (size_t)1 << 20, &size));
    assert_non_null(bytes);
    gltf_case_read(l, path);
    print_message("# %s %-14s %6zu bytes, %zu before: %s\n", program, options, size, before, l->good ? "read" : l->why);
    assert_non_null(memmem(bytes, size, extension, strlen(extension)));
    assert_good(l);
    assert_int_equal(drawn_triangles(&l->model), sheet.index_count / 3);
    assert_sheet(&l->model, first_drawn(&l->model), &sheet, tolerance_m);
}

CASE(what_gltfpack_writes_is_read)
{
    static const char *const options[] = { "-c", "-cc", "-cf", "-cc -vpn" };
    if (!has_program("gltfpack"))
        skip();
    for (size_t i = 0; i < sizeof(options) / sizeof(options[0]); i++)
        try_packed(l, "gltfpack", options[i], "EXT_meshopt_compression", 2e-4);
    try_packed(l, "gltfpack", "", "KHR_mesh_quantization", 2e-4);
}

CASE(what_draco_writes_is_read)
{
    if (!has_program("draco_transcoder"))
        skip();
    try_packed(l, "draco_transcoder", "-qp 14 -qn 10", "KHR_draco_mesh_compression", 2e-4);
    try_packed(l, "draco_transcoder", "", "KHR_draco_mesh_compression", 1e-3);
}

/* --- damaged compressed data --------------------------------------------------------------------------------------------- */

/* Changes each byte of the compressed data in turn. The reader must never crash, and a model that it accepts must be
   consistent. */
CASE(broken_compression_is_refused_or_harmless)
{
    struct wavy_sheet sheet = sheet_create(6, 4);
    for (int i = 9; i <= 12; i++) {
        struct seed seed;
        seed_make(&seed, i, &sheet);
        size_t refused = 0, tried = 0;
        for (size_t at = seed.size - 500; at < seed.size; at += 3, tried++) {
            char *bytes = mem_array(seed.size, 1);
            memcpy(bytes, seed.bytes, seed.size);
            bytes[at] = (char)(bytes[at] ^ 0x55);
            try_bytes(l, bytes, seed.size);
            refused += !l->good;
            for (uint32_t p = 0; l->good && p < l->model.primitive_count; p++)
                for (uint32_t k = 0; k < l->model.primitives[p].index_count; k++)
                    assert_true(l->model.primitives[p].indices[k] < l->model.primitives[p].vertex_count);
        }
        print_message("# %-24s %zu of %zu refused\n", seed.name, refused, tried);
        mem_free(seed.bytes);
    }
}

/* Opens seed model `number` as JSON and bytes, so that a test can change it before it is read. */
static struct model_maker seed_open(int number, const char *name, const struct wavy_sheet *sheet)
{
    struct seed seed;
    struct model_maker maker;
    seed_make(&seed, number, sheet);
    assert_string_equal(seed.name, name);
    uint32_t json_bytes;
    memcpy(&json_bytes, seed.bytes + 12, 4);
    maker_init(&maker);
    json_decref(maker.root);
    maker.root = json_loadb(seed.bytes + 20, json_bytes, 0, NULL);
    assert_non_null(maker.root);
    size_t bin = 20 + json_bytes + 8;
    text_add_bytes(&maker.bin, seed.bytes + bin, seed.size - bin);
    mem_free(seed.bytes);
    return maker;
}

static json_t *meshopt_of(struct model_maker *maker, int view)
{
    return json_object_get(json_object_get(maker_get(maker, "bufferViews", view), "extensions"), "EXT_meshopt_compression");
}

CASE(false_claims_of_compressed_views_are_refused)
{
    struct wavy_sheet sheet = sheet_create(6, 4);
    const struct {
        const char *key;
        json_t *value;
        const char *reason;
    } cases[] = {
        { "count", json_integer(4000000000), "cannot hold 4000000000 elements" },
        { "count", json_integer(-1), "bufferView 0: extensions.EXT_meshopt_compression.count is not a whole number" },
        { "count", json_integer(34), "bytes, but byteLength is" },
        { "byteStride", json_integer(6), "cannot be of mode ATTRIBUTES" },
        { "byteLength", json_integer(9999999), "bufferView 0: its bytes, from 0 on, 9999999 bytes, lie outside its buffer of" },
        { "byteLength", json_integer(40), "are damaged" },
        { "mode", json_string("LINES"), "an unknown mode or filter" },
        { "filter", json_string("QUATERNION"), "filter QUATERNION is not allowed for elements of 12 bytes" },
        { "buffer", json_integer(1), "refers to buffer 1, which has no data" },
        { "buffer", json_integer(7), "there is no buffer 7" },
        { "mode", json_null(), "has no extensions.EXT_meshopt_compression.mode" },
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        struct model_maker maker = seed_open(8, "meshopt.glb", &sheet);
        json_object_set_new(meshopt_of(&maker, 0), cases[i].key, cases[i].value);
        assert_model_refused(l, &maker, cases[i].reason);
    }
    struct model_maker maker = seed_open(8, "meshopt.glb", &sheet);
    json_object_del(maker_get(&maker, "bufferViews", 0), "extensions");
    assert_model_refused(l, &maker, "bufferView 0 refers to buffer 1, which has no data");
}

static json_t *primitive_of(struct model_maker *maker)
{
    return json_array_get(json_object_get(maker_get(maker, "meshes", 0), "primitives"), 0);
}

CASE(false_claims_of_draco_are_refused)
{
    struct wavy_sheet sheet = sheet_create(6, 4);
    struct model_maker maker = seed_open(11, "draco_edgebreaker.glb", &sheet);
    memcpy(maker.bin.at + 13, "\xff\xff\xff\xff\x0f", 5); /* 4294967295 triangles */
    assert_model_refused(l, &maker, "mesh 0 'm', primitive 0 cannot be decompressed (KHR_draco_mesh_compression): ");
    assert_non_null(strstr(l->why, "cannot hold"));
    maker = seed_open(11, "draco_edgebreaker.glb", &sheet);
    json_object_set_new(primitive_of(&maker), "mode", json_integer(5));
    assert_model_refused(l, &maker, "has Draco-compressed data of primitive mode 5");
    maker = seed_open(11, "draco_edgebreaker.glb", &sheet);
    json_object_set_new(json_object_get(json_object_get(json_object_get(primitive_of(&maker), "extensions"), "KHR_draco_mesh_compression"),
                                        "attributes"),
                        "NORMAL", json_integer(9));
    assert_model_refused(l, &maker, "the Draco-compressed data lacks NORMAL as attribute 9");
    maker = seed_open(12, "draco_sequential.glb", &sheet);
    json_object_set_new(maker_get(&maker, "bufferViews", 0), "byteLength", json_integer(100));
    assert_model_refused(l, &maker, "(KHR_draco_mesh_compression): ");
    maker = seed_open(12, "draco_sequential.glb", &sheet);
    json_object_set_new(maker_get(&maker, "bufferViews", 0), "byteLength", json_integer(12));
    assert_model_refused(
        l, &maker,
        "mesh 0 'm', primitive 0 cannot be decompressed (KHR_draco_mesh_compression): the Draco-compressed mesh is truncated at 12 bytes");
    maker = seed_open(11, "draco_edgebreaker.glb", &sheet);
    maker.bin.at[0] = 'X';
    assert_model_refused(l, &maker, "bytes of compressed data do not begin with DRACO");
    maker = seed_open(11, "draco_edgebreaker.glb", &sheet);
    maker.bin.at[5] = 1;
    assert_model_refused(l, &maker, "supports only Draco meshes of version 2.2; this one has version 1.2, type 1, method 1");
    maker = seed_open(11, "draco_edgebreaker.glb", &sheet);
    json_object_set_new(json_object_get(json_object_get(json_object_get(primitive_of(&maker), "extensions"), "KHR_draco_mesh_compression"),
                                        "attributes"),
                        "TANGENT", json_integer(0));
    assert_model_refused(l, &maker, "mesh 0 'm', primitive 0 lacks the attribute TANGENT, which its Draco-compressed data has");
}

/* --- models that the seeds do not cover ---------------------------------------------------------------------------------- */

CASE(vertices_that_are_not_used_are_left_out)
{
    struct model_maker maker;
    float many[1000][3] = { { 0 } };
    for (int i = 0; i < 1000; i++)
        many[i][0] = many[i][1] = (float)(i * i);
    many[7][0] = NAN; /* not drawn either */
    maker_init(&maker);
    maker_node(&maker, "n", maker_triangles(&maker, (const float(*)[3])many, 1000, (uint32_t[6]){ 3, 4, 900, 900, 4, 5 }, 6), NULL);
    assert_model_good(l, &maker);
    const struct gltf_primitive *p = &l->model.primitives[0];
    assert_int_equal(p->vertex_count, 4);
    assert_memory_equal(p->indices, ((uint32_t[6]){ 0, 1, 3, 3, 1, 2 }), 24);
    assert_float_equal(p->positions[3][0], 810000, 0);
}

CASE(what_a_small_file_claims_is_bounded)
{
    struct model_maker maker;
    maker_init(&maker);
    int at = maker_accessor(&maker, -1, FLOAT, 4000000000u, "VEC3");
    maker_node(&maker, "n", maker_mesh(&maker, json_pack("{s:{s:i}}", "attributes", "POSITION", at)), NULL);
    assert_model_refused(l, &maker, "accessor 0 has 4000000000 elements without data, more than Plantcast supports");

    maker_init(&maker); /* a small file that states a thousand primitives with the same million indices */
    at = maker_accessor(&maker, -1, FLOAT, 3, "VEC3");
    int list = maker_accessor(&maker, -1, UBYTE, 999999, "SCALAR"), mesh = maker_mesh(&maker, json_null());
    json_array_clear(json_object_get(maker_get(&maker, "meshes", mesh), "primitives"));
    for (int i = 0; i < 1000; i++)
        json_array_append_new(json_object_get(maker_get(&maker, "meshes", mesh), "primitives"),
                              json_pack("{s:{s:i},s:i}", "attributes", "POSITION", at, "indices", list));
    maker_node(&maker, "n", mesh, NULL);
    assert_model_refused(l, &maker, "elements cannot be in a file of");

    maker_init(&maker); /* a small file that states millions of instances of a tiny mesh */
    mesh = maker_mesh(&maker, json_pack("{s:{s:i}}", "attributes", "POSITION", maker_accessor(&maker, -1, FLOAT, 3, "VEC3")));
    at = maker_accessor(&maker, -1, BYTE, 5000000, "VEC3");
    maker_node(&maker, "n", mesh, json_pack("{s:{s:{s:{s:i}}}}", "extensions", "EXT_mesh_gpu_instancing", "attributes", "TRANSLATION", at));
    assert_model_refused(l, &maker, "node 0 'n': EXT_mesh_gpu_instancing: 80000000 elements cannot be in a file of");
}

CASE(wrong_types_and_references_are_refused_by_name)
{
    struct wavy_sheet sheet = sheet_create(2, 2);
    static const struct {
        const char *list, *key, *json, *reason;
    } cases[] = {
        { "nodes", "mesh", "7", "node 0 'sheet': mesh: there is no mesh 7" },
        { "nodes", "mesh", "4294967296", "node 0 'sheet': mesh: there is no mesh 4294967296" },
        { "nodes", "mesh", "0.5", "node 0 'sheet': mesh is not a whole number" },
        { "nodes", "mesh", "\"0\"", "node 0 'sheet': mesh is not a whole number" },
        { "nodes", "children", "[5]", "node 0 'sheet': children: there is no node 5" },
        { "nodes", "children", "5", "node 0 'sheet': children is not a list" },
        { "nodes", "children", "[0]", "a cycle" },
        { "nodes", "matrix", "[1,0,0]", "node 0 'sheet': matrix is not 16 numbers" },
        { "nodes", "matrix", "[1,0,0,0,0,1,0,0,0,0,1,1,0,0,0,1]",
          "the node's matrix in the glTF file is invalid: its last row is not 0 0 0 1" },
        { "nodes", "translation", "[1e300,0,0]", "the node's transformation in the glTF file has numbers that are infinite, invalid" },
        { "nodes", "skin", "0", "there is no skin 0" },
        { "nodes", "name", "5", "name is not text" },
        { "nodes", "weights", "[0.5]", "Plantcast does not support morph targets" },
        { "meshes", "weights", "[0,1]", "mesh 0 'm': Plantcast does not support morph targets" },
        { "meshes", "primitives", "{}", "mesh 0 'm': primitives is not a list" },
        { "meshes", "primitives", "[{}]", "mesh 0 'm', primitive 0: has no attributes" },
        { "meshes", "primitives", "[3]", "mesh 0 'm', primitive 0: is not an object" },
        { "accessors", "count", "-3", "accessor 0: count is not a whole number" },
        { "accessors", "count", "100", "POSITION: 100 elements do not fit into bufferView 0 of 108 bytes" },
        { "accessors", "componentType", "5124", "has component type 5124, which does not exist in glTF 2.0" },
        { "accessors", "type", "\"VEC2\"", "POSITION has 2 components, expected 3" },
        { "accessors", "byteOffset", "\"x\"", "accessor 0: byteOffset is not a whole number" },
        { "accessors", "sparse", "{}", "accessor 0: has no sparse.count" },
        { "accessors", "sparse",
          "{\"count\":2,\"indices\":{\"bufferView\":1,\"componentType\":5121,\"byteOffset\":4},\"values\":{\"bufferView\":0}}",
          "or out of order" },
        { "bufferViews", "byteOffset", "-4", "bufferView 0: byteOffset is not a whole number" },
        { "bufferViews", "byteLength", "99999", "bufferView 0: its bytes, from 0 on, 99999 bytes, lie outside its buffer of" },
        { "bufferViews", "byteStride", "4", "byteStride 4 of bufferView 0 is less than an element's 12 bytes" },
        { "bufferViews", "buffer", "1", "bufferView 0: buffer: there is no buffer 1" },
        { "buffers", "byteLength", "100000", "buffer 0 has 204 bytes instead of" },
        { "buffers", "uri", "\"data:text/plain,hello\"",
          "buffer 0: invalid glTF file: the data URI 'data:text/plain,hello' is not encoded as base64" },
        { "buffers", "uri", "\"data:;base64,AAAA$\"", "buffer 0: invalid glTF file: the base64 data in a data URI" },
        { "buffers", "uri", "\"model%00.bin\"", "the name contains a 0 byte" },
        { "buffers", "uri", "\"/etc/passwd\"", "absolute paths are not allowed" },
        { "buffers", "uri", "\"../x.bin\"", "is not a readable file inside the model's folder" },
        { "buffers", "uri", "\"https://localhost/x.bin\"", "URLs are not supported" },
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        struct model_maker maker;
        maker_init(&maker);
        int mesh = maker_triangles(&maker, (const float(*)[3])sheet.positions, sheet.vertex_count, sheet.indices, sheet.index_count);
        maker_node(&maker, "sheet", mesh, NULL);
        maker_add(&maker, "buffers", json_pack("{s:I}", "byteLength", (json_int_t)maker.bin.length));
        json_t *value = json_loads(cases[i].json, JSON_DECODE_ANY, NULL);
        assert_non_null(value);
        json_object_set_new(maker_get(&maker, cases[i].list, 0), cases[i].key, value);
        assert_model_refused(l, &maker, cases[i].reason);
    }
}

CASE(whole_numbers_may_be_written_as_reals)
{
    struct wavy_sheet sheet = sheet_create(2, 2);
    struct model_maker maker;
    maker = seed_open(2, "indices16.glb", &sheet);
    json_object_set_new(maker_get(&maker, "nodes", 0), "mesh", json_real(0));
    json_object_set_new(maker_get(&maker, "accessors", 0), "count", json_real(24));
    assert_model_good(l, &maker);
    assert_int_equal(drawn_triangles(&l->model), 8);
}

CASE(heads_are_checked)
{
    static const struct {
        const char *json, *reason;
    } cases[] = {
        { "{}", "glTF version '', expected 2.0" },
        { "{\"asset\":{\"version\":\"1.0\"}}", "glTF version '1.0'" },
        { "{\"asset\":{\"version\":\"2.0\",\"minVersion\":\"2.1\"}}", "glTF version '2.1'" },
        { "{\"asset\":{\"version\":\"2.0\"},\"extensionsRequired\":[\"CESIUM_RTC\"]}", "CESIUM_RTC, which Plantcast does not support" },
        { "{\"asset\":{\"version\":\"2.0\"},\"extensionsRequired\":[5]}", "requires the glTF extension" },
        { "{\"asset\":{\"version\":\"2.0\"},\"nodes\":{}}", "nodes is not a list" },
        { "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[5]}", "node 0: is not an object" },
        { "{\"asset\":{\"version\":\"2.0\"},\"scene\":3}", "scene: there is no scene 3" },
        { "{\"asset\":{\"version\":\"2.0\"},\"images\":[{}]}", "image 0 has neither a uri nor a bufferView" },
        { "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":3}]}", "buffer 0 has no uri, and the file has no binary chunk" },
        { "\xEF\xBB\xBF{\"asset\":{\"version\":\"2.0\"},\"scene\":3}", "scene: there is no scene 3" },
        { "{\"asset\":{\"version\":\"2.0\"}", "the JSON part of the glTF model is invalid: line 1" },
        { "", "the JSON part of the glTF model is invalid: line 1" },
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        try_bytes(l, mem_strdup(cases[i].json), strlen(cases[i].json));
        assert_refused(l, cases[i].reason);
    }
}

CASE(colors_are_read_in_every_type)
{
    const float corners[3][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 } }, reals[3][3] = { { 1, 0.5f, 0 }, { 0, 0, 0 }, { 2, -1, 1 } };
    const uint16_t shorts[3][4] = { { 65535, 32768, 0, 65535 }, { 0, 0, 0, 65535 }, { 65535, 0, 65535, 65535 } };
    for (int way = 0; way < 2; way++) {
        struct model_maker maker;
        maker_init(&maker);
        int at = maker_numbers(&maker, corners, sizeof(corners), FLOAT, 3, "VEC3");
        int colors = way ? maker_numbers(&maker, shorts, sizeof(shorts), USHORT, 3, "VEC4")
                         : maker_numbers(&maker, reals, sizeof(reals), FLOAT, 3, "VEC3");
        if (way)
            json_object_set_new(maker_get(&maker, "accessors", colors), "normalized", json_true());
        maker_node(&maker, "n", maker_mesh(&maker, json_pack("{s:{s:i,s:i}}", "attributes", "POSITION", at, "COLOR_0", colors)), NULL);
        assert_model_good(l, &maker);
        assert_memory_equal(l->model.primitives[0].colors, ((uint8_t[12]){ 255, 128, 0, 255, 0, 0, 0, 255, 255, 0, 255, 255 }),
                            12); /* 2 and -1 are clamped */
    }
}

/* --- materials ----------------------------------------------------------------------------------------------------------- */

/* Further textures of a material may use one other mapping (coordinate set and transform) than the base colour texture, from a
   second coordinate set or from the same one. A third mapping is not supported, so that texture is left out. */
static void second_texcoords_are_read(struct gltf_case *l, const struct wavy_sheet *sheet)
{
    struct model_maker maker = seed_open(15, "textured.glb", sheet);
    json_t *material = maker_get(&maker, "materials", 0), *attributes = json_object_get(primitive_of(&maker), "attributes");
    json_object_set_new(material, "occlusionTexture", json_pack("{s:i,s:i}", "index", 0, "texCoord", 1));
    json_object_set_new(material, "normalTexture", json_pack("{s:i,s:i}", "index", 0, "texCoord", 1));
    json_object_set_new(material, "emissiveTexture", json_pack("{s:i}", "index", 0));
    json_object_set(attributes, "TEXCOORD_1", json_object_get(attributes, "TEXCOORD_0"));
    assert_model_good(l, &maker);
    const struct gltf_primitive *p = &l->model.primitives[0];
    /* the base colour texture has a transform, the second mapping has none */
    for (uint32_t v = 0; v < p->vertex_count; v++)
        assert_true(fabsf(p->second_texcoords[v][0] - sheet->texcoords[v][0]) < 1e-6f && p->texcoords[v][0] != p->second_texcoords[v][0]);
    const struct asset_material *m = &l->model.materials[0];
    assert_int_equal(m->second, 1 << 2 | 1 << 3);
    assert_true(m->base_color_texture != ASSET_NO_TEXTURE && m->normal_texture == m->occlusion_texture);
    assert_true(m->occlusion_texture != ASSET_NO_TEXTURE && m->emissive_texture == ASSET_NO_TEXTURE);
    assert_int_equal(l->model.left_out_textures, 1);
    assert_string_equal(
        l->model.left_out[0],
        "material 0 'paint': the emissive texture (TEXCOORD_0) is not shown: Plantcast supports only two texture mappings for a material");
    const struct geometry *g = gltf_case_cut(l, NULL, 1, AXIS_Y);
    assert_true(g->second_texcoords && g->materials[0].second == m->second);

    /* the occlusion texture uses a coordinate set that the primitive lacks: the texture is left out, and the rest is read */
    maker = seed_open(15, "textured.glb", sheet);
    json_object_set_new(maker_get(&maker, "materials", 0), "occlusionTexture", json_pack("{s:i,s:i}", "index", 0, "texCoord", 7));
    assert_model_good(l, &maker);
    g = gltf_case_cut(l, NULL, 1, AXIS_Y);
    assert_true(!g->second_texcoords && g->materials[0].second == 0 && g->materials[0].occlusion_texture == ASSET_NO_TEXTURE);
    assert_int_equal(g->materials[0].base_color_texture, 0);
}

CASE(textures_lie_where_their_transform_puts_them)
{
    struct wavy_sheet sheet = sheet_create(2, 2);
    struct model_maker maker;
    maker = seed_open(15, "textured.glb", &sheet);
    assert_model_good(l, &maker);
    const struct gltf_primitive *p = &l->model.primitives[0];
    for (uint32_t v = 0; v < p->vertex_count; v++) { /* scaled, then turned, then moved */
        double u = 2 * (double)sheet.texcoords[v][0], w = 3 * (double)sheet.texcoords[v][1], c = cos(0.5), s = sin(0.5);
        assert_true(fabs((double)p->texcoords[v][0] - (c * u + s * w + 0.25)) < 1e-6);
        assert_true(fabs((double)p->texcoords[v][1] - (c * w - s * u + 0.5)) < 1e-6);
    }
    assert_int_equal(l->model.texture_count, 1);
    assert_true(l->model.textures[0].srgb && !l->model.textures[0].wrap_repeat);
    const struct geometry *g = gltf_case_cut(l, NULL, 1, AXIS_Y);
    assert_int_equal(g->textures[0].width_px, 2);
    assert_memory_equal(g->texels, ((uint8_t[16]){ 255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 255, 255, 255, 255 }), 16);

    second_texcoords_are_read(l, &sheet);

    maker = seed_open(15, "textured.glb", &sheet); /* the transform's texCoord (coordinate set) takes precedence over that of the texture */
    json_t *attributes = json_object_get(primitive_of(&maker), "attributes");
    json_object_set(attributes, "TEXCOORD_1", json_object_get(attributes, "TEXCOORD_0"));
    json_object_set_new(attributes, "TEXCOORD_0", json_integer(maker_accessor(&maker, -1, FLOAT, sheet.vertex_count, "VEC2")));
    json_t *lead = json_object_get(json_object_get(maker_get(&maker, "materials", 0), "pbrMetallicRoughness"), "baseColorTexture");
    json_object_set_new(json_object_get(json_object_get(lead, "extensions"), "KHR_texture_transform"), "texCoord", json_integer(1));
    assert_model_good(l, &maker);
    assert_true(l->model.primitives[0].texcoords[1][0] != l->model.primitives[0].texcoords[0][0]);

    /* mirrored repetition is not supported for coordinates outside 0..1, which this sheet has, so the texture is left out */
    maker = seed_open(15, "textured.glb", &sheet);
    json_object_set_new(maker_get(&maker, "samplers", 0), "wrapS", json_integer(33648));
    assert_model_good(l, &maker);
    assert_string_equal(l->model.left_out[0], "material 0 'paint': the base colour texture is not shown: Plantcast does not support "
                                              "mirroring, or different wrapping along u and v, outside 0..1");
    assert_int_equal(l->model.materials[0].base_color_texture, ASSET_NO_TEXTURE);

    /* the report shortens the material's name to 80 bytes, but keeps no part of a character */
    char name[31 * 3 + 1] = "";
    for (int i = 0; i < 31; i++)
        memcpy(name + strlen(name), "배", 4);
    maker = seed_open(15, "textured.glb", &sheet);
    json_object_set_new(maker_get(&maker, "samplers", 0), "wrapS", json_integer(33648));
    json_object_set_new(maker_get(&maker, "materials", 0), "name", json_string(name));
    assert_model_good(l, &maker);
    assert_memory_equal(l->model.left_out[0], test_printf("material 0 '%.78s': ", name), 12 + 78 + 3);

    maker = seed_open(15, "textured.glb", &sheet);
    json_object_del(maker_get(&maker, "textures", 0), "source");
    assert_model_good(l, &maker);
    assert_string_equal(
        l->model.left_out[0],
        "material 0 'paint': the base colour texture: the texture's image is not PNG, JPEG or WebP, so the texture is not shown");

    static const char *const looks[] = { "KHR_texture_basisu", "KHR_materials_pbrSpecularGlossiness", "EXT_mesh_features",
                                         "EXT_structural_metadata", "EXT_texture_avif" };
    for (size_t i = 0; i < sizeof(looks) / sizeof(looks[0]); i++) {
        char said[240];
        maker = seed_open(15, "textured.glb", &sheet);
        json_object_set_new(maker.root, "extensionsRequired", json_pack("[s]", looks[i]));
        assert_model_good(l, &maker);
        snprintf(said, sizeof(said), "Plantcast does not support the glTF extension %s, which the file requires: %s", looks[i],
                 strstr(looks[i], "Specular") ? "diffuse colours are kept, specular colours are ignored"
                                              : "the model is shown without it, because it affects only the look");
        assert_string_equal(l->model.left_out[0], said);
        assert_true(l->model.materials[0].base_color_texture != ASSET_NO_TEXTURE);
    }

    maker = seed_open(15, "textured.glb", &sheet);
    json_t *lost = maker_get(&maker, "images", 0);
    json_object_del(lost, "bufferView");
    json_object_set_new(lost, "uri", json_string("none.png"));
    assert_model_good(l, &maker);
    assert_non_null(
        strstr(l->model.left_out[0],
               "base colour texture: the texture's image is missing, so the texture is not shown: 'none.png' is not a readable file"));

    maker = seed_open(15, "textured.glb", &sheet);
    json_object_set_new(maker_get(&maker, "materials", 0), "alphaMode", json_string("GLOW"));
    assert_model_refused(l, &maker, "alphaMode 'GLOW'");

    /* the image data is corrupt: reading the model succeeds, because images are decoded only when geometry is cut */
    maker = seed_open(15, "textured.glb", &sheet);
    const json_t *number = json_object_get(maker_get(&maker, "images", 0), "bufferView");
    const json_t *view = maker_get(&maker, "bufferViews", (int)json_integer_value(number));
    memset(maker.bin.at + json_integer_value(json_object_get(view, "byteOffset")) + 8, 'X', 16);
    assert_model_good(l, &maker);
    char why[MODEL_WHY_BYTES];
    assert_false(geometry_cut(&(struct geometry){ 0 }, &l->model, &(struct geometry_params){ .unit_m = 1, .up = AXIS_Y }, why));
    assert_non_null(strstr(why, "image 0 '"));
}

/* --- cutting ------------------------------------------------------------------------------------------------------------- */

CASE(assets_are_cut_from_a_tree)
{
    struct wavy_sheet sheet = sheet_create(24, 10);
    struct model_maker maker;
    char why[MODEL_WHY_BYTES];
    maker = seed_open(13, "tree.glb", &sheet);
    assert_model_good(l, &maker);

    /* cuts out an asset at 6,000 km from the origin: its vertices must be as exact as near the origin */
    const struct geometry *g = gltf_case_cut(l, "far", 1, AXIS_Z);
    assert_float_equal(g->origin_m[0], 500001, 1e-9);
    assert_float_equal(g->origin_m[1], 6000000.5, 1e-9);
    double step = 1;
    for (uint32_t v = 0; v < g->vertex_count; v++) {
        double x = (double)g->positions_m[v][0] + 1;
        assert_true(fabs((double)g->positions_m[v][2] + g->origin_m[2] - 0.25 - 0.1 * cos(3 * x)) < 3e-7);
        if (x > 1e-6)
            step = fmin(step, x);
    }
    assert_true(fabs(step - 2.0 / 24) < 1e-6);

    /* normals that the reader computes must face the same side as the triangles, also with a mirrored node */
    for (int mirrored = 0; mirrored < 2; mirrored++) {
        g = gltf_case_cut(l, mirrored ? "mirrored" : "sheet", 1, AXIS_Z);
        assert_int_equal(g->index_count, sheet.index_count);
        assert_true(g->computed_normals > 0);
        for (uint32_t t = 0; t < g->index_count / 3; t++) {
            double n[3];
            gltf_case_face_normal(g, t, n);
            assert_true(n[2] > 0);
            assert_true(g->normals[g->indices[3 * t]][2] > 0.9f);
        }
    }

    g = gltf_case_cut(l, "branch", 0.001, AXIS_Y); /* cuts out a sub-tree of nodes; the model is in millimetres and its y axis points up */
    assert_int_equal(g->primitive_count, 1);
    assert_string_equal(g->names.at + g->primitives[0].name, "twig");
    /* the sheet's y axis is the z axis of the node "branch", which becomes -y in the asset */
    assert_float_equal(g->origin_m[1], -0.0095, 1e-6);

    g = gltf_case_cut(l, "[fm]*", 1, AXIS_Z);
    assert_int_equal(g->node_count, 2);
    assert_false(geometry_cut(&(struct geometry){ 0 }, &l->model, &(struct geometry_params){ .nodes = "twigg", .unit_m = 1 }, why));
    assert_non_null(strstr(why, "no node's name matches 'twigg': did you mean 'twig'?"));
}

CASE(mirrored_instances_keep_their_outside)
{
    struct wavy_sheet sheet = sheet_create(4, 2);
    struct model_maker maker = seed_open(14, "instances.glb", &sheet);
    assert_model_good(l, &maker);
    const struct geometry *g = gltf_case_cut(l, "sheet", 1, AXIS_Z);
    assert_int_equal(g->index_count, 3 * sheet.index_count);
    for (uint32_t t = 0; t < g->index_count / 3; t++) {
        double n[3], y = (double)g->positions_m[g->indices[3 * t]][1] + g->origin_m[1];
        bool upside_down = y > 1.5 && y < 3.5; /* a scale of -1 turns the second of three instances upside down */
        gltf_case_face_normal(g, t, n);
        assert_true(upside_down ? n[2] < 0 : n[2] > 0);
        assert_true(upside_down == (g->normals[g->indices[3 * t]][2] < 0));
    }
}

/* A small model that would draw 50 million triangles: 50,001 nodes share a mesh of 1,000 triangles, each of which is a primitive.
   An asset of all nodes must be refused, and an asset of a single node must be accepted. */
CASE(what_many_nodes_draw_is_bounded)
{
    struct model_maker maker;
    char why[MODEL_WHY_BYTES];
    const float corners[3][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 } };
    maker_init(&maker);
    int at = maker_numbers(&maker, corners, sizeof(corners), FLOAT, 3, "VEC3"), mesh = maker_mesh(&maker, json_null());
    json_array_clear(json_object_get(maker_get(&maker, "meshes", mesh), "primitives"));
    for (int i = 0; i < 1000; i++)
        json_array_append_new(json_object_get(maker_get(&maker, "meshes", mesh), "primitives"),
                              json_pack("{s:{s:i}}", "attributes", "POSITION", at));
    for (int i = 0; i < 50001; i++)
        maker_node(&maker, i == 7 ? "one" : "n", mesh, NULL);
    assert_model_good(l, &maker);
    assert_false(geometry_cut(&(struct geometry){ 0 }, &l->model, &(struct geometry_params){ .unit_m = 1 }, why));
    assert_string_equal(why,
                        "the asset has 50001000 triangles; at most 50000000 are possible: split the asset, or export the model coarser");
    const struct geometry *g = gltf_case_cut(l, "one", 1, AXIS_Z);
    assert_int_equal(g->index_count, 3000);
}

CASE(a_name_is_meant_as_it_stands)
{
    struct wavy_sheet sheet = sheet_create(2, 2);
    struct model_maker maker;
    maker = seed_open(2, "indices16.glb", &sheet);
    maker_node(&maker, "TANK[12]", 0, NULL);
    maker_node(&maker, "TANK1", 0, NULL);
    maker_node(&maker, "TANK2", 0, NULL);
    assert_model_good(l, &maker);
    const struct geometry *g = gltf_case_cut(l, "TANK[12]", 1, AXIS_Z);
    assert_int_equal(g->node_count, 1);
    g = gltf_case_cut(l, "TANK[1-2]", 1, AXIS_Z);
    assert_int_equal(g->node_count, 2);
}

CASE(lines_are_counted_for_the_asset_that_has_them)
{
    struct wavy_sheet sheet = sheet_create(2, 2);
    struct model_maker maker;
    char why[MODEL_WHY_BYTES];
    maker = seed_open(4, "fans.glb", &sheet);
    maker_node(&maker, "wire", maker_mesh(&maker, json_pack("{s:{s:i},s:i}", "attributes", "POSITION", 0, "mode", 3)), NULL);
    assert_model_good(l, &maker);
    const struct geometry *g = gltf_case_cut(l, "sheet", 1, AXIS_Z);
    assert_int_equal(g->skipped_lines, 1);
    assert_int_equal(g->skipped_points, 1);
    assert_int_equal(l->model.skipped_lines, 2);
    assert_false(geometry_cut(&(struct geometry){ 0 }, &l->model, &(struct geometry_params){ .nodes = "wire", .unit_m = 1 }, why));
    assert_string_equal(why, "'wire' has no triangles to show, only 1 line primitives and 0 point primitives");
}

/* --- real models --------------------------------------------------------------------------------------------------------- */

CASE(real_models_have_the_triangles_that_they_are_known_to_have)
{
    static const struct {
        const char *name;
        uint32_t drawn, without_area, lines;
    } models[] = {
        { "plm_plant_equipment", 79103, 1473, 0 }, { "plm_plant_5parts", 63879, 1264, 4 },
        { "plm_plant_hierarchy", 53579, 1128, 8 }, { "huldra_wd1_psup", 52830, 4, 0 },
        { "duplex_mep", 335822, 172, 0 },          { "offshore_platform_overview", 13708, 0, 0 },
        { "cookie_factory_mixer", 22083, 0, 0 },   { "cookie_factory_water_tank", 1275, 0, 0 },
        { "industrial_tanker", 3720, 0, 0 },
    };
    if (access("../shared/data/models", R_OK) != 0) {
        print_message("# ../shared/data/models is not there\n");
        skip();
    }
    for (size_t i = 0; i < sizeof(models) / sizeof(models[0]); i++) {
        char *path = test_printf("../shared/data/models/%s.glb", models[i].name);
        gltf_case_read(l, path);
        assert_good(l);
        const struct geometry *g = gltf_case_cut(l, NULL, 1, AXIS_Y);
        print_message("# %-28s %6u triangles, %4u without area, %u primitives of lines, %u textures left out\n", models[i].name,
                      drawn_triangles(&l->model), g->degenerate_triangles, l->model.skipped_lines, l->model.left_out_textures);
        assert_int_equal(drawn_triangles(&l->model), models[i].drawn);
        assert_int_equal(g->index_count / 3 + g->degenerate_triangles, models[i].drawn);
    }
}

static void measure(const struct gltf_model *model, double low[3], double high[3], double *area)
{
    const struct gltf_primitive *p = &model->primitives[0];
    *area = 0;
    for (int axis = 0; axis < 3; axis++) {
        low[axis] = INFINITY;
        high[axis] = -INFINITY;
    }
    for (uint32_t i = 0; i < p->index_count; i += 3) {
        const float *a = p->positions[p->indices[i]];
        double ab[3], ac[3], n2 = 0;
        for (int axis = 0; axis < 3; axis++) {
            ab[axis] = (double)p->positions[p->indices[i + 1]][axis] - (double)a[axis];
            ac[axis] = (double)p->positions[p->indices[i + 2]][axis] - (double)a[axis];
            for (uint32_t c = i; c < i + 3; c++) {
                low[axis] = fmin(low[axis], (double)p->positions[p->indices[c]][axis]);
                high[axis] = fmax(high[axis], (double)p->positions[p->indices[c]][axis]);
            }
        }
        for (int axis = 0; axis < 3; axis++)
            n2 += pow(ab[(axis + 1) % 3] * ac[(axis + 2) % 3] - ab[(axis + 2) % 3] * ac[(axis + 1) % 3], 2);
        *area += sqrt(n2) / 2;
    }
}

/* The largest primitive of a real plant, in every kind of compression, must have the same size and the same area as
   uncompressed. */
CASE(a_real_model_survives_compression)
{
    static const int ways[] = { 8, 9, 11, 12 };
    struct model_source source;
    struct gltf_model real;
    if (access("../shared/data/models", R_OK) != 0) {
        print_message("# ../shared/data/models is not there\n");
        skip();
    }
    assert_true(model_source_open(&source, "../shared/data/models/plm_plant_equipment.glb", l->why));
    assert_true(gltf_load(&real, &source, l->why));
    model_source_finish(&source);
    const struct gltf_primitive *most = &real.primitives[0];
    for (uint32_t p = 0; p < real.primitive_count; p++)
        most = real.primitives[p].index_count > most->index_count && real.primitives[p].normals ? &real.primitives[p] : most;
    struct wavy_sheet sheet = { .vertex_count = most->vertex_count,
                                .index_count = most->index_count,
                                .positions = most->positions,
                                .normals = most->normals,
                                .indices = most->indices };
    sheet.colors = mem_array(sheet.vertex_count, sizeof(*sheet.colors));
    double low[3], high[3], area = 0;
    for (size_t i = 0; i < sizeof(ways) / sizeof(ways[0]); i++) {
        struct seed seed;
        double own_low[3], own_high[3], own_area;
        seed_make(&seed, ways[i], &sheet);
        const char *name = seed.name;
        size_t size = seed.size;
        try_bytes(l, seed.bytes, seed.size);
        assert_good(l);
        measure(&l->model, own_low, own_high, &own_area);
        if (i == 0) {
            memcpy(low, own_low, sizeof(low));
            memcpy(high, own_high, sizeof(high));
            area = own_area;
        }
        print_message("# %-24s %7zu bytes, %u of %u triangles, area %.6f of %.6f\n", name, size, l->model.primitives[0].index_count / 3,
                      sheet.index_count / 3, own_area, area);
        assert_in_range(l->model.primitives[0].index_count, sheet.index_count * 98 / 100, sheet.index_count);
        assert_true(fabs(own_area - area) < 0.01 * area);
        for (int axis = 0; axis < 3; axis++) {
            double within = 1e-3 * (high[axis] - low[axis]) + 1e-6;
            assert_true(fabs(own_low[axis] - low[axis]) < within && fabs(own_high[axis] - high[axis]) < within);
        }
    }
    mem_free(sheet.colors);
    gltf_free(&real);
}
