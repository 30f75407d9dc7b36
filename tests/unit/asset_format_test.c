/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Asset files: the reader gives what was passed to the writer, and refuses every kind of damage with a reason. */
#include "protocol/asset_distance.h"
#include "protocol/asset_format.h"
#include "protocol/distance_pack.h"

#include "tests/support/test.h"
#include <xxhash.h>

/* The asset of the tests: a level with two triangles on four vertices, and a coarser level with one triangle on the first three
   vertices; one texture and two sensors. */
static const float positions[4][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 1, 1, 0.5f } };
static const float normals[4][3] = { { 0, 0, 1 }, { 0, 0, 1 }, { 0, 0, 1 }, { 0, 0, 1 } };
static const float texcoords[4][2] = { { 0, 0 }, { 1, 0 }, { 0, 1 }, { 1, 1 } };
static const float second_texcoords[4][2] = { { 0, 0.5f }, { 0.25f, 0.5f }, { 0, 0.75f }, { 2, 1 } };
static const uint8_t colors[4][4] = { { 255, 0, 0, 255 } };
static const uint32_t indices[9] = { 0, 1, 2, 1, 3, 2, 0, 1, 2 };
static const struct asset_primitive primitives[2] = { { .index_count = 6, .name = 1 }, { .first_index = 6, .index_count = 3, .name = 1 } };
static const struct asset_level levels[2] = { { .primitive_count = 1, .vertex_count = 4 },
                                              { .first_primitive = 1, .primitive_count = 1, .vertex_count = 3, .error_m = 0.5f } };
static const struct asset_cluster clusters[3] = {
    { .index_count = 3, .high_m = { 1, 1, 0 }, .cone_axis = { 0, 0, 1 } },
    { .first_index = 3, .index_count = 3, .high_m = { 1, 1, 0.5f }, .cone_cutoff = 1 },
    { .first_index = 6, .index_count = 3, .high_m = { 1, 1, 0 }, .cone_axis = { 0, 0.6f, 0.8f }, .cone_cutoff = 0.6f },
};
static const struct asset_material materials[1] = { {
    .base_color = { 0.5f, 0.5f, 0.5f, 1 },
    .roughness = 0.5f,
    .normal_scale = 1,
    .occlusion_strength = 1,
    .alpha_cutoff = 0.5f,
    .metallic_roughness_texture = ASSET_NO_TEXTURE,
    .normal_texture = ASSET_NO_TEXTURE,
    .emissive_texture = ASSET_NO_TEXTURE,
    .second = 1 << 3, /* its occlusion's */
} };
static const struct asset_texture textures[1] = { { .width_px = 2, .height_px = 1, .srgb = 1 } };
static const uint8_t texels[8] = { 1, 2, 3, 4, 5, 6, 7, 8 };
static const struct asset_sensor sensors[2] = { { .position_m = { 0, 0, 0.1f }, .surface_distance_m = 0.1f }, { .nearest_vertex = 3 } };
static const float geodesic[8] = { 0, 1, 1, 2, 2, 1, INFINITY, 0 };

static const struct asset_parts good = {
    .key = 0x1234,
    .origin_m = { 1e6, 2e6, 3 },
    .positions_m = positions,
    .normals = normals,
    .texcoords = texcoords,
    .second_texcoords = second_texcoords,
    .colors = colors,
    .indices = indices,
    .primitives = primitives,
    .levels = levels,
    .clusters = clusters,
    .materials = materials,
    .textures = textures,
    .texels = texels,
    .sensors = sensors,
    .geodesic_m = geodesic,
    .names = "\0part",
    .vertex_count = 4,
    .index_count = 9,
    .primitive_count = 2,
    .level_count = 2,
    .material_count = 1,
    .texture_count = 1,
    .sensor_count = 2,
    .cluster_count = 3,
    .texel_bytes = 8,
    .name_bytes = 6,
};

struct asset_bytes {
    char *bytes;
    size_t size;
    struct asset_header *header;
};

static struct asset_bytes build(const struct asset_parts *parts)
{
    struct asset_bytes f;
    f.bytes = asset_build(parts, &f.size);
    assert_non_null(f.bytes);
    f.header = (struct asset_header *)f.bytes;
    return f;
}

