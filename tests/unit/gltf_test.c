/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Loading of glTF models: valid content is read as specified, and every error is refused with its reason. */
#include "preprocess/geometry/geometry.h"

#include "tests/support/test.h"
#include <unistd.h>

#include "tests/support/glb.h"
#include "tests/support/gltf_case.h"

#define CASE(name) TEST_ON(struct gltf_case *l, name, gltf_case_set_up, gltf_case_tear_down)

/* Binary data that all models of this test share. The number in each member's comment is its offset in bytes, to which the
   accessors below refer. */
struct bin {
    float square[4][3];      /* offset 0: in the x-y plane, corners (0,0) (1,0) (0,1) (1,1) */
    uint16_t list16[6];      /* 48: two triangles */
    uint8_t strip8[4];       /* 60 */
    uint32_t strip32[4];     /* 64 */
    int16_t quantized[4][4]; /* offset 80: the square in normalised integers, stride 8 */
    uint16_t sparse_at[2];   /* 112: vertex 3 */
    float sparse_to[3];      /* 116: (2, 2, 0) */
    float broken[4][3];      /* offset 128: one coordinate is not a number */
    uint16_t wrong16[6];     /* 176: names vertex 4 */
    float normals[4][3];     /* offset 188: normals that point up, one of length 0 */
    uint8_t colors[4][4];    /* 236 */
    float texcoords[4][2];   /* 252 */
    float instances[2][3];   /* 284: places of two instances */
};

static const struct bin bin = {
    .square = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 1, 1, 0 } },
    .list16 = { 0, 1, 2, 2, 1, 3 },
    .strip8 = { 0, 1, 2, 3 },
    .strip32 = { 0, 1, 2, 3 },
    .quantized = { { 0, 0, 0 }, { 32767, 0, 0 }, { 0, 32767, 0 }, { 32767, 32767, 0 } },
    .sparse_at = { 3 },
    .sparse_to = { 2, 2, 0 },
    .broken = { { 0, 0, 0 }, { 1, NAN, 0 }, { 0, 1, 0 }, { 1, 1, 0 } },
    .wrong16 = { 0, 1, 2, 2, 1, 4 },
    .normals = { { 0, 0, 1 }, { 0, 0, 1 }, { 0, 0, 0 }, { 0, 0, 1 } },
    .colors = { { 255, 0, 0, 255 } },
    .texcoords = { { 0, 0 }, { 1, 0 }, { 0, 1 }, { 1, 1 } },
    .instances = { { 0, 0, 0 }, { 5, 0, 0 } },
};

