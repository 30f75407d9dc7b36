/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes glTF models of the same wavy sheet in every way that glTF offers to encode it, as seeds for fuzzing and for tests of
   the loader. */
#include "tests/support/model_seeds.h"

#include <math.h>
#include <meshoptimizer.h>
#include <string.h>

#include "base/mem.h"
#include "tests/support/draco_encode.h"
#include "tests/support/model_maker.h"
#include "tests/support/owned.h"

static void *owned_array(size_t count, size_t size)
{
    void *array = mem_array(count, size);
    owned_add(mem_free, array);
    return array;
}

struct wavy_sheet sheet_create(uint32_t across, uint32_t up)
{
    struct wavy_sheet s = { .across = across, .up = up, .vertex_count = (across + 1) * (up + 1), .index_count = across * up * 6 };
    s.positions = owned_array(s.vertex_count, sizeof(*s.positions));
    s.normals = owned_array(s.vertex_count, sizeof(*s.normals));
    s.texcoords = owned_array(s.vertex_count, sizeof(*s.texcoords));
    s.colors = owned_array(s.vertex_count, sizeof(*s.colors));
    s.indices = owned_array(s.index_count, sizeof(*s.indices));
    for (uint32_t v = 0; v < s.vertex_count; v++) {
        float x = 2 * (float)(v % (across + 1)) / (float)across, y = (float)(v / (across + 1)) / (float)up;
        float slope = -0.3f * sinf(3 * x), length = sqrtf(1 + slope * slope);
        memcpy(s.positions[v], (float[3]){ x, y, 0.1f * cosf(3 * x) }, sizeof(*s.positions));
        memcpy(s.normals[v], (float[3]){ -slope / length, 0, 1 / length }, sizeof(*s.normals));
        memcpy(s.texcoords[v], (float[2]){ x / 2, y }, sizeof(*s.texcoords));
        memcpy(s.colors[v], (uint8_t[4]){ (uint8_t)(127 * x), (uint8_t)(255 * y), 7, 255 }, sizeof(*s.colors));
    }
    uint32_t *out = s.indices;
    for (uint32_t y = 0; y < up; y++)
        for (uint32_t x = 0; x < across; x++, out += 6) {
            uint32_t a = y * (across + 1) + x, c = a + across + 1;
            memcpy(out, (uint32_t[6]){ a, a + 1, c + 1, a, c + 1, c }, sizeof(uint32_t[6]));
        }
    return s;
}

/* --- building blocks ----------------------------------------------------------------------------------------------------- */

static int positions(struct model_maker *m, const struct wavy_sheet *s)
{
    return maker_numbers(m, s->positions, 12 * s->vertex_count, FLOAT, s->vertex_count, "VEC3");
}

static int indices(struct model_maker *m, const struct wavy_sheet *s)
{
    return maker_numbers(m, s->indices, 4 * s->index_count, UINT, s->index_count, "SCALAR");
}

static int normals(struct model_maker *m, const struct wavy_sheet *s)
{
    return maker_numbers(m, s->normals, 12 * s->vertex_count, FLOAT, s->vertex_count, "VEC3");
}

static int texcoords(struct model_maker *m, const struct wavy_sheet *s)
{
    return maker_numbers(m, s->texcoords, 8 * s->vertex_count, FLOAT, s->vertex_count, "VEC2");
}

static json_t *plain_primitive(struct model_maker *m, const struct wavy_sheet *s)
{
    return json_pack("{s:{s:i},s:i}", "attributes", "POSITION", positions(m, s), "indices", indices(m, s));
}

static void finish(struct model_maker *m, struct seed *seed)
{
    seed->bytes = maker_glb(m, &seed->size);
    maker_finish(m);
}

/* --- encodings ----------------------------------------------------------------------------------------------------------- */

static void data_uri(struct model_maker *m, const struct wavy_sheet *s, struct seed *seed)
{
    maker_node(m, "sheet", maker_mesh(m, plain_primitive(m, s)), NULL);
    seed->bytes = maker_gltf(m, &seed->size);
    maker_finish(m);
}