/* Makes the file's checksum right again after a change, computed as the format's documentation says. */
static void seal(struct asset_bytes *f)
{
    f->header->checksum = 0;
    f->header->checksum = XXH3_64bits(f->bytes, f->size);
}

static void *part(const struct asset_bytes *f, enum asset_section section)
{
    return f->bytes + f->header->sections[section].offset;
}

static void refused(struct asset_bytes *f, size_t size, const char *reason)
{
    struct asset_view view;
    char why[200] = "";
    if (asset_view_init(&view, f->bytes, size, why))
        fail_msg("accepted; expected to be refused for: %s", reason);
    if (!strstr(why, reason))
        fail_msg("refused for '%s', expected '%s'", why, reason);
    free(f->bytes);
}

static void refused_sealed(struct asset_bytes *f, const char *reason)
{
    seal(f);
    refused(f, f->size, reason);
}

/* Changes one element of a valid file's section, or (REFUSED_HEADER) its header, corrects the checksum, and asserts that the
   reader refuses the file with this reason. */
#define REFUSED(section, type, change, reason)                                                                                             \
    do {                                                                                                                                   \
        struct asset_bytes changed = build(&good);                                                                                         \
        ((type *)part(&changed, section))change;                                                                                           \
        refused_sealed(&changed, reason);                                                                                                  \
    } while (0)
#define REFUSED_HEADER(change, reason)                                                                                                     \
    do {                                                                                                                                   \
        struct asset_bytes changed = build(&good);                                                                                         \
        changed.header->change;                                                                                                            \
        refused_sealed(&changed, reason);                                                                                                  \
    } while (0)

TEST(what_is_built_is_read_back)
{
    struct asset_bytes f = build(&good);
    struct asset_view v;
    char why[200] = "";
    if (!asset_view_init(&v, f.bytes, f.size, why))
        fail_msg("%s", why);
    assert_int_equal(f.size % ASSET_ALIGN, 0);
    assert_int_equal(v.header->key, 0x1234);
    assert_true(v.header->origin_m[1] == 2e6);
    assert_true(v.header->bounds_max_m[2] == 0.5f && v.header->bounds_min_m[0] == 0);
    assert_memory_equal(v.positions_m, positions, sizeof(positions));
    assert_memory_equal(v.normals, normals, sizeof(normals));
    assert_memory_equal(v.texcoords, texcoords, sizeof(texcoords));
    assert_memory_equal(v.second_texcoords, second_texcoords, sizeof(second_texcoords));
    assert_memory_equal(v.colors, colors, sizeof(colors));
    assert_memory_equal(v.indices, indices, sizeof(indices));
    assert_memory_equal(v.levels, levels, sizeof(levels));
    assert_memory_equal(v.clusters, clusters, sizeof(clusters));
    assert_memory_equal(v.sensors, sensors, sizeof(sensors));
    for (size_t i = 0; i < 8; i++)
        assert_true(asset_distance_m(&v, i / 4, i % 4) == geodesic[i]);
    assert_memory_equal(v.texels, texels, sizeof(texels));
    assert_string_equal(v.names + v.primitives[1].name, "part");
    free(f.bytes);
}

TEST(the_smallest_asset_is_good)
{
    struct asset_material plain = materials[0];
    struct asset_primitive one = { .index_count = 6 };
    plain.base_color_texture = plain.occlusion_texture = ASSET_NO_TEXTURE;
    plain.second = 0;
    struct asset_parts small = { .positions_m = positions,
                                 .normals = normals,
                                 .indices = indices,
                                 .primitives = &one,
                                 .materials = &plain,
                                 .vertex_count = 4,
                                 .index_count = 6,
                                 .primitive_count = 1,
                                 .material_count = 1 };
    struct asset_bytes f = build(&small);
    struct asset_view v;
    char why[200] = "";
    if (!asset_view_init(&v, f.bytes, f.size, why))
        fail_msg("%s", why);
    assert_int_equal(v.header->level_count, 1);
    assert_int_equal(v.levels[0].vertex_count, 4);
    assert_null(v.texcoords);
    assert_null(v.second_texcoords);
    assert_null(v.colors);
    assert_string_equal(v.names, "");
    assert_int_equal(v.header->cluster_count, 1);
    assert_int_equal(v.clusters[0].index_count, 6);
    free(f.bytes);
}