#define VIEWS                                                                                                                              \
    "\"buffers\":[{\"byteLength\":308}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":308},"                                               \
    "{\"buffer\":0,\"byteOffset\":80,\"byteLength\":32,\"byteStride\":8}],"
#define ACCESSORS                                                                                                                          \
    "\"accessors\":["                                                                                                                      \
    "{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"},"                        /* 0 square */                       \
    "{\"bufferView\":0,\"byteOffset\":48,\"componentType\":5123,\"count\":6,\"type\":\"SCALAR\"},"    /* 1 list16 */                       \
    "{\"bufferView\":0,\"byteOffset\":60,\"componentType\":5121,\"count\":4,\"type\":\"SCALAR\"},"    /* 2 strip8 */                       \
    "{\"bufferView\":0,\"byteOffset\":64,\"componentType\":5125,\"count\":4,\"type\":\"SCALAR\"},"    /* 3 strip32 */                      \
    "{\"bufferView\":1,\"componentType\":5122,\"normalized\":true,\"count\":4,\"type\":\"VEC3\"},"    /* 4 quantized */                    \
    "{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\",\"sparse\":{\"count\":1," /* 5 sparse */                       \
    "\"indices\":{\"bufferView\":0,\"byteOffset\":112,\"componentType\":5123},\"values\":{\"bufferView\":0,\"byteOffset\":116}}},"         \
    "{\"bufferView\":0,\"byteOffset\":128,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"},"                     /* 6 broken */       \
    "{\"bufferView\":0,\"byteOffset\":176,\"componentType\":5123,\"count\":6,\"type\":\"SCALAR\"},"                   /* 7 wrong16 */      \
    "{\"bufferView\":0,\"byteOffset\":188,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"},"                     /* 8 normals */      \
    "{\"bufferView\":0,\"byteOffset\":236,\"componentType\":5121,\"normalized\":true,\"count\":4,\"type\":\"VEC4\"}," /* 9 colors */       \
    "{\"bufferView\":0,\"byteOffset\":252,\"componentType\":5126,\"count\":4,\"type\":\"VEC2\"},"                     /* 10 texcoords */   \
    "{\"bufferView\":0,\"byteOffset\":284,\"componentType\":5126,\"count\":2,\"type\":\"VEC3\"},"                     /* 11 instances */   \
    "{\"bufferView\":0,\"byteOffset\":300,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"}," /* 12 past the end */                    \
    "{\"bufferView\":0,\"componentType\":5126,\"count\":4611686018427387904,\"type\":\"VEC3\"},"  /* 13 absurd */                          \
    "{\"bufferView\":7,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"},"                    /* 14 no such view */                    \
    "{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"},"                    /* 15 three positions */                 \
    "{\"bufferView\":0,\"byteOffset\":60,\"componentType\":5121,\"normalized\":true,\"count\":4,\"type\":\"SCALAR\"}]" /* 16 strip8 */
#define HEAD "{\"asset\":{\"version\":\"2.0\"}," VIEWS
#define PLAIN_NODES "\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"name\":\"part\",\"mesh\":0}],"
#define MESH(primitive) "\"meshes\":[{\"name\":\"m\",\"primitives\":[" primitive "]}],"
#define SQUARE "{\"attributes\":{\"POSITION\":0},\"indices\":1}"

static void load(struct gltf_case *l, const char *json)
{
    size_t size;
    char *bytes = test_memory(glb_build(json, &bin, sizeof(bin), &size));
    gltf_case_load(l, "model.glb", bytes, size);
}

static void good(struct gltf_case *l, const char *json)
{
    load(l, json);
    if (!l->good)
        fail_msg("refused: %s", l->why);
}

static void refused(struct gltf_case *l, const char *json, const char *reason)
{
    load(l, json);
    if (l->good)
        fail_msg("accepted; expected: %s", reason);
    if (!strstr(l->why, reason))
        fail_msg("refused for '%s', expected '%s'", l->why, reason);
}

static void assert_square(const struct gltf_primitive *p)
{
    assert_int_equal(p->vertex_count, 4);
    assert_int_equal(p->index_count, 6);
    assert_memory_equal(p->indices, ((const uint32_t[6]){ 0, 1, 2, 2, 1, 3 }), sizeof(uint32_t[6]));
    for (int i = 0; i < 4; i++)
        for (int axis = 0; axis < 3; axis++)
            assert_float_equal(p->positions[i][axis], bin.square[i][axis], 1e-4);
}

CASE(every_kind_of_index_and_position_is_read)
{
    assert_int_equal(sizeof(bin), 308);
    good(l, HEAD PLAIN_NODES MESH(SQUARE) ACCESSORS "}");
    assert_square(&l->model.primitives[0]);
    good(l, HEAD PLAIN_NODES MESH("{\"attributes\":{\"POSITION\":4},\"indices\":2,\"mode\":5}") ACCESSORS "}");
    assert_square(&l->model.primitives[0]);
    good(l, HEAD PLAIN_NODES MESH("{\"attributes\":{\"POSITION\":0},\"indices\":3,\"mode\":5}") ACCESSORS "}");
    assert_square(&l->model.primitives[0]);
    good(l, HEAD PLAIN_NODES MESH("{\"attributes\":{\"POSITION\":0},\"mode\":6}") ACCESSORS "}");
    assert_memory_equal(l->model.primitives[0].indices, ((const uint32_t[6]){ 0, 1, 2, 0, 2, 3 }), sizeof(uint32_t[6]));
    good(l, HEAD PLAIN_NODES MESH("{\"attributes\":{\"POSITION\":5},\"indices\":1}") ACCESSORS "}");
    assert_float_equal(l->model.primitives[0].positions[3][0], 2, 0);
    good(l, HEAD PLAIN_NODES MESH("{\"attributes\":{\"POSITION\":0,\"NORMAL\":8,\"COLOR_0\":9,\"TEXCOORD_0\":10},\"indices\":1}") ACCESSORS
         "}");
    assert_int_equal(l->model.primitives[0].colors[0][0], 255);
    assert_float_equal(l->model.primitives[0].texcoords[3][1], 1, 0);
}

CASE(lines_and_points_are_skipped_and_counted)
{
    good(l,
         HEAD PLAIN_NODES MESH("{\"attributes\":{\"POSITION\":0},\"mode\":1}," SQUARE
                               ",{\"attributes\":{\"POSITION\":0},\"mode\":0},{\"attributes\":{\"POSITION\":0},\"mode\":3}") ACCESSORS "}");
    assert_int_equal(l->model.primitive_count, 1);
    assert_int_equal(l->model.skipped_lines, 2);
    assert_int_equal(l->model.skipped_points, 1);
}

CASE(nodes_are_put_in_place)
{
    good(l, HEAD
         "\"scenes\":[{\"nodes\":[1]}],\"nodes\":[{\"name\":\"b\",\"mesh\":0,\"translation\":[1,2,3]},"
         "{\"name\":\"a\",\"children\":[0,2],\"scale\":[2,2,2]},{\"name\":\"c\",\"rotation\":[0,0,0.70710678,0.70710678]}]," MESH(SQUARE)
             ACCESSORS "}");
    assert_int_equal(l->model.node_count, 3);
    assert_string_equal(l->model.nodes[0].name, "a");
    assert_int_equal(l->model.nodes[0].end, 3);
    assert_string_equal(l->model.nodes[1].name, "b");
    assert_int_equal(l->model.nodes[1].parent, 0);
    assert_float_equal(l->model.nodes[1].world[13], 4, 1e-12);
    assert_float_equal(l->model.nodes[2].world[1], 2, 1e-6); /* the node's matrix maps the x axis to the y axis and doubles it */
    good(l, HEAD "\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"name\":\"i\",\"mesh\":0,\"extensions\":{\"EXT_mesh_gpu_instancing\":"
                 "{\"attributes\":{\"TRANSLATION\":11}}}}]," MESH(SQUARE) ACCESSORS "}");
    assert_int_equal(l->model.node_count, 3);
    assert_int_equal(l->model.nodes[0].mesh, -1);
    assert_float_equal(l->model.nodes[2].world[12], 5, 0);
}

#define TURNED(rotation)                                                                                                                   \
    HEAD "\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"name\":\"valve\",\"mesh\":0,\"rotation\":" rotation "}]," MESH(SQUARE) ACCESSORS "}"

/* A node's rotation may be a quaternion of any length: it rotates like the unit quaternion and is counted in scaled_rotations.
   One of length 0 is refused. */
CASE(rotations_have_a_length)
{
    good(l, TURNED("[0,0,0.7071,0.7071]"));
    assert_int_equal(l->model.scaled_rotations, 0);
    good(l, TURNED("[0,0,2,2]"));
    assert_int_equal(l->model.scaled_rotations, 1);
    assert_float_equal(l->model.nodes[0].world[0], 0, 1e-12);
    assert_float_equal(l->model.nodes[0].world[1], 1, 1e-12);
    assert_float_equal(l->model.nodes[0].world[10], 1, 1e-12);
    refused(l, TURNED("[0,0,0,0]"),
            "node 0 'valve': the node's rotation in the glTF file is invalid: its quaternion has length 0, expected 1");
    refused(l, TURNED("[0,0,1e-9,0]"), "node 0 'valve': the node's rotation");
}

CASE(wrong_numbers_are_refused)
{
    refused(l, HEAD PLAIN_NODES MESH("{\"attributes\":{\"POSITION\":0},\"indices\":7}") ACCESSORS "}",
            "mesh 0 'm', primitive 0: index number 5 refers to vertex 4, but there are only 4 vertices");
    refused(l, HEAD PLAIN_NODES MESH("{\"attributes\":{\"POSITION\":6},\"indices\":1}") ACCESSORS "}",
            "POSITION: element 1 is infinite or not a number");
    refused(l, HEAD PLAIN_NODES MESH("{\"attributes\":{\"POSITION\":12},\"indices\":1}") ACCESSORS "}",
            "4 elements do not fit into bufferView 0");
    refused(l, HEAD PLAIN_NODES MESH("{\"attributes\":{\"POSITION\":13},\"indices\":1}") ACCESSORS "}", "elements do not fit into the");
    refused(l, HEAD PLAIN_NODES MESH("{\"attributes\":{\"POSITION\":14},\"indices\":1}") ACCESSORS "}",
            "refers to bufferView 7, which does not exist");
    refused(l, HEAD PLAIN_NODES MESH("{\"attributes\":{\"POSITION\":99},\"indices\":1}") ACCESSORS "}", "there is no accessor 99");
    refused(l, HEAD PLAIN_NODES MESH("{\"attributes\":{\"POSITION\":1},\"indices\":1}") ACCESSORS "}", "1 components, expected 3");
    refused(l, HEAD PLAIN_NODES MESH("{\"attributes\":{\"POSITION\":0,\"NORMAL\":15},\"indices\":1}") ACCESSORS "}",
            "attribute NORMAL has 3 elements, but POSITION has 4");
    refused(l, HEAD PLAIN_NODES MESH("{\"attributes\":{\"POSITION\":0},\"indices\":0}") ACCESSORS "}", "is not allowed for indices");
    refused(l, HEAD PLAIN_NODES MESH("{\"attributes\":{\"POSITION\":0},\"indices\":16,\"mode\":5}") ACCESSORS "}",
            "the accessor of `indices` has `normalized: true`");
    refused(l, HEAD PLAIN_NODES MESH("{\"attributes\":{\"NORMAL\":0},\"indices\":1}") ACCESSORS "}", "has no attribute POSITION");
    refused(l, HEAD PLAIN_NODES MESH("{\"attributes\":{\"POSITION\":0},\"indices\":2}") ACCESSORS "}",
            "the number of indices, 4, is not a multiple of 3");
    refused(l, HEAD PLAIN_NODES MESH("{\"attributes\":{\"POSITION\":0},\"indices\":1,\"mode\":7}") ACCESSORS "}", "mode 7");
    refused(l, HEAD PLAIN_NODES MESH("{\"attributes\":{\"POSITION\":0},\"indices\":1,\"material\":3}") ACCESSORS "}",
            "there is no material 3");
}

CASE(wrong_trees_are_refused)
{
    refused(l,
            HEAD "\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"children\":[1]},{\"name\":\"x\",\"children\":[0]}]," MESH(SQUARE) ACCESSORS
            "}",
            "is part of a cycle or has two parents");
    refused(l, HEAD "\"nodes\":[{\"children\":[1]},{\"children\":[0]}]," MESH(SQUARE) ACCESSORS "}", "a cycle");
    refused(l,
            HEAD "\"scenes\":[{\"nodes\":[0,1]}],\"nodes\":[{\"children\":[2]},{\"children\":[2]},{\"name\":\"shared\"}]," MESH(SQUARE)
                ACCESSORS "}",
            "node 2 'shared' is part of a cycle or has two parents");
    refused(l, HEAD "\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"children\":[9]}]," MESH(SQUARE) ACCESSORS "}", "there is no node 9");
    refused(l, HEAD "\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":4}]," MESH(SQUARE) ACCESSORS "}", "there is no mesh 4");
    struct text *deep = test_text();
    text_add(deep, HEAD "\"scenes\":[{\"nodes\":[0]}],\"nodes\":[");
    for (int i = 0; i < 1000; i++)
        text_add(deep, "{\"children\":[%d]},", i + 1);
    text_add(deep, "{}]," MESH(SQUARE) ACCESSORS "}");
    refused(l, deep->at, "nested deeper than 512 levels");
}