static void every_attribute(struct model_maker *m, const struct wavy_sheet *s, struct seed *seed)
{
    int colors = maker_numbers(m, s->colors, 4 * s->vertex_count, UBYTE, s->vertex_count, "VEC4");
    json_object_set_new(maker_get(m, "accessors", colors), "normalized", json_true());
    json_t *primitive = json_pack("{s:{s:i,s:i,s:i,s:i},s:i}", "attributes", "POSITION", positions(m, s), "NORMAL", normals(m, s),
                                  "TEXCOORD_0", texcoords(m, s), "COLOR_0", colors, "indices", indices(m, s));
    maker_node(m, "sheet", maker_mesh(m, primitive), NULL);
    finish(m, seed);
}

static void indices16(struct model_maker *m, const struct wavy_sheet *s, struct seed *seed)
{
    uint16_t *out = mem_array(s->index_count, sizeof(*out));
    for (uint32_t i = 0; i < s->index_count; i++)
        out[i] = (uint16_t)s->indices[i];
    int list = maker_numbers(m, out, 2 * s->index_count, USHORT, s->index_count, "SCALAR");
    mem_free(out);
    maker_node(m, "sheet", maker_mesh(m, json_pack("{s:{s:i},s:i}", "attributes", "POSITION", positions(m, s), "indices", list)), NULL);
    finish(m, seed);
}

/* Encodes each row of squares as a triangle strip; each strip is a primitive, and all primitives share the vertices. */
static void strips(struct model_maker *m, const struct wavy_sheet *s, struct seed *seed)
{
    int at = positions(m, s), mesh = maker_mesh(m, json_null());
    json_t *primitives = json_object_get(maker_get(m, "meshes", mesh), "primitives");
    json_array_clear(primitives);
    uint32_t *strip = mem_array(2 * (s->across + 1), sizeof(*strip));
    for (uint32_t y = 0; y < s->up; y++) {
        for (uint32_t x = 0; x <= s->across; x++) {
            strip[2 * x] = (y + 1) * (s->across + 1) + x;
            strip[2 * x + 1] = y * (s->across + 1) + x;
        }
        int list = maker_numbers(m, strip, 8 * (s->across + 1), UINT, 2 * (s->across + 1), "SCALAR");
        json_array_append_new(primitives, json_pack("{s:{s:i},s:i,s:i}", "attributes", "POSITION", at, "indices", list, "mode", 5));
    }
    mem_free(strip);
    maker_node(m, "sheet", mesh, NULL);
    finish(m, seed);
}

/* Encodes each square as a triangle fan of four vertices; all fans share one index accessor. Also adds lines and points, which
   the loader must ignore. */
static void fans(struct model_maker *m, const struct wavy_sheet *s, struct seed *seed)
{
    int mesh = maker_mesh(m, json_null()), list = maker_numbers(m, (uint8_t[4]){ 0, 1, 2, 3 }, 4, UBYTE, 4, "SCALAR");
    json_t *primitives = json_object_get(maker_get(m, "meshes", mesh), "primitives");
    json_array_clear(primitives);
    for (uint32_t square = 0; square < s->index_count / 6; square++) {
        const uint32_t *i = s->indices + 6 * square;
        float four[4][3];
        for (int c = 0; c < 3; c++) {
            memcpy(four[c], s->positions[i[c]], sizeof(four[c]));
            memcpy(four[3], s->positions[i[5]], sizeof(four[3]));
        }
        int at = maker_numbers(m, four, sizeof(four), FLOAT, 4, "VEC3");
        json_array_append_new(primitives, json_pack("{s:{s:i},s:i,s:i}", "attributes", "POSITION", at, "indices", list, "mode", 6));
    }
    json_array_append_new(primitives, json_pack("{s:{s:i},s:i}", "attributes", "POSITION", positions(m, s), "mode", 1));
    json_array_append_new(primitives, json_pack("{s:{s:i},s:i}", "attributes", "POSITION", 1, "mode", 0));
    maker_node(m, "sheet", mesh, NULL);
    finish(m, seed);
}