TEST(the_layout_is_pinned)
{
    assert_int_equal(sizeof(struct asset_header), 360);
    assert_int_equal(offsetof(struct asset_header, checksum), 24);
    assert_int_equal(offsetof(struct asset_header, key), 32);
    assert_int_equal(offsetof(struct asset_header, bounds_min_m), 64);
    assert_int_equal(offsetof(struct asset_header, vertex_count), 88);
    assert_int_equal(offsetof(struct asset_header, sections), 120);
    assert_int_equal(sizeof(struct asset_material), 84);
    assert_int_equal(offsetof(struct asset_material, second), 80);
    assert_int_equal(offsetof(struct asset_material, base_color_texture), 48);
    assert_int_equal(sizeof(struct asset_level), 20);
    assert_int_equal(sizeof(struct asset_cluster), 48);
    assert_int_equal(sizeof(struct asset_texture), 24);
    assert_int_equal(sizeof(struct asset_sensor), 40);
    assert_int_equal(ASSET_SECTION_COUNT, 15);
    struct asset_bytes f = build(&good);
    assert_memory_equal(f.bytes, "PLCASSET\6\0\0\0\x68\1\0\0", 16);
    /* Hash of the written file without its header. If it changes, the format has changed, and the version of the format must be
       raised. */
    assert_int_equal(XXH3_64bits(f.bytes + 360, f.size - 360), 0x111241323613397full);
    free(f.bytes);
}

TEST(truncated_or_foreign_files_are_refused)
{
    struct asset_view view;
    char why[200] = "";
    assert_false(asset_view_init(&view, NULL, 0, why));
    for (size_t cut = 1; cut < 1000; cut += 37) {
        struct asset_bytes f = build(&good);
        refused(&f, cut < f.size ? f.size - cut : 0, "");
    }
    struct asset_bytes f = build(&good);
    refused(&f, f.size - 64, "truncated: the file has ");
    f = build(&good);
    refused(&f, 100, "truncated to 100 bytes, but the header alone has 360");
    f = build(&good);
    f.header->file_bytes -= 64;
    refused(&f, f.size, "too long");
    f = build(&good);
    memcpy(f.bytes, "glTF", 4);
    refused_sealed(&f, "does not begin with");
    REFUSED_HEADER(version = 5, "has format version 5, but this program reads version 6");
    REFUSED_HEADER(header_bytes = 320, "the header has 320 bytes");
    f = build(&good);
    assert_false(asset_view_init(&view, f.bytes + 8, f.size - 8, why));
    assert_non_null(strstr(why, "aligned"));
    free(f.bytes);
}

TEST(every_flipped_bit_is_noticed)
{
    struct asset_bytes f = build(&good);
    struct asset_view view;
    char why[200];
    for (size_t i = 0; i < f.size; i++) {
        f.bytes[i] ^= 0x10;
        if (asset_view_init(&view, f.bytes, f.size, why))
            fail_msg("byte %zu changed and not noticed", i);
        f.bytes[i] ^= 0x10;
    }
    assert_true(asset_view_init(&view, f.bytes, f.size, why));
    f.bytes[f.size - 1] ^= 1;
    refused(&f, f.size, "its checksum is ");
}

TEST(sections_out_of_bounds_are_refused)
{
    for (int i = 0; i < ASSET_SECTION_COUNT; i++) {
        REFUSED_HEADER(sections[i].offset = changed.size + 64, "outside the file");
        REFUSED_HEADER(sections[i].offset = UINT64_MAX - 63, "outside the file");
        REFUSED_HEADER(sections[i].bytes = UINT64_MAX, "outside the file");
        REFUSED_HEADER(sections[i].offset = 0, "overlap another section");
        REFUSED_HEADER(sections[i].offset += 4, "section");
    }
    REFUSED_HEADER(sections[ASSET_GEODESIC].bytes -= 4, "section `geodesic` has 1020 bytes, expected 1024");
    REFUSED_HEADER(sensor_count = UINT32_MAX, "section `sensors` has");
    REFUSED_HEADER(index_count = 8, "the number of indices, 8, is not a multiple of 3");
    REFUSED_HEADER(vertex_count = 0, "nothing to draw");
    REFUSED(ASSET_NAMES, char, [5] = 'x', "the last name does not end with a 0 byte");
}