CASE(unknown_extensions_are_refused)
{
    refused(l, HEAD "\"extensionsRequired\":[\"ACME_secret\"]," PLAIN_NODES MESH(SQUARE) ACCESSORS "}", "ACME_secret");
    refused(l, HEAD "\"extensionsRequired\":{\"ACME_secret\":1}," PLAIN_NODES MESH(SQUARE) ACCESSORS "}",
            "extensionsRequired is not a list");
    refused(l,
            HEAD PLAIN_NODES MESH(
                "{\"attributes\":{\"POSITION\":0},\"extensions\":{\"KHR_draco_mesh_compression\":{\"bufferView\":0,\"attributes\":{}}}}")
                ACCESSORS "}",
            "KHR_draco_mesh_compression");
    good(l, HEAD "\"extensionsRequired\":[\"KHR_mesh_quantization\"]," PLAIN_NODES MESH(SQUARE) ACCESSORS "}");
}

CASE(broken_files_are_refused)
{
    size_t size;
    char *bytes = test_memory(glb_build(HEAD PLAIN_NODES MESH(SQUARE) ACCESSORS "}", &bin, sizeof(bin), &size));
    for (size_t cut = 0; cut < size; cut += 1 + cut / 16) { /* everything but the whole file */
        gltf_case_load(l, "cut.glb", bytes, cut);
        if (l->good || !l->why[0])
            fail_msg("the first %zu bytes of %zu: %s", cut, size, l->good ? "accepted" : "refused without a reason");
    }
    refused(l, "{\"asset\":{\"version\":\"2.0\"},,}", "the JSON part of the glTF model is invalid: line 1");
    refused(l, "[1]", "its JSON part is not an object");
    refused(l,
            "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":308}],\"bufferViews\":[{\"buffer\":0,\"byteOffset\":300,"
            "\"byteLength\":9}]}",
            "bufferView 0: its bytes, from 300 on, 9 bytes, lie outside its buffer of 308 bytes");
    refused(l, "{\"asset\":{\"version\":\"2.0\"},\"bufferViews\":[{\"buffer\":-1,\"byteLength\":9}]}", "there is no buffer -1");
    struct text *deep = test_text();
    text_add(deep, "{\"extras\":");
    for (int i = 0; i < 200000; i++)
        text_add(deep, "[");
    refused(l, deep->at, "nested deeper");
    gltf_case_load(l, "text.glb", "hello", 5);
    assert_false(l->good);
}