/* Encodes three vertices per triangle, without indices; positions and other attributes are interleaved in one buffer view. */
static void soup(struct model_maker *m, const struct wavy_sheet *s, struct seed *seed)
{
    float(*corners)[6] = mem_array(s->index_count, sizeof(*corners));
    for (uint32_t i = 0; i < s->index_count; i++) {
        memcpy(corners[i], s->positions[s->indices[i]], 12);
        memcpy(corners[i] + 3, s->normals[s->indices[i]], 12);
    }
    int view = maker_view(m, corners, 24 * s->index_count, 24);
    int at = maker_accessor(m, view, FLOAT, s->index_count, "VEC3"), up = maker_accessor(m, view, FLOAT, s->index_count, "VEC3");
    json_object_set_new(maker_get(m, "accessors", up), "byteOffset", json_integer(12));
    mem_free(corners);
    maker_node(m, "sheet", maker_mesh(m, json_pack("{s:{s:i,s:i}}", "attributes", "POSITION", at, "NORMAL", up)), NULL);
    finish(m, seed);
}

/* Encodes positions as zeros, all of which a sparse accessor replaces by the real positions. */
static void sparse(struct model_maker *m, const struct wavy_sheet *s, struct seed *seed)
{
    uint32_t *all = mem_array(s->vertex_count, sizeof(*all));
    for (uint32_t v = 0; v < s->vertex_count; v++)
        all[v] = v;
    int places = maker_view(m, all, 4 * s->vertex_count, 0), values = maker_view(m, s->positions, 12 * s->vertex_count, 0);
    int at = maker_accessor(m, -1, FLOAT, s->vertex_count, "VEC3");
    json_object_set_new(maker_get(m, "accessors", at), "sparse",
                        json_pack("{s:i,s:{s:i,s:i},s:{s:i}}", "count", (int)s->vertex_count, "indices", "bufferView", places,
                                  "componentType", UINT, "values", "bufferView", values));
    mem_free(all);
    maker_node(m, "sheet", maker_mesh(m, json_pack("{s:{s:i},s:i}", "attributes", "POSITION", at, "indices", indices(m, s))), NULL);
    finish(m, seed);
}

/* Encodes positions as 16-bit integers, which the node scales; normals with 8 bits, and texture coordinates with 16 bits. */
static void quantized(struct model_maker *m, const struct wavy_sheet *s, struct seed *seed)
{
    int16_t(*at)[4] = mem_array(s->vertex_count, sizeof(*at));
    int8_t(*up)[4] = mem_array(s->vertex_count, sizeof(*up));
    uint16_t(*uv)[2] = mem_array(s->vertex_count, sizeof(*uv));
    for (uint32_t v = 0; v < s->vertex_count; v++) {
        for (int i = 0; i < 3; i++) {
            at[v][i] = (int16_t)lrintf(s->positions[v][i] / 2 * 32767);
            up[v][i] = (int8_t)lrintf(s->normals[v][i] * 127);
        }
        for (int i = 0; i < 2; i++)
            uv[v][i] = (uint16_t)lrintf(s->texcoords[v][i] * 65535);
    }
    int a = maker_accessor(m, maker_view(m, at, 8 * s->vertex_count, 8), SHORT, s->vertex_count, "VEC3");
    int n = maker_accessor(m, maker_view(m, up, 4 * s->vertex_count, 4), BYTE, s->vertex_count, "VEC3");
    int t = maker_accessor(m, maker_view(m, uv, 4 * s->vertex_count, 4), USHORT, s->vertex_count, "VEC2");
    for (int i = a; i <= t; i++)
        json_object_set_new(maker_get(m, "accessors", i), "normalized", json_true());
    mem_free(at);
    mem_free(up);
    mem_free(uv);
    maker_require(m, "KHR_mesh_quantization");
    json_t *primitive =
        json_pack("{s:{s:i,s:i,s:i},s:i}", "attributes", "POSITION", a, "NORMAL", n, "TEXCOORD_0", t, "indices", indices(m, s));
    maker_node(m, "sheet", maker_mesh(m, primitive), json_pack("{s:[i,i,i]}", "scale", 2, 2, 2));
    finish(m, seed);
}