TEST(wrong_vertices_are_refused)
{
    REFUSED(ASSET_POSITIONS, float, [7] = NAN, "vertex 2: the position is infinite or not a number");
    REFUSED(ASSET_POSITIONS, float, [7] = 9, "vertex 2: coordinate 9 m lies outside the asset's bounding box, 0..1 m");
    REFUSED(ASSET_NORMALS, float, [2] = NAN, "vertex 0: the normal");
    REFUSED(ASSET_NORMALS, float, [5] = 0, "vertex 1: the normal has length 0, expected 1");
    REFUSED(ASSET_TEXCOORDS, float, [6] = INFINITY, "vertex 3: a texture coordinate");
    REFUSED(ASSET_SECOND_TEXCOORDS, float, [3] = NAN, "vertex 1: a texture coordinate");
    REFUSED_HEADER(origin_m[1] = INFINITY, "origin");
    REFUSED_HEADER(bounds_min_m[1] = -INFINITY, "the asset's bounding box is infinite or has invalid numbers");
}

TEST(wrong_primitives_and_levels_are_refused)
{
    REFUSED(ASSET_INDICES, uint32_t, [4] = 4, "primitive 0: index 4 refers to vertex 4, but there are only 4 vertices");
    /* vertex 3 exists in the file, but does not belong to this level */
    REFUSED(ASSET_INDICES, uint32_t, [7] = 3, "primitive 1: index 7 refers to vertex 3, but there are only 3 vertices");
    REFUSED(ASSET_PRIMITIVES, struct asset_primitive, [1].first_index = UINT32_MAX - 2, "primitive 1: starts at index");
    REFUSED(ASSET_PRIMITIVES, struct asset_primitive, [1].index_count = 2,
            "primitive 1: starts at index 6 and has 2 indices, but the file has only 9");
    REFUSED(ASSET_PRIMITIVES, struct asset_primitive, [0].material = 1,
            "primitive 0: refers to material 1, but there are only 1 materials");
    REFUSED(ASSET_PRIMITIVES, struct asset_primitive, [0].name = 6, "primitive 0: its name at byte 6");
    REFUSED(ASSET_LEVELS, struct asset_level, [1].vertex_count = 5, "level of detail 1 uses the first 5 vertices, expected at most 4");
    REFUSED(ASSET_LEVELS, struct asset_level, [0].vertex_count = 3, "level of detail 0 uses the first 3 vertices, expected 4");
    REFUSED(ASSET_LEVELS, struct asset_level, [1].first_primitive = 0,
            "level of detail 1 starts at primitive 0 and has 1 primitives, expected a start at primitive 1 of 2");
    REFUSED(ASSET_LEVELS, struct asset_level, [1].primitive_count = UINT32_MAX, "level of detail 1 starts at primitive");
    REFUSED(ASSET_LEVELS, struct asset_level, [1].error_m = -1, "level of detail 1 deviates from the model by -1 m, expected at least 0 m");
    REFUSED(ASSET_LEVELS, struct asset_level, [0].added_count = 2,
            "level of detail 0 adds 2 vertices, but only 1 vertices belong to this level");
    struct asset_bytes f = build(&good);
    f.header->level_count = 1;
    f.header->sections[ASSET_LEVELS].bytes = sizeof(struct asset_level);
    refused_sealed(&f, "only 1 of 2 primitives belong to a level of detail");
}

