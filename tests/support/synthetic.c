/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes a synthetic plant whose assets are random point clouds with sensors, for tests that need many vertices and no
   triangles. */
#include "tests/support/synthetic.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "protocol/asset_distance.h"
#include "tests/support/no_textures.h"
#include "value/quality.h"

uint64_t synthetic_random(uint64_t *state) /* the splitmix64 generator */
{
    uint64_t z = *state += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

double synthetic_random_unit(uint64_t *state)
{
    return (double)(synthetic_random(state) >> 11) * 0x1p-53;
}

static float along_axes(const float a[3], const float b[3])
{
    return fabsf(a[0] - b[0]) + fabsf(a[1] - b[1]) + fabsf(a[2] - b[2]);
}

static void build_file(struct synthetic *synthetic, const struct synthetic_params *params)
{
    static const float box_m[3] = { 10, 6, 4 };
    /* asset files need a primitive, so each asset has one degenerate triangle; tests use the vertices only */
    static const uint32_t indices[3] = { 0, 0, 0 };
    static const struct asset_primitive primitive = { .index_count = 3 };
    static const struct asset_material material = {
        .roughness = 1,
        NO_TEXTURES,
    };
    uint64_t random = params->seed;
    float(*positions)[3] = mem_array(params->vertices, sizeof(*positions));
    float(*normals)[3] = mem_array(params->vertices, sizeof(*normals));
    struct asset_sensor *sensors = mem_array(params->sensors, sizeof(*sensors));
    float *geodesic = mem_array(params->sensors * params->vertices, sizeof(*geodesic));
    for (size_t j = 0; j < params->vertices; j++) {
        normals[j][2] = 1;
        for (int axis = 0; axis < 3; axis++)
            positions[j][axis] = (float)synthetic_random_unit(&random) * box_m[axis];
    }
    for (size_t i = 0; i < params->sensors; i++) {
        memcpy(sensors[i].surface_m, positions[i], sizeof(positions[i]));
        memcpy(sensors[i].position_m, positions[i], sizeof(positions[i]));
        sensors[i].nearest_vertex = (uint32_t)i;
        for (size_t j = 0; j < params->vertices; j++)
            geodesic[i * params->vertices + j] = j < params->vertices - params->island ? along_axes(positions[i], positions[j]) : INFINITY;
    }
    const struct asset_parts parts = {
        .positions_m = (const float(*)[3])positions,
        .normals = (const float(*)[3])normals,
        .indices = indices,
        .primitives = &primitive,
        .materials = &material,
        .sensors = sensors,
        .geodesic_m = geodesic,
        .vertex_count = (uint32_t)params->vertices,
        .index_count = 3,
        .primitive_count = 1,
        .material_count = 1,
        .sensor_count = (uint32_t)params->sensors,
    };
    char why[200] = "out of memory";
    synthetic->bytes = asset_build(&parts, &synthetic->file.bytes);
    if (!synthetic->bytes || !asset_view_init(&synthetic->file.view, synthetic->bytes, synthetic->file.bytes, why)) {
        fprintf(stderr, "synthetic asset: %s\n", why);
        abort();
    }
    mem_free(positions);
    mem_free(normals);
    mem_free(sensors);
    mem_free(geodesic);
}

static void place_sensors(struct synthetic *synthetic, size_t asset, size_t sensors)
{
    struct scene_asset *at = &synthetic->scene.assets[asset];
    at->plant = &synthetic->plant.assets[asset];
    at->file = &synthetic->file;
    at->sensor_count = sensors;
    at->sensors = mem_array(sensors, sizeof(*at->sensors));
    for (int i = 0; i < 16; i += 5)
        at->placement[i] = 1;
    for (size_t i = 0; i < sensors; i++) {
        size_t tag = asset * sensors + i;
        at->sensors[i] = (struct scene_sensor){ .tag = (int)tag, .column = (int)i };
        synthetic->plant.tags[tag] = (struct plant_tag){ .asset = (int)asset, .strength = 1, .decay = 1 };
        synthetic->snapshot->readings[tag] = (struct reading){
            .value = synthetic->group.min + (synthetic->group.max - synthetic->group.min) * (0.05 + 0.9 * fmod((double)tag * 0.618034, 1)),
            .quality = QUALITY_GOOD,
        };
    }
}

struct synthetic *(synthetic_create)(const struct synthetic_params *params)
{
    struct synthetic *synthetic = mem_new(sizeof(*synthetic));
    size_t assets = params->assets ? params->assets : 1;
    build_file(synthetic, params);
    synthetic->group =
        (struct plant_group){ .min = params->min, .max = params->max, .strength = 1, .decay = 1, .power = 2, .reach_m = INFINITY };
    if (params->min == params->max)
        synthetic->group.max = params->min + 100;
    synthetic->plant.groups = &synthetic->group;
    synthetic->plant.group_count = 1;
    synthetic->plant.assets = mem_array(assets, sizeof(*synthetic->plant.assets));
    synthetic->plant.asset_count = assets;
    synthetic->plant.tags = mem_array(assets * params->sensors, sizeof(*synthetic->plant.tags));
    synthetic->plant.tag_count = assets * params->sensors;
    synthetic->snapshot = mem_new(sizeof(*synthetic->snapshot));
    synthetic->snapshot->count = assets * params->sensors;
    synthetic->snapshot->readings = mem_array(assets * params->sensors, sizeof(struct reading));
    synthetic->scene.plant = &synthetic->plant;
    synthetic->scene.assets = mem_array(assets, sizeof(*synthetic->scene.assets));
    synthetic->scene.asset_count = assets;
    for (size_t asset = 0; asset < assets; asset++)
        place_sensors(synthetic, asset, params->sensors);
    return synthetic;
}

void synthetic_destroy(struct synthetic **synthetic_ptr)
{
    struct synthetic *synthetic = *synthetic_ptr;
    if (!synthetic)
        return;
    for (size_t i = 0; i < synthetic->scene.asset_count; i++)
        mem_free(synthetic->scene.assets[i].sensors);
    mem_free(synthetic->scene.assets);
    mem_free(synthetic->plant.assets);
    mem_free(synthetic->plant.tags);
    mem_free(synthetic->snapshot->readings);
    mem_free(synthetic->snapshot);
    free(synthetic->bytes);
    mem_free(synthetic);
    *synthetic_ptr = NULL;
}

void synthetic_set_distance(struct synthetic *synthetic, size_t sensor, size_t vertex, float distance_m)
{
    uint16_t *codes = (uint16_t *)asset_distance_codes(&synthetic->file.view, sensor, vertex);
    codes[vertex % ASSET_DISTANCE_BLOCK] = asset_distance_code(distance_m);
}