CASE(files_outside_the_folder_are_refused)
{
    const char *json = "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"uri\":\"%s\",\"byteLength\":308}],\"bufferViews\":[{\"buffer\":0,"
                       "\"byteLength\":308},"
                       "{\"buffer\":0,\"byteOffset\":80,\"byteLength\":32,\"byteStride\":8}]," PLAIN_NODES MESH(SQUARE) ACCESSORS "}";
    temp_write(l->folder, "inner/with space.bin", &bin, sizeof(bin));
    char *outside = temp_write(l->folder, "outside.bin", &bin, sizeof(bin));
    const char *const bad[] = { "../outside.bin", "%2e%2e/outside.bin", outside, "link.bin", "missing.bin", "http://localhost/x.bin", "." };
    char *link = temp_path(l->folder, "inner/link.bin");
    assert_int_equal(symlink(outside, link), 0);
    for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++) {
        char *text = test_printf(json, bad[i]);
        gltf_case_load(l, "inner/model.gltf", text, strlen(text));
        if (l->good || !strstr(l->why, "is not a readable file inside the model's folder"))
            fail_msg("%s: %s", bad[i], l->good ? "accepted" : l->why);
    }
    temp_write(l->folder, "inner/w\303\244rme 100%.bin", &bin, sizeof(bin));
    const char *const right[] = { "with%20space.bin", "with space.bin", "./with%20space.bin", "w%C3%A4rme%20100%25.bin",
                                  "w%c3%a4rme 100%.bin" };
    for (size_t i = 0; i < sizeof(right) / sizeof(right[0]); i++) {
        char *text = test_printf(json, right[i]);
        gltf_case_load(l, "inner/model.gltf", text, strlen(text));
        if (!l->good)
            fail_msg("%s", l->why);
        assert_square(&l->model.primitives[0]);
    }
}