/* --- meshopt ------------------------------------------------------------------------------------------------------------- */

/* Appends a buffer view whose data exists only in compressed form, in buffer 0. Buffer 1 has no data; it only states the
   uncompressed size. Returns the index of the view. */
static int packed_view(struct model_maker *m, const void *bytes, size_t count, size_t stride, const char *mode, const char *filter)
{
    bool list = strcmp(mode, "TRIANGLES") == 0, sequence = strcmp(mode, "INDICES") == 0;
    size_t room = list       ? meshopt_encodeIndexBufferBound(count, count)
                  : sequence ? meshopt_encodeIndexSequenceBound(count, count)
                             : meshopt_encodeVertexBufferBound(count, stride);
    unsigned char *out = mem_array(room, 1);
    size_t size = list       ? meshopt_encodeIndexBuffer(out, room, bytes, count)
                  : sequence ? meshopt_encodeIndexSequence(out, room, bytes, count)
                             : meshopt_encodeVertexBuffer(out, room, bytes, count, stride);
    int view = maker_view(m, out, size, list || sequence ? 0 : (int)stride);
    json_t *json = maker_get(m, "bufferViews", view), *offset = json_incref(json_object_get(json, "byteOffset"));
    mem_free(out);
    if (!json_object_get(m->root, "buffers")) {
        maker_add(m, "buffers", json_object());
        maker_add(m, "buffers",
                  json_pack("{s:i,s:{s:{s:b}}}", "byteLength", 1 << 24, "extensions", "EXT_meshopt_compression", "fallback", 1));
        maker_require(m, "EXT_meshopt_compression");
    }
    json_object_update_new(json, json_pack("{s:i,s:i,s:I,s:{s:{s:i,s:o,s:I,s:I,s:I,s:s,s:s}}}", "buffer", 1, "byteOffset", 0, "byteLength",
                                           (json_int_t)(count * stride), "extensions", "EXT_meshopt_compression", "buffer", 0, "byteOffset",
                                           offset, "byteLength", (json_int_t)size, "byteStride", (json_int_t)stride, "count",
                                           (json_int_t)count, "mode", mode, "filter", filter));
    return view;
}

static void meshopt(struct model_maker *m, const struct wavy_sheet *s, struct seed *seed)
{
    int a = maker_accessor(m, packed_view(m, s->positions, s->vertex_count, 12, "ATTRIBUTES", "NONE"), FLOAT, s->vertex_count, "VEC3");
    int i = maker_accessor(m, packed_view(m, s->indices, s->index_count, 4, "TRIANGLES", "NONE"), UINT, s->index_count, "SCALAR");
    maker_node(m, "sheet", maker_mesh(m, json_pack("{s:{s:i},s:i}", "attributes", "POSITION", a, "indices", i)), NULL);
    finish(m, seed);
}

static void meshopt_filters(struct model_maker *m, const struct wavy_sheet *s, struct seed *seed)
{
    float(*up)[4] = mem_array(s->vertex_count, sizeof(*up));
    uint8_t *oct = mem_array(s->vertex_count, 8), *exponential = mem_array(s->vertex_count, 12);
    for (uint32_t v = 0; v < s->vertex_count; v++)
        memcpy(up[v], s->normals[v], 12);
    meshopt_encodeFilterOct(oct, s->vertex_count, 8, 12, up[0]);
    meshopt_encodeFilterExp(exponential, s->vertex_count, 12, 18, s->positions[0]);
    int a =
        maker_accessor(m, packed_view(m, exponential, s->vertex_count, 12, "ATTRIBUTES", "EXPONENTIAL"), FLOAT, s->vertex_count, "VEC3");
    int n = maker_accessor(m, packed_view(m, oct, s->vertex_count, 8, "ATTRIBUTES", "OCTAHEDRAL"), SHORT, s->vertex_count, "VEC3");
    int i = maker_accessor(m, packed_view(m, s->indices, s->index_count, 4, "INDICES", "NONE"), UINT, s->index_count, "SCALAR");
    json_object_set_new(maker_get(m, "accessors", n), "normalized", json_true());
    mem_free(up);
    mem_free(oct);
    mem_free(exponential);
    maker_require(m, "KHR_mesh_quantization");
    maker_node(m, "sheet", maker_mesh(m, json_pack("{s:{s:i,s:i},s:i}", "attributes", "POSITION", a, "NORMAL", n, "indices", i)), NULL);
    finish(m, seed);
}