TEST(wrong_clusters_are_refused)
{
    REFUSED(ASSET_CLUSTERS, struct asset_cluster, [1].first_index = 0,
            "cluster 1 of 3 has indices 0+3, outside the expected range 3..6 (primitive 0)");
    REFUSED(ASSET_CLUSTERS, struct asset_cluster, [1].index_count = 6, "cluster 1 of 3 has indices 3+6, outside the expected range 3..6");
    REFUSED(ASSET_CLUSTERS, struct asset_cluster, [0].index_count = 0, "cluster 0 of 3 has indices 0+0");
    REFUSED(ASSET_CLUSTERS, struct asset_cluster, [2].index_count = 2, "cluster 2 of 3 has indices 6+2");
    REFUSED(ASSET_CLUSTERS, struct asset_cluster, [1].high_m[2] = 0.4f,
            "cluster 1 of triangles: the vertex of index 4, at 0.5 m, lies outside the cluster's bounding box, 0..0.4 m");
    REFUSED(ASSET_CLUSTERS, struct asset_cluster, [2].low_m[0] = NAN,
            "cluster 2 of triangles: the bounding box or normal cone has invalid numbers");
    REFUSED(ASSET_CLUSTERS, struct asset_cluster, [2].cone_cutoff = 1.5f, "cutoff 1.5 is outside 0..1");
    REFUSED(ASSET_CLUSTERS, struct asset_cluster, [2].cone_cutoff = 0.5f,
            "cluster 2 of triangles: a triangle's normal lies outside the normal cone (0.8)");
    REFUSED(ASSET_CLUSTERS, struct asset_cluster, [0].cone_axis[2] = 2, "cluster 0 of triangles: the axis of the normal cone has length 2");
    struct asset_parts parts = good;
    parts.cluster_count = 2;
    struct asset_bytes f = build(&parts);
    refused_sealed(&f, "cluster 2 of 2");
    const struct asset_cluster more[4] = { clusters[0], clusters[1], clusters[2], clusters[2] };
    parts.clusters = more;
    parts.cluster_count = 4;
    f = build(&parts);
    refused_sealed(&f, "only 3 of 4 clusters belong to a primitive");
}

static float unit(uint32_t *seed)
{
    *seed = *seed * 1664525u + 1013904223u;
    return (float)(*seed >> 8) / 16777216.0f;
}

/* Reference for culling: returns whether all triangles of a cluster face away from the eye, computed for each triangle in
   double precision. */
static bool backs_only(const float (*p)[3], const uint32_t *v, uint32_t count, const float eye[3])
{
    for (uint32_t i = 0; i < count; i += 3) {
        double u[3], w[3], to[3], dot = 0;
        for (int a = 0; a < 3; a++) {
            u[a] = (double)p[v[i + 1]][a] - (double)p[v[i]][a];
            w[a] = (double)p[v[i + 2]][a] - (double)p[v[i]][a];
            to[a] = (double)p[v[i]][a] - (double)eye[a];
        }
        for (int a = 0; a < 3; a++)
            dot += to[a] * (u[(a + 1) % 3] * w[(a + 2) % 3] - u[(a + 2) % 3] * w[(a + 1) % 3]);
        if (dot < -1e-9)
            return false;
    }
    return true;
}

/* Clusters are random fans of triangles that face roughly upwards, seen from random eyes. Every cluster that is culled must
   face away completely, and most clusters that face away must be culled. */
TEST(turned_away_means_only_backs)
{
    uint32_t seed = 5, backs = 0, left_out = 0;
    for (int n = 0; n < 4000; n++) {
        float p[8][3], eye[3];
        uint32_t v[18];
        for (int i = 0; i < 8; i++) {
            double turn = i * acos(-1) / 3.5;
            p[i][0] = i ? (float)cos(turn) + 0.2f * unit(&seed) : 0;
            p[i][1] = i ? (float)sin(turn) + 0.2f * unit(&seed) : 0;
            p[i][2] = (unit(&seed) - 0.5f) * (n % 4) * 0.4f;
        }
        for (uint32_t i = 0; i < 6; i++) {
            v[3 * i] = 0;
            v[3 * i + 1] = 1 + i;
            v[3 * i + 2] = 2 + i;
        }
        for (int a = 0; a < 3; a++)
            eye[a] = 10 * (unit(&seed) - 0.5f);
        struct asset_cluster cluster = { .index_count = 18 };
        asset_cluster_measure(&cluster, (const float(*)[3])p, v);
        bool away = asset_cluster_turned_away(&cluster, eye), back = backs_only((const float(*)[3])p, v, 18, eye);
        if (away && !back)
            fail_msg("fan %d of seed 5: left out, but a front is seen", n);
        backs += back;
        left_out += away;
    }
    print_message("# %u of %u fans with only backs are left out (seed 5)\n", left_out, backs);
    assert_true(left_out > backs / 3);
}