/* --- cutting assets ------------------------------------------------------------------------------------------------------- */

#define FACILITY                                                                                                                           \
    HEAD "\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"name\":\"site\",\"children\":[1,2,4]},{\"name\":\"P-101A\",\"mesh\":0},"              \
         "{\"name\":\"P-101B\",\"mesh\":0,\"translation\":[10,0,0],\"children\":[3]},{\"name\":\"P-101B/"                                  \
         "seal\",\"translation\":[0,0,1],\"mesh\":0},"                                                                                     \
         "{\"name\":\"E-7\",\"mesh\":0,\"translation\":[1000000,2000000,0]}]," MESH(SQUARE) ACCESSORS "}"

CASE(nodes_are_chosen_by_pattern_and_taken_once)
{
    good(l, FACILITY);
    const struct geometry *g = gltf_case_cut(l, "P-101*", 1, AXIS_Z);
    /* the node "P-101B/seal" lies below "P-101B": both match the pattern, but its triangles must be taken only once */
    assert_int_equal(g->primitive_count, 3);
    assert_string_equal(g->names.at + g->primitives[2].name, "P-101B/seal");
    g = gltf_case_cut(l, "E-7", 1, AXIS_Z);
    assert_float_equal(g->origin_m[0], 1000000.5, 0);
    /* coordinates of a million metres lose no precision: positions are stored relative to the asset's origin */
    assert_float_equal(g->positions_m[0][0], -0.5, 0);
    char why[MODEL_WHY_BYTES];
    assert_false(geometry_cut(&(struct geometry){ 0 }, &l->model, &(struct geometry_params){ .nodes = "X*", .unit_m = 1 }, why));
    assert_non_null(strstr(why, "no node's name matches 'X*'"));
}