/* Places the mesh twice with EXT_mesh_gpu_instancing; the instances' rotations are quaternions encoded with meshopt's filter,
   and one turns the sheet upside down. */
static void meshopt_instances(struct model_maker *m, const struct wavy_sheet *s, struct seed *seed)
{
    const float turns[2][4] = { { 0, 0, 0, 1 }, { 1, 0, 0, 0 } }, places[2][3] = { { 0, 0, 0 }, { 0, 0, 5 } };
    uint8_t filtered[2][8];
    meshopt_encodeFilterQuat(filtered, 2, 8, 16, turns[0]);
    int mesh = maker_mesh(m, plain_primitive(m, s));
    int r = maker_accessor(m, packed_view(m, filtered, 2, 8, "ATTRIBUTES", "QUATERNION"), SHORT, 2, "VEC4");
    int t = maker_numbers(m, places, sizeof(places), FLOAT, 2, "VEC3");
    json_object_set_new(maker_get(m, "accessors", r), "normalized", json_true());
    maker_require(m, "EXT_mesh_gpu_instancing");
    maker_node(m, "sheet", mesh,
               json_pack("{s:{s:{s:{s:i,s:i}}}}", "extensions", "EXT_mesh_gpu_instancing", "attributes", "TRANSLATION", t, "ROTATION", r));
    seed->triangles *= 2;
    finish(m, seed);
}

/* --- Draco --------------------------------------------------------------------------------------------------------------- */

static void draco(struct model_maker *m, const struct wavy_sheet *s, struct seed *seed, bool sequential, int bits)
{
    size_t size;
    uint32_t vertices;
    struct draco_input input = { s->positions, s->normals, s->colors, s->indices, s->vertex_count, s->index_count, bits, sequential };
    unsigned char *bytes = draco_encode(&input, &size, &vertices);
    int view = maker_view(m, bytes, size, 0);
    mem_free(bytes);
    int a = maker_accessor(m, -1, FLOAT, vertices, "VEC3"), n = maker_accessor(m, -1, FLOAT, vertices, "VEC3");
    int c = maker_accessor(m, -1, UBYTE, vertices, "VEC4"), i = maker_accessor(m, -1, UINT, s->index_count, "SCALAR");
    json_object_set_new(maker_get(m, "accessors", c), "normalized", json_true());
    maker_require(m, "KHR_draco_mesh_compression");
    json_t *primitive =
        json_pack("{s:{s:i,s:i,s:i},s:i,s:{s:{s:i,s:{s:i,s:i,s:i}}}}", "attributes", "POSITION", a, "NORMAL", n, "COLOR_0", c, "indices", i,
                  "extensions", "KHR_draco_mesh_compression", "bufferView", view, "attributes", "POSITION", 0, "NORMAL", 1, "COLOR_0", 2);
    maker_node(m, "sheet", maker_mesh(m, primitive), NULL);
    finish(m, seed);
}

static void draco_edgebreaker(struct model_maker *m, const struct wavy_sheet *s, struct seed *seed)
{
    draco(m, s, seed, false, 14);
}

static void draco_sequential(struct model_maker *m, const struct wavy_sheet *s, struct seed *seed)
{
    draco(m, s, seed, true, 0);
}

/* --- trees, instances, materials ----------------------------------------------------------------------------------------- */