TEST(wrong_materials_and_textures_are_refused)
{
    REFUSED(ASSET_MATERIALS, struct asset_material, ->normal_texture = 1, "material 0: refers to texture 1, but there are only 1 textures");
    REFUSED_HEADER(sections[ASSET_TEXCOORDS].bytes = 0, "material 0: the file has no coordinates for texture 0 (of 1 textures)");
    REFUSED_HEADER(sections[ASSET_SECOND_TEXCOORDS].bytes = 0, "material 0: the file has no coordinates for texture 0 (of 1 textures)");
    REFUSED_HEADER(sections[ASSET_SECOND_TEXCOORDS].bytes -= 8, "section `second texcoords` has 24 bytes, expected 32");
    REFUSED(ASSET_MATERIALS, struct asset_material, ->second |= 1,
            "material 0: unknown flags 0x9 for second texture coordinates (known: 0x1e)");
    REFUSED(ASSET_MATERIALS, struct asset_material, ->second |= 1 << 5,
            "material 0: unknown flags 0x28 for second texture coordinates (known: 0x1e)");
    REFUSED(ASSET_MATERIALS, struct asset_material, ->base_color[1] = NAN,
            "material 0: the colour, metallic, roughness or occlusion factor");
    REFUSED(ASSET_MATERIALS, struct asset_material, ->metallic = 1.5f, "material 0: the colour, metallic, roughness or occlusion factor");
    REFUSED(ASSET_MATERIALS, struct asset_material, ->emissive[2] = INFINITY,
            "material 0: the normal scale, emissive colour or alpha cutoff is infinite or not a number");
    REFUSED(ASSET_MATERIALS, struct asset_material, ->alpha = 3, "material 0: alpha mode 3");
    REFUSED(ASSET_TEXTURES, struct asset_texture, ->offset = 4, "texture 0: starts at byte 4 and has 8 bytes, but the section has only 8");
    REFUSED(ASSET_TEXTURES, struct asset_texture, ->width_px = 0, "texture 0 has 0 x 1 pixels");
    REFUSED(ASSET_TEXTURES, struct asset_texture, ->height_px = UINT32_MAX, "texture 0 has 2 x 4294967295 pixels");
    REFUSED(ASSET_TEXTURES, struct asset_texture, ->srgb = 2, "texture 0: srgb 2");
}

TEST(wrong_sensors_are_refused)
{
    REFUSED(ASSET_SENSORS, struct asset_sensor, [1].surface_m[0] = NAN,
            "sensor 1: its position or distance from the surface is infinite, negative or not a number");
    REFUSED(ASSET_SENSORS, struct asset_sensor, [1].surface_distance_m = -1, "sensor 1: its position");
    REFUSED(ASSET_SENSORS, struct asset_sensor, [1].nearest_vertex = 4,
            "sensor 1: its nearest vertex is 4, but the file has only 4 vertices");
}

/* Distances are stored as 16-bit codes. Each code must decode to a larger distance than the previous one, and each distance
   must get the nearest code. */
TEST(distances_have_16_bits)
{
    assert_true(asset_distance_of(0) == 0 && asset_distance_of(ASSET_DISTANCE_NONE) == INFINITY);
    assert_int_equal(asset_distance_code(INFINITY), ASSET_DISTANCE_NONE);
    assert_int_equal(asset_distance_code(NAN), ASSET_DISTANCE_NONE);
    assert_true(asset_distance_of(asset_distance_code(1e6f)) > 129e3f && asset_distance_of(asset_distance_code(1e6f)) < 131e3f);
    for (uint32_t code = 0; asset_distance_of((uint16_t)code) < ASSET_DISTANCE_MOST_M; code++) {
        float here_m = asset_distance_of((uint16_t)code), next_m = asset_distance_of((uint16_t)(code + 1)), between_m = next_m - here_m;
        assert_true(next_m > here_m && between_m <= fmaxf(here_m * 0x1p-11f, 0x1p-25f));
        assert_int_equal(asset_distance_code(here_m), code);
        assert_int_equal(asset_distance_code(here_m + 0.49f * between_m), code);
        if (next_m < ASSET_DISTANCE_MOST_M)
            assert_int_equal(asset_distance_code(here_m + 0.51f * between_m), code + 1);
    }
}