CASE(units_and_axes_are_turned_to_metres_and_z_up)
{
    good(l, HEAD "\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"name\":\"p\",\"mesh\":0,\"translation\":[0,0,7000]}]," MESH(SQUARE) ACCESSORS
         "}");
    const struct geometry *g = gltf_case_cut(l, NULL, 0.001, AXIS_Y);
    assert_float_equal(g->origin_m[1], -7, 1e-9);     /* the model has y up, so its z axis becomes -y of the asset */
    assert_float_equal(g->origin_m[2], 0.0005, 1e-9); /* and its y axis becomes z of the asset */
    double n[3];
    gltf_case_face_normal(g, 0, n);
    assert_true(n[1] < 0 && fabsf(g->normals[0][1] + 1) < 1e-5f); /* a face that pointed to +z in the model must point to -y in the asset */
}

CASE(mirrored_nodes_keep_their_outside)
{
    good(l, HEAD "\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0,\"scale\":[-1,1,2]}]," MESH(
                "{\"attributes\":{\"POSITION\":0,\"NORMAL\":8},\"indices\":1}") ACCESSORS "}");
    const struct geometry *g = gltf_case_cut(l, NULL, 1, AXIS_Z);
    for (uint32_t t = 0; t < 2; t++) {
        double n[3];
        gltf_case_face_normal(g, t, n);
        assert_true(n[2] > 0);
    }
    for (uint32_t v = 0; v < g->vertex_count; v++)
        assert_float_equal(g->normals[v][2], 1, 1e-6); /* normals are valid even where the model's own normal has length zero */
}

CASE(triangles_without_area_are_left_out)
{
    good(l, HEAD "\"scenes\":[{\"nodes\":[0,1]}],\"nodes\":[{\"mesh\":0},{\"mesh\":0,\"scale\":[1,0,1]}]," MESH(SQUARE) ACCESSORS "}");
    const struct geometry *g = gltf_case_cut(l, NULL, 1, AXIS_Z);
    assert_int_equal(g->index_count, 6);
    assert_int_equal(g->degenerate_triangles, 2);
    assert_int_equal(g->vertex_count, 4);
}

