/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Plants made in memory, without files. */
#include "tests/support/toy.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "tests/support/no_textures.h"
#include "value/quality.h"

enum { MAX_ASSETS = 512, MAX_TAGS = 4200, MAX_GROUPS = 2 };

struct toy *toy_create(void)
{
    struct toy *toy = mem_new(sizeof(*toy));
    struct plant *plant = &toy->plant;
    plant->name = mem_strdup("Test unit");
    plant->time_zone = mem_strdup("UTC");
    plant->up = AXIS_Z;
    plant->assets = mem_array(MAX_ASSETS, sizeof(*plant->assets));
    plant->tags = mem_array(MAX_TAGS, sizeof(*plant->tags));
    plant->groups = mem_array(MAX_GROUPS, sizeof(*plant->groups));
    plant->group_count = 1;
    plant->groups[0] = (struct plant_group){ .id = mem_strdup("temperature"),
                                             .quantity = mem_strdup("Temperature"),
                                             .unit = mem_strdup("°C"),
                                             .max = 100,
                                             .limits = { NAN, NAN, NAN, NAN },
                                             .strength = 1,
                                             .decay = 1,
                                             .power = 2,
                                             .reach_m = INFINITY };
    toy->scene.plant = plant;
    toy->scene.assets = mem_array(MAX_ASSETS, sizeof(*toy->scene.assets));
    for (int c = 0; c < 3; c++) {
        toy->scene.bounds_min_m[c] = DBL_MAX;
        toy->scene.bounds_max_m[c] = -DBL_MAX;
    }
    return toy;
}

void toy_destroy(struct toy **toy_ptr)
{
    struct toy *toy = *toy_ptr;
    struct plant *plant = &toy->plant;
    for (size_t i = 0; i < toy->scene.asset_count; i++) {
        struct asset *file = toy->scene.assets[i].file;
        if (--file->refs == 0) {
            asset_forget_closed(file);
            free((void *)file->view.header);
            mem_free(file->path);
            mem_free(file);
        }
        mem_free(toy->scene.assets[i].sensors);
        mem_free(plant->assets[i].id);
        mem_free(plant->assets[i].tag);
    }
    for (size_t i = 0; i < plant->tag_count; i++)
        mem_free(plant->tags[i].name);
    mem_free(plant->groups[0].id);
    mem_free(plant->groups[0].quantity);
    mem_free(plant->groups[0].unit);
    mem_free(plant->name);
    mem_free(plant->time_zone);
    mem_free(plant->groups);
    mem_free(plant->assets);
    mem_free(plant->tags);
    mem_free(toy->scene.assets);
    mem_free(toy->scene.folder);
    mem_free(toy->scene.extremes_m);
    mem_free(toy);
    *toy_ptr = NULL;
}

static double distance(const float a[3], const float b[3])
{
    double x = (double)a[0] - b[0], y = (double)a[1] - b[1], z = (double)a[2] - b[2];
    return sqrt(x * x + y * y + z * z);
}

static void place_sensor(const struct test_shape *shape, const double place[3], struct asset_sensor *sensor, float *distances)
{
    double best = DBL_MAX;
    for (int c = 0; c < 3; c++)
        sensor->position_m[c] = (float)place[c];
    for (size_t v = 0; v < shape->vertex_count; v++) {
        double d = distance(shape->positions[v], sensor->position_m);
        if (d < best) {
            best = d;
            sensor->nearest_vertex = (uint32_t)v;
        }
    }
    memcpy(sensor->surface_m, shape->positions[sensor->nearest_vertex], sizeof(sensor->surface_m));
    sensor->surface_distance_m = (float)best;
    for (size_t v = 0; v < shape->vertex_count; v++)
        distances[v] = (float)distance(shape->positions[v], sensor->surface_m);
}