/* MANY: number of sensors; FAR: number of vertices; BLOCKS: number of blocks in which the distances of FAR vertices are stored
   */
enum { MANY = 70, FAR = 600, BLOCKS = 3 };

/* Returns an asset with FAR vertices along a line and sensor_count sensors, but without distances. FAR is larger than one block
   of distances, so there are several blocks. */
static struct asset_parts long_line(uint32_t sensor_count)
{
    static float at[FAR][3], up[FAR][3];
    static struct asset_sensor on[MANY];
    static struct asset_material plain;
    struct asset_parts parts = good;
    plain = materials[0];
    plain.base_color_texture = plain.occlusion_texture = ASSET_NO_TEXTURE;
    plain.second = 0;
    for (size_t i = 0; i < FAR; i++) {
        up[i][2] = 1;
        at[i][0] = (float)i;
    }
    parts.positions_m = (const float(*)[3])at;
    parts.normals = (const float(*)[3])up;
    parts.texcoords = parts.second_texcoords = NULL;
    parts.colors = NULL;
    parts.levels = NULL;
    parts.clusters = NULL;
    parts.materials = &plain;
    parts.sensors = on;
    parts.vertex_count = FAR;
    parts.sensor_count = sensor_count;
    return parts;
}

TEST(distances_lie_in_blocks)
{
    enum { SENSORS = 3 };
    static float along_m[SENSORS * FAR];
    struct asset_parts parts = long_line(SENSORS);
    struct asset_view v;
    char why[200] = "";
    for (size_t i = 0; i < FAR; i++)
        for (size_t s = 0; s < SENSORS; s++)
            along_m[s * FAR + i] = (float)(s * 1024 + i); /* exactly, or nearly */
    parts.geodesic_m = along_m;
    struct asset_bytes f = build(&parts);
    if (!asset_view_init(&v, f.bytes, f.size, why))
        fail_msg("%s", why);
    assert_int_equal(v.header->sections[ASSET_GEODESIC].bytes, 3 * 768 * 2);
    for (size_t i = 0; i < FAR; i++)
        for (size_t s = 0; s < SENSORS; s++)
            assert_float_equal(asset_distance_m(&v, s, i), along_m[s * FAR + i], along_m[s * FAR + i] * 0x1p-12f);
    assert_int_equal(asset_distance_codes(&v, 2, 599)[599 % ASSET_DISTANCE_BLOCK + 1], ASSET_DISTANCE_NONE);
    free(f.bytes);
}

/* --- packed distances --------------------------------------------------------------------------------------------------------- */

struct packed_file {
    uint16_t codes[BLOCKS][MANY][ASSET_DISTANCE_BLOCK];
    uint8_t blocks[BLOCKS][MANY * 600];
    uint64_t offsets[BLOCKS + 1];
};

/* Makes codes of distances that grow along the line, with random errors of up to error_m and, unless error_m is 0, with jumps.
   Some vertices cannot be reached from the sensors 3 and 9. */
static void make_codes(struct packed_file *packed, double error_m)
{
    for (size_t s = 0; s < MANY; s++)
        for (size_t v = 0; v < BLOCKS * (size_t)ASSET_DISTANCE_BLOCK; v++) {
            double x_m = 0.01 * (double)(v < FAR ? v : FAR - 1) + (error_m > 0 && v % 50 > 40 ? 3 : 0),
                   noise = (double)(v * 7919 % 101 * (s + 3) % 101);
            double m = hypot(x_m - 0.1 * (double)s, s == 5 ? 0 : 1) + error_m * noise / 101;
            bool lost = (s == 3 && v > 300) || (s == 9 && v % 256 == 7);
            packed->codes[v / 256][s][v % 256] = lost ? ASSET_DISTANCE_NONE : asset_distance_code((float)m);
        }
}