/* Uses one mesh in several nodes: unchanged, mirrored, deep in a tree of nodes, and positioned by a matrix. */
static void tree(struct model_maker *m, const struct wavy_sheet *s, struct seed *seed)
{
    int mesh = maker_mesh(m, plain_primitive(m, s));
    maker_node(m, "sheet", mesh, NULL);
    maker_node(m, "mirrored", mesh, json_pack("{s:[i,i,i],s:[i,i,i]}", "scale", -1, 1, 1, "translation", 0, 3, 0));
    maker_node(m, "far", mesh,
               json_pack("{s:[i,i,i,i,i,i,i,i,i,i,i,i,f,f,f,i]}", "matrix", 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5e5, 6e6, 0.25, 1));
    int twig = maker_node(m, "twig", mesh, json_pack("{s:[f,i,i,f]}", "rotation", 0.70710678118654752, 0, 0, 0.70710678118654752));
    int branch = maker_node(m, "branch", -1, json_pack("{s:[i],s:[i,i,i]}", "children", twig, "translation", 0, 0, 9));
    maker_add(m, "scenes", json_pack("{s:[i,i,i,i]}", "nodes", 0, 1, 2, branch));
    seed->triangles *= 4;
    finish(m, seed);
}

static void instances(struct model_maker *m, const struct wavy_sheet *s, struct seed *seed)
{
    const float places[3][3] = { { 0, 0, 0 }, { 0, 2, 0 }, { 0, 4, 0 } }, sizes[3][3] = { { 1, 1, 1 }, { 1, 1, -1 }, { 2, 2, 2 } };
    int mesh = maker_mesh(m, plain_primitive(m, s));
    int t = maker_numbers(m, places, sizeof(places), FLOAT, 3, "VEC3"), z = maker_numbers(m, sizes, sizeof(sizes), FLOAT, 3, "VEC3");
    maker_require(m, "EXT_mesh_gpu_instancing");
    maker_node(m, "sheet", mesh,
               json_pack("{s:{s:{s:{s:i,s:i}}}}", "extensions", "EXT_mesh_gpu_instancing", "attributes", "TRANSLATION", t, "SCALE", z));
    seed->triangles *= 3;
    finish(m, seed);
}

/* PNG file of 2 x 2 pixels: red and green in the first row, blue and white in the second. */
static const unsigned char png[] = {
    137, 80,  78,  71, 13,  10,  26,  10,  0,   0,   0,   13,  73,  72, 68, 82, 0,   0,   0,  2,   0,   0,   0,   2,  8,
    2,   0,   0,   0,  253, 212, 154, 115, 0,   0,   0,   18,  73,  68, 65, 84, 120, 218, 99, 248, 207, 192, 192, 0,  194,
    12,  255, 129, 0,  0,   31,  238, 5,   251, 241, 171, 186, 119, 0,  0,  0,  0,   73,  69, 78,  68,  174, 66,  96, 130,
};

static int textured_mesh(struct model_maker *m, const struct wavy_sheet *s, json_t *material)
{
    json_t *primitive = json_pack("{s:{s:i,s:i},s:i,s:i}", "attributes", "POSITION", positions(m, s), "TEXCOORD_0", texcoords(m, s),
                                  "indices", indices(m, s), "material", maker_add(m, "materials", material));
    return maker_mesh(m, primitive);
}

static void textured(struct model_maker *m, const struct wavy_sheet *s, struct seed *seed)
{
    int image = maker_add(m, "images", json_pack("{s:i,s:s}", "bufferView", maker_view(m, png, sizeof(png), 0), "mimeType", "image/png"));
    int sampler = maker_add(m, "samplers", json_pack("{s:i,s:i}", "wrapS", 33071, "wrapT", 33071));
    int texture = maker_add(m, "textures", json_pack("{s:i,s:i}", "source", image, "sampler", sampler));
    maker_require(m, "KHR_texture_transform");
    json_t *material = json_pack("{s:s,s:{s:{s:i,s:{s:{s:[f,f],s:f,s:[f,f]}}},s:[f,f,f,f]},s:b}", "name", "paint", "pbrMetallicRoughness",
                                 "baseColorTexture", "index", texture, "extensions", "KHR_texture_transform", "offset", 0.25, 0.5,
                                 "rotation", 0.5, "scale", 2.0, 3.0, "baseColorFactor", 1.0, 0.5, 0.25, 1.0, "doubleSided", 1);
    maker_node(m, "sheet", textured_mesh(m, s, material), NULL);
    finish(m, seed);
}