static struct asset *make_file(const char *id, const struct test_shape *shape, const double (*sensors)[3], size_t sensor_count)
{
    static const struct asset_material materials[TOY_MATERIALS] = {
        [TOY_STEEL] = { .base_color = { 0.62f, 0.64f, 0.66f, 1 }, .metallic = 0.9f, .roughness = 0.35f, NO_TEXTURES },
        [TOY_BLUE] = { .base_color = { 0.05f, 0.16f, 0.45f, 1 }, .roughness = 0.5f, NO_TEXTURES },
        [TOY_CONCRETE] = { .base_color = { 0.50f, 0.48f, 0.45f, 1 }, .roughness = 0.9f, NO_TEXTURES },
    };
    struct asset_material own[TOY_MATERIALS];
    struct asset_sensor places[MAX_TAGS] = { 0 };
    float *distances = mem_array(sensor_count * shape->vertex_count, sizeof(*distances));
    for (size_t i = 0; i < sensor_count; i++)
        place_sensor(shape, sensors[i], &places[i], distances + i * shape->vertex_count);
    for (int i = 0; i < TOY_MATERIALS; i++) {
        own[i] = materials[i];
        own[i].normal_scale = own[i].occlusion_strength = 1;
    }
    struct asset_parts parts = { .positions_m = (void *)shape->positions,
                                 .normals = (void *)shape->normals,
                                 .indices = shape->indices,
                                 .primitives = shape->primitives,
                                 .texcoords = (void *)shape->texcoords,
                                 .textures = shape->textures,
                                 .texels = shape->texels,
                                 .texel_bytes = shape->texel_bytes,
                                 .texture_count = (uint32_t)shape->texture_count,
                                 .materials = shape->materials ? shape->materials : own,
                                 .sensors = places,
                                 .geodesic_m = distances,
                                 .vertex_count = (uint32_t)shape->vertex_count,
                                 .index_count = (uint32_t)shape->index_count,
                                 .primitive_count = (uint32_t)shape->primitive_count,
                                 .level_count = 1,
                                 .material_count = shape->materials ? (uint32_t)shape->material_count : TOY_MATERIALS,
                                 .sensor_count = (uint32_t)sensor_count };
    struct asset *file = mem_new(sizeof(*file));
    char why[200] = "out of memory";
    void *bytes = asset_build(&parts, &file->bytes);
    if (!bytes || !asset_view_init(&file->view, bytes, file->bytes, why)) {
        fprintf(stderr, "toy asset %s: %s\n", id, why);
        abort();
    }
    file->path = mem_strdup(id);
    file->closed = mem_array(file->view.header->level_count, sizeof(*file->closed));
    /* few triangles keep tests quick, but make the field inexact; claiming that all levels are fine enough avoids the mark for
       inexact fields */
    file->resolved_levels = UINT64_MAX;
    file->refs = 1;
    mem_free(distances);
    return file;
}

static void place_point(const double placement[16], const float point_m[3], double out[3])
{
    for (int r = 0; r < 3; r++) {
        out[r] = placement[12 + r];
        for (int c = 0; c < 3; c++)
            out[r] += placement[4 * c + r] * (double)point_m[c];
    }
}

static void add_tags(struct toy *toy, struct scene_asset *asset, int index)
{
    const struct asset_view *view = &asset->file->view;
    asset->sensor_count = view->header->sensor_count;
    asset->sensors = mem_array(asset->sensor_count, sizeof(*asset->sensors));
    for (size_t i = 0; i < asset->sensor_count; i++) {
        int tag = (int)toy->plant.tag_count++;
        struct scene_sensor *sensor = &asset->sensors[i];
        toy->plant.tags[tag] = (struct plant_tag){ .name = mem_printf("%s-%zu", asset->plant->id, i + 1),
                                                   .unit = toy->plant.groups[0].unit,
                                                   .source = -1,
                                                   .asset = index,
                                                   .strength = 1,
                                                   .decay = 1,
                                                   .place.has_position = true,
                                                   .alarms.limits = { NAN, NAN, NAN, NAN } };
        *sensor = (struct scene_sensor){ .tag = tag, .column = (int)i, .surface_distance_m = view->sensors[i].surface_distance_m };
        place_point(asset->placement, view->sensors[i].position_m, sensor->position_m);
        place_point(asset->placement, view->sensors[i].surface_m, sensor->surface_m);
    }
}

static void find_bounds(struct scene_asset *asset)
{
    const struct asset_header *header = asset->file->view.header;
    for (int c = 0; c < 3; c++) {
        asset->bounds_min_m[c] = DBL_MAX;
        asset->bounds_max_m[c] = -DBL_MAX;
    }
    for (int corner = 0; corner < 8; corner++) {
        float point_m[3];
        double out[3];
        for (int c = 0; c < 3; c++)
            point_m[c] = corner >> c & 1 ? header->bounds_max_m[c] : header->bounds_min_m[c];
        place_point(asset->placement, point_m, out);
        for (int c = 0; c < 3; c++) {
            asset->bounds_min_m[c] = fmin(asset->bounds_min_m[c], out[c]);
            asset->bounds_max_m[c] = fmax(asset->bounds_max_m[c], out[c]);
        }
    }
}

/* Adds an asset; takes ownership of the file. */
static int add(struct toy *toy, const char *id, struct asset *file, const double placement[16])
{
    int index = (int)toy->scene.asset_count++;
    struct scene_asset *asset = &toy->scene.assets[index];
    struct plant_asset *plant_asset = &toy->plant.assets[index];
    toy->plant.asset_count = toy->scene.asset_count;
    *plant_asset = (struct plant_asset){ .id = mem_strdup(id), .tag = mem_strdup(id), .unit_m = 1, .up = AXIS_Z };
    asset->plant = plant_asset;
    asset->file = file;
    memcpy(asset->placement, placement, sizeof(asset->placement));
    memcpy(plant_asset->placement, placement, sizeof(asset->placement));
    find_bounds(asset);
    for (int c = 0; c < 3; c++) {
        toy->scene.bounds_min_m[c] = fmin(toy->scene.bounds_min_m[c], asset->bounds_min_m[c]);
        toy->scene.bounds_max_m[c] = fmax(toy->scene.bounds_max_m[c], asset->bounds_max_m[c]);
    }
    add_tags(toy, asset, index);
    return index;
}