CASE(a_nodes_place_is_the_middle_of_its_meshes)
{
    double place[3];
    char why[MODEL_WHY_BYTES];
    struct geometry_params params = { .nodes = "P-101B", .unit_m = 1, .up = AXIS_Z };
    good(l, FACILITY);
    assert_true(geometry_node_place(&l->model, &params, "P-101B/seal", place, why));
    assert_float_equal(place[0], 10.5, 1e-9);
    assert_float_equal(place[2], 1, 1e-9);
    assert_true(geometry_node_place(&l->model, &params, "P-101B", place, why));
    assert_float_equal(place[2], 0.5, 1e-9); /* the node's position is the centre of its box, which includes the seal below it */
    assert_true(geometry_node_place(&l->model, &params, "P-101A", place, why));
    assert_false(geometry_node_place(&l->model, &params, "TT-1", place, why));
}

/* Three pumps of the same name in two areas, and a node without a name. */
#define PUMP(x) "{\"name\":\"pump\",\"mesh\":0,\"translation\":[" #x ",0,0]}"
#define NORTH "{\"name\":\"north\",\"children\":[1,2]},"
#define SOUTH "{\"name\":\"south\",\"children\":[4,5]},"
#define NAMELESS "{\"mesh\":0,\"translation\":[30,0,0]}"
#define ALIKE                                                                                                                              \
    HEAD "\"scenes\":[{\"nodes\":[0,3]}],\"nodes\":[" NORTH PUMP(0) "," PUMP(10) "," SOUTH PUMP(20) "," NAMELESS "]," MESH(SQUARE)         \
        ACCESSORS "}"

CASE(a_name_that_is_there_several_times_is_refused)
{
    double place[3];
    char why[MODEL_WHY_BYTES];
    struct geometry_params params = { .unit_m = 1, .up = AXIS_Z };
    good(l, ALIKE);
    assert_false(geometry_node_place(&l->model, &params, "pump", place, why));
    assert_string_equal(why, "the model has 3 nodes named 'pump' at different places (#1, #2, #4): select one node by its number or path");
    assert_true(geometry_node_place(&l->model, &params, "#2", place, why));
    assert_float_equal(place[0], 10.5, 1e-9);
    assert_true(geometry_node_place(&l->model, &params, "south/pump", place, why));
    assert_float_equal(place[0], 20.5, 1e-9);
    params.nodes = "south"; /* of the nodes named "pump", only the one below "south" belongs to this asset, so its name is unambiguous */
    assert_true(geometry_node_place(&l->model, &params, "pump", place, why));
    assert_float_equal(place[0], 20.5, 1e-9);
    /* the pattern "south/" with an empty name matches the node without a name */
    assert_true(geometry_node_place(&l->model, &params, "south/", place, why));
    assert_float_equal(place[0], 30.5, 1e-9);
    const struct geometry *g = gltf_case_cut(l, "north\n#5\n!#1", 1, AXIS_Z);
    assert_int_equal(g->primitive_count, 2);
    assert_float_equal(g->origin_m[0], 20.5, 1e-9);
}

/* Valid model files from which no asset can be extracted. */
CASE(what_cannot_be_cut_is_refused)
{
    static const struct {
        const char *json, *reason;
    } cases[] = {
        { HEAD "\"scenes\":[{\"nodes\":[]}],\"nodes\":[{\"mesh\":0}]," MESH(SQUARE) ACCESSORS "}",
          "the glTF model's scene has no nodes, so there is nothing to show" },
        { HEAD "\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0,\"scale\":[1,0,1]}]," MESH(SQUARE) ACCESSORS "}",
          "none of the asset's 2 triangles has an area, so there is nothing to show" },
        { HEAD "\"scenes\":[{\"nodes\":[0,1]}],\"nodes\":[{\"mesh\":0},{\"mesh\":0,\"translation\":[0,2e7,0]}]," MESH(SQUARE) ACCESSORS "}",
          "the asset extends 2e+07 m along axis 1, more than the maximum of 1e+07 m: check the model's unit" },
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        struct geometry g;
        char why[MODEL_WHY_BYTES];
        good(l, cases[i].json);
        assert_false(geometry_cut(&g, &l->model, &(struct geometry_params){ .unit_m = 1, .up = AXIS_Z }, why));
        assert_string_equal(why, cases[i].reason);
    }
}