static void pack_codes(struct packed_file *packed)
{
    static uint16_t near[MANY][DISTANCE_PACK_NEAR];
    for (size_t s = 0; s < MANY; s++)
        for (size_t k = 0; k < DISTANCE_PACK_NEAR; k++)
            near[s][k] = (uint16_t)(k < s ? s - 1 - k : s);
    packed->offsets[0] = 64;
    assert_true(distance_pack_bound(MANY) <= sizeof(packed->blocks[0]));
    for (size_t b = 0; b < BLOCKS; b++) {
        size_t bytes = distance_pack(packed->codes[b][0], MANY, (const uint16_t(*)[DISTANCE_PACK_NEAR])near, packed->blocks[b]);
        assert_true(bytes > 0 && bytes % 16 == 0 && distance_pack_good(packed->blocks[b], bytes, MANY));
        packed->offsets[b + 1] = packed->offsets[b] + bytes;
    }
}

static void write_packed(void *arg, uint16_t *codes)
{
    const struct packed_file *packed = arg;
    uint8_t *to = (uint8_t *)codes;
    memset(to, 0, packed->offsets[0]);
    memcpy(to, packed->offsets, sizeof(packed->offsets));
    for (size_t b = 0; b < BLOCKS; b++)
        memcpy(to + packed->offsets[b], packed->blocks[b], packed->offsets[b + 1] - packed->offsets[b]);
}

static struct asset_bytes build_packed(struct packed_file *packed)
{
    struct asset_parts parts = long_line(MANY);
    parts.geodesic_m = NULL;
    parts.write_geodesic = write_packed;
    parts.write_arg = packed;
    parts.packed_bytes = packed->offsets[BLOCKS];
    return build(&parts);
}

TEST(packed_distances_are_read_back_exactly)
{
    static struct packed_file packed;
    const double errors_m[] = { 0, 1e-4, 0.01, 1000 };
    for (size_t e = 0; e < sizeof(errors_m) / sizeof(*errors_m); e++) {
        struct asset_view v;
        uint16_t *codes;
        char why[200] = "";
        make_codes(&packed, errors_m[e]);
        pack_codes(&packed);
        struct asset_bytes f = build_packed(&packed);
        if (!asset_view_init(&v, f.bytes, f.size, why))
            fail_msg("%s", why);
        assert_true(v.packed && !v.geodesic);
        assert_true(asset_view_unpack(&v, &codes) && v.geodesic == codes);
        assert_memory_equal(codes, packed.codes, sizeof(packed.codes));
        if (e == 0)
            assert_true(packed.offsets[BLOCKS] < sizeof(packed.codes) / 2);
        free(codes);
        free(f.bytes);
    }
}

static void packed_refused(struct packed_file *packed, size_t offset, uint8_t byte)
{
    struct asset_bytes f = build_packed(packed);
    ((uint8_t *)part(&f, ASSET_GEODESIC))[offset] = byte;
    refused_sealed(&f, "section `geodesic` has ");
}

TEST(damaged_packed_distances_are_refused)
{
    static struct packed_file packed;
    make_codes(&packed, 0.01);
    pack_codes(&packed);
    const size_t block = packed.offsets[1];
    /* refused: the table states that block 0 begins at byte 8, which is still in the table */
    packed_refused(&packed, 0, 8);
    packed_refused(&packed, sizeof(uint64_t) + 7, 0x80);   /* refused: block 1 of the distances begins beyond the end of the section */
    packed_refused(&packed, BLOCKS * sizeof(uint64_t), 0); /* refused: the last block of the distances ends before its section does */
    /* refused: the distances of sensor 5 are predicted from sensor 5 itself */
    packed_refused(&packed, block + 4 * 5, 5);
    packed_refused(&packed, block + 4 * 5 + 2, 17);        /* 17 bits */
    packed_refused(&packed, block + 4 * 5 + 3, 16);        /* refused: the distances take more bits than their block has */
    struct asset_bytes f = build_packed(&packed);
    f.header->sections[ASSET_GEODESIC].bytes -= 16;
    refused_sealed(&f, "section `geodesic` has ");
}