static void textured_by_uri(struct model_maker *m, const struct wavy_sheet *s, struct seed *seed)
{
    char *uri = maker_data_uri("image/png", png, sizeof(png));
    int texture = maker_add(m, "textures", json_pack("{s:i}", "source", maker_add(m, "images", json_pack("{s:s}", "uri", uri))));
    json_t *material =
        json_pack("{s:{s:i},s:s,s:[f,f,f]}", "emissiveTexture", "index", texture, "alphaMode", "BLEND", "emissiveFactor", 1.0, 1.0, 1.0);
    mem_free(uri);
    maker_node(m, "sheet", textured_mesh(m, s, material), NULL);
    finish(m, seed);
}

/* Gives the material textures that use both sets of texture coordinates; the emissive texture also scales the second set by a
   transform of its own. */
static void textured_twice(struct model_maker *m, const struct wavy_sheet *s, struct seed *seed)
{
    int image = maker_add(m, "images", json_pack("{s:i,s:s}", "bufferView", maker_view(m, png, sizeof(png), 0), "mimeType", "image/png"));
    int texture = maker_add(m, "textures", json_pack("{s:i}", "source", image));
    json_t *material = json_pack("{s:{s:{s:i}},s:{s:i,s:i},s:{s:i,s:{s:{s:i,s:[f,f]}}}}", "pbrMetallicRoughness", "baseColorTexture",
                                 "index", texture, "occlusionTexture", "index", texture, "texCoord", 1, "emissiveTexture", "index", texture,
                                 "extensions", "KHR_texture_transform", "texCoord", 1, "scale", 2.0, 2.0);
    int mesh = textured_mesh(m, s, material);
    json_t *attributes = json_object_get(json_array_get(json_object_get(maker_get(m, "meshes", mesh), "primitives"), 0), "attributes");
    json_object_set_new(attributes, "TEXCOORD_1", json_integer(texcoords(m, s)));
    maker_node(m, "sheet", mesh, NULL);
    finish(m, seed);
}

static void external(struct model_maker *m, const struct wavy_sheet *s, struct seed *seed)
{
    maker_node(m, "sheet", maker_mesh(m, plain_primitive(m, s)), NULL);
    maker_add(m, "images", json_pack("{s:s}", "uri", "a%20picture.png"));
    finish(m, seed);
}

void seed_make(struct seed *seed, int number, const struct wavy_sheet *sheet)
{
    static const struct {
        const char *name;
        void (*make)(struct model_maker *, const struct wavy_sheet *, struct seed *);
        double tolerance_m;
    } seeds[SEED_COUNT] = {
        { "data_uri.gltf", data_uri, 0 },
        { "every_attribute.glb", every_attribute, 0 },
        { "indices16.glb", indices16, 0 },
        { "strips.glb", strips, 0 },
        { "fans.glb", fans, 0 },
        { "soup.glb", soup, 0 },
        { "sparse.glb", sparse, 0 },
        { "quantized.glb", quantized, 4e-5 },
        { "meshopt.glb", meshopt, 0 },
        { "meshopt_filters.glb", meshopt_filters, 2e-5 },
        { "meshopt_instances.glb", meshopt_instances, 0 },
        { "draco_edgebreaker.glb", draco_edgebreaker, 2e-4 },
        { "draco_sequential.glb", draco_sequential, 0 },
        { "tree.glb", tree, 0 },
        { "instances.glb", instances, 0 },
        { "textured.glb", textured, 0 },
        { "textured_by_uri.glb", textured_by_uri, 0 },
        { "external.glb", external, 0 },
        { "textured_twice.glb", textured_twice, 0 },
    };
    struct model_maker maker;
    maker_init(&maker);
    *seed = (struct seed){ .name = seeds[number].name, .triangles = sheet->index_count / 3, .tolerance_m = seeds[number].tolerance_m };
    seeds[number].make(&maker, sheet, seed);
}
