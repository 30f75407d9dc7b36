/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Replays the seeds of the asset file fuzzer and random mutations of them. A new version of the format needs new seeds:
   `asset_fuzz_test --write FOLDER` writes them. */
#include "tests/fuzz/asset_fuzz.c"

#include "tests/support/test.h"

#include "tests/support/no_textures.h"
#include "tests/support/replay.h"

#define SEEDS "tests/fuzz/asset"

static const float positions[4][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 1, 1, 0.5f } };
static const float normals[4][3] = { { 0, 0, 1 }, { 0, 0, 1 }, { 0, 0, 1 }, { 0, 0, 1 } };
static const float texcoords[4][2] = { { 0, 0 }, { 1, 0 }, { 0, 1 }, { 1, 1 } };
static const uint8_t colors[4][4] = { { 255, 0, 0, 255 } };
static const uint32_t indices[9] = { 0, 1, 2, 1, 3, 2, 0, 1, 2 };
static const struct asset_primitive primitives[2] = { { .index_count = 6, .name = 1 }, { .first_index = 6, .index_count = 3, .name = 1 } };
static const struct asset_level levels[2] = { { .primitive_count = 1, .vertex_count = 4 },
                                              { .first_primitive = 1, .primitive_count = 1, .vertex_count = 3, .error_m = 0.5f } };
static const struct asset_material plain = { .roughness = 1,
                                             NO_TEXTURES };
static const struct asset_texture textures[1] = { { .width_px = 2, .height_px = 1, .srgb = 1 } };
static const uint8_t texels[8] = { 1, 2, 3, 4, 5, 6, 7, 8 };
static const struct asset_sensor sensors[2] = { { .position_m = { 0, 0, 0.1f }, .surface_distance_m = 0.1f }, { .nearest_vertex = 3 } };
static const float geodesic[8] = { 0, 1, 1, 2, 2, 1, 1, 0 };

static struct asset_parts small_asset(void)
{
    return (struct asset_parts){ .positions_m = positions,
                                 .normals = normals,
                                 .indices = indices,
                                 .primitives = primitives,
                                 .materials = &plain,
                                 .names = "\0part",
                                 .vertex_count = 4,
                                 .index_count = 6,
                                 .primitive_count = 1,
                                 .material_count = 1,
                                 .name_bytes = 6 };
}

static struct asset_parts full_asset(struct asset_material *material)
{
    struct asset_parts parts = small_asset();
    *material = plain;
    material->base_color_texture = material->occlusion_texture = 0;
    material->second = 1 << 3;
    parts.origin_m[0] = 1e6;
    parts.texcoords = texcoords;
    parts.second_texcoords = texcoords;
    parts.colors = colors;
    parts.index_count = 9;
    parts.primitive_count = parts.level_count = parts.sensor_count = 2;
    parts.levels = levels;
    parts.materials = material;
    parts.textures = textures;
    parts.texels = texels;
    parts.texel_bytes = sizeof(texels);
    parts.texture_count = 1;
    parts.sensors = sensors;
    parts.geodesic_m = geodesic;
    return parts;
}

static void write_seed(const char *folder, const char *name, const struct asset_parts *parts)
{
    size_t size;
    void *bytes = asset_build(parts, &size);
    temp_write(folder, name, bytes, size);
    free(bytes);
}

static int write_seeds(const char *folder)
{
    struct asset_material material;
    struct asset_parts small = small_asset(), full = full_asset(&material);
    write_seed(folder, "small.asset", &small);
    write_seed(folder, "full.asset", &full);
    return 0;
}

TEST(seeds_are_of_this_version)
{
    struct asset_material material;
    struct asset_parts small = small_asset(), full = full_asset(&material);
    const struct asset_parts *all[] = { &small, &full };
    for (int i = 0; i < 2; i++) {
        struct asset_view view;
        char why[200];
        size_t size;
        void *bytes = asset_build(all[i], &size);
        if (!asset_view_init(&view, bytes, size, why))
            fail_msg("%s", why);
        free(bytes);
    }
}

TEST(seeds_and_their_changes_keep_the_promises)
{
    assert_true(replay_folder(SEEDS, 5000, LLVMFuzzerTestOneInput) >= 2);
}

int main(int argc, char **argv)
{
    if (argc == 3 && strcmp(argv[1], "--write") == 0)
        return write_seeds(argv[2]);
    return tests_run(NULL);
}