int toy_add(struct toy *toy, const char *id, struct test_shape *shape, const double at_m[3], const double (*sensors)[3],
            size_t sensor_count)
{
    double placement[16];
    for (int i = 0; i < 16; i++)
        placement[i] = i >= 12 && i < 15 ? at_m[i - 12] : i % 5 == 0;
    int index = add(toy, id, make_file(id, shape, sensors, sensor_count), placement);
    shape_finish(shape);
    return index;
}

int toy_add_again(struct toy *toy, const char *id, int of, const double plant_from_shape[16])
{
    struct asset *file = toy->scene.assets[of].file;
    file->refs++;
    return add(toy, id, file, plant_from_shape);
}

struct snapshot *toy_snapshot(const struct toy *toy)
{
    return snapshot_create(toy->plant.tag_count);
}

void toy_set(struct snapshot *snapshot, int tag, double value, uint32_t quality)
{
    struct reading *reading = &snapshot->readings[tag];
    reading->value = value;
    reading->quality = quality;
    reading->changes++;
    reading->age_ns = 1000000000;
    reading->received_utc_ns = 1000000000;
}

void toy_fill(struct snapshot *snapshot, double more)
{
    static const double values[8] = { 15, 30, 55, 80, 105, 20, 45, 90 };
    for (int i = 0; i < 8; i++)
        toy_set(snapshot, i, values[i] + more,
                i == 6   ? QUALITY_BAD_SENSOR_FAILURE
                : i == 5 ? QUALITY_UNCERTAIN_LAST_USABLE
                         : (uint32_t)QUALITY_GOOD);
}

static void add_exchanger(struct toy *toy)
{
    static const double sensors[5][3] = { { -1.9, -0.6, 1.2 }, { -0.8, 0, 1.8 }, { 0.2, -0.55, 1.4 }, { 1.1, 0, 1.8 }, { 1.9, -0.6, 1.2 } };
    struct test_shape shape = { 0 };
    shape_cylinder(&shape, TOY_STEEL, (double[3]){ -2, 0, 1.2 }, (double[3]){ 2, 0, 1.2 }, 0.6, 0.6, 1);
    for (int side = -1; side <= 1; side += 2) {
        shape_cylinder(&shape, TOY_STEEL, (double[3]){ side * 1.72, 0, 1.2 }, (double[3]){ side * 1.80, 0, 1.2 }, 0.70, 0.70, 0);
        shape_cylinder(&shape, TOY_STEEL, (double[3]){ side * 1.3, 0, 1.7 }, (double[3]){ side * 1.3, 0, 2.3 }, 0.16, 0.16, 0);
        shape_cylinder(&shape, TOY_STEEL, (double[3]){ side * 1.3, 0, 2.25 }, (double[3]){ side * 1.3, 0, 2.32 }, 0.26, 0.26, 0);
        shape_box(&shape, TOY_BLUE, (double[3]){ side * 1.1 - 0.12, -0.45, 0 }, (double[3]){ side * 1.1 + 0.12, 0.45, 0.85 });
    }
    toy_add(toy, "E-101", &shape, (double[3]){ 0, 0, 0 }, sensors, 5);
}

struct toy *toy_unit(void)
{
    static const double tank_sensors[3][3] = { { -0.7, -0.7, 0.6 }, { -0.7, -0.7, 1.8 }, { 0, -1, 2.9 } };
    struct toy *toy = toy_create();
    struct test_shape shape = { 0 };
    add_exchanger(toy);
    shape_cylinder(&shape, TOY_STEEL, (double[3]){ 0, 0, 0 }, (double[3]){ 0, 0, 3 }, 1, 1, 1);
    toy_add(toy, "T-201", &shape, (double[3]){ 4.2, 1.2, 0 }, tank_sensors, 3);
    shape_cylinder(&shape, TOY_STEEL, (double[3]){ -1.3, 0, 2.32 }, (double[3]){ -1.3, 0, 3.2 }, 0.14, 0.14, 0);
    shape_cylinder(&shape, TOY_STEEL, (double[3]){ -1.3, 0.1, 3.1 }, (double[3]){ 4.2, 1.2, 3.1 }, 0.14, 0.14, 0);
    toy_add(toy, "P-1", &shape, (double[3]){ 0, 0, 0 }, NULL, 0);
    shape_box(&shape, TOY_CONCRETE, (double[3]){ -3.2, -1.6, -0.15 }, (double[3]){ 5.8, 2.8, 0 });
    toy_add(toy, "SLAB", &shape, (double[3]){ 0, 0, 0 }, NULL, 0);
    shape_cylinder(&shape, TOY_BLUE, (double[3]){ 0, 0, 0.35 }, (double[3]){ 0.8, 0, 0.35 }, 0.22, 0.22, 0);
    shape_box(&shape, TOY_CONCRETE, (double[3]){ -0.1, -0.3, 0 }, (double[3]){ 0.9, 0.3, 0.12 });
    toy_add(toy, "P-101", &shape, (double[3]){ 1.4, -1.1, 0 }, NULL, 0);
    return toy;
}