CASE(wrong_instances_and_sparse_elements_are_refused)
{
    static const struct {
        const char *attributes, *reason;
    } instances[] = {
        { "\"_OWN\":11", "node 0 'i': EXT_mesh_gpu_instancing: the instances have neither TRANSLATION, ROTATION nor SCALE" },
        { "\"TRANSLATION\":11,\"SCALE\":15",
          "node 0 'i': EXT_mesh_gpu_instancing: the attributes have different numbers of instances, 2 and 3" },
        { "\"TRANSLATION\":10", "node 0 'i': EXT_mesh_gpu_instancing: TRANSLATION has 2 components, expected 3" },
        { "\"TRANSLATION\":6", "TRANSLATION: element 1 is infinite or not a number" },
    };
    for (size_t i = 0; i < sizeof(instances) / sizeof(instances[0]); i++) {
        char *json = test_printf(HEAD "\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"name\":\"i\",\"mesh\":0,\"extensions\":"
                                     "{\"EXT_mesh_gpu_instancing\":{\"attributes\":{%s}}}}]," MESH(SQUARE) ACCESSORS "}",
                                instances[i].attributes);
        refused(l, json, instances[i].reason);
    }
    static const struct {
        int count, type, at;
        const char *reason;
    } sparse[] = {
        { 5, 5123, 112, "POSITION: sparse accessor with 5 of 4 elements and indices of component type 5123" },
        { 1, 5122, 112, "POSITION: sparse accessor with 1 of 4 elements and indices of component type 5122" },
        { 1, 5123, 186, "POSITION: sparse accessor: the index of element 4 of 4 is out of range or out of order" },
        { 1, 5123, 307, "do not fit into bufferView 0" },
    };
    for (size_t i = 0; i < sizeof(sparse) / sizeof(sparse[0]); i++) {
        char *json = test_printf(HEAD PLAIN_NODES MESH(
                                    SQUARE) "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":4,"
                                            "\"type\":\"VEC3\",\"sparse\":{\"count\":%d,\"indices\":{\"bufferView\":0,\"byteOffset\":%d,"
                                            "\"componentType\":%d},\"values\":{\"bufferView\":0,\"byteOffset\":116}}},"
                                            "{\"bufferView\":0,\"byteOffset\":48,\"componentType\":5123,\"count\":6,\"type\":\"SCALAR\"}]}",
                                sparse[i].count, sparse[i].at, sparse[i].type);
        refused(l, json, sparse[i].reason);
    }
}

/* Returns whether the triangle's vertex normals point to the side from which its corners appear counter-clockwise. Smoothed
   normals at an edge may tilt to the other side a little. */
static bool faces_outward(const struct geometry *g, uint32_t tri)
{
    double out[3];
    gltf_case_face_normal(g, tri, out);
    double length = sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2]);
    for (int k = 0; k < 3; k++) {
        const float *n = g->normals[g->indices[3 * tri + (uint32_t)k]];
        if ((double)n[0] * out[0] + (double)n[1] * out[1] + (double)n[2] * out[2] < -0.6 * length)
            return false;
    }
    return true;
}

CASE(real_models_go_through)
{
    static const char *const names[] = {
        "plm_plant_equipment",        "plm_plant_5parts",     "plm_plant_hierarchy",       "huldra_wd1_psup",  "duplex_mep",
        "offshore_platform_overview", "cookie_factory_mixer", "cookie_factory_water_tank", "industrial_tanker"
    };
    if (access("../shared/data/models", R_OK) != 0) {
        print_message("# ../shared/data/models is not there\n");
        skip();
    }
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++) {
        char *path = test_printf("../shared/data/models/%s.glb", names[i]);
        gltf_case_read(l, path);
        if (!l->good)
            fail_msg("%s: %s", path, l->why);
        const struct geometry *g = gltf_case_cut(l, NULL, 1, AXIS_Y);
        assert_true(g->index_count > 3000);
        assert_int_equal(l->model.scaled_rotations, 0);
        for (uint32_t v = 0; v < g->vertex_count; v++) {
            const float *n = g->normals[v];
            assert_float_equal(n[0] * n[0] + n[1] * n[1] + n[2] * n[2], 1, 1e-3);
        }
        for (uint32_t t = 0; t < g->index_count / 3; t++)
            assert_true(faces_outward(g, t));
    }
}
