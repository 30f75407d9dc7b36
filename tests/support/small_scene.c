/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A scene in static memory whose groups and assets are named in the protocol's test vectors. */
#include "tests/support/small_scene.h"

#include <math.h>

#include "protocol/asset_distance.h"

static struct plant_asset plant_assets[] = {
    { .id = "E-101", .tag = "E-101", .description = "Feed / effluent exchanger", .unit_m = 1 },
    { .id = "P-101A", .tag = "P-101 A", .description = NULL, .unit_m = 1 },
};
static struct plant_group groups[] = {
    { .id = "temperature",
      .quantity = "Temperature",
      .unit = "\302\260C",
      .min = 20,
      .max = 180,
      .limits = { NAN, 30, 150, NAN },
      .interpolation = INTERPOLATION_SHEPARD,
      .distance = DISTANCE_GEODESIC,
      .strength = 1,
      .decay = 1,
      .power = 2,
      .reach_m = INFINITY,
      .cuts_singles = true },
    { .id = "pressure",
      .quantity = "Pressure",
      .unit = "bar",
      .min = 0,
      .max = 16,
      .limits = { NAN, NAN, 12, 14 },
      .interpolation = INTERPOLATION_PAPER,
      .distance = DISTANCE_EUCLIDEAN,
      .strength = 1,
      .decay = 1,
      .power = 3,
      .radius_m = 2.5,
      .reach_m = 4,
      .fill = FILL_NEIGHBOURS },
};
static struct plant_source sources[] = { { .id = "plc1", .kind = "modbus", .hosts = { "10.20.30.40" }, .host_count = 1, .port = 502 } };
static struct plant_tag tags[] = {
    { .name = "TI-1",
      .description = "shell \342\200\234inlet\342\200\235",
      .unit = "\302\260C",
      .signal.address = "400123",
      .group = 0,
      .asset = 0,
      .alarms.limits = { NAN, 30, 150, NAN } },
    { .name = "PI-1",
      .description = NULL,
      .unit = "bar",
      .signal.address = "400124",
      .group = 1,
      .asset = 0,
      .alarms.limits = { NAN, NAN, 12, 14 } },
    { .name = "XI-1",
      .description = "not shown",
      .unit = NULL,
      .signal.address = "400125",
      .group = -1,
      .asset = -1,
      .alarms.limits = { NAN, NAN, NAN, NAN } },
};
static int tags_by_name[] = { 1, 0, 2 };
static struct plant plant = {
    .files.path = "plant.yaml",
    .files.folder = ".",
    .files.tags_path = "tags.csv",
    .name = "Unit 100",
    .time_zone = "Europe/Oslo",
    .up = AXIS_Z,
    .assets = plant_assets,
    .groups = groups,
    .sources = sources,
    .tags = tags,
    .tags_by_name = tags_by_name,
    .asset_count = 2,
    .group_count = 2,
    .source_count = 1,
    .tag_count = 3,
};
/* Parts of an asset file that the field needs: three vertices, two sensors, and their distances. */
static struct asset_header header = { .vertex_count = 3, .sensor_count = 2 };
static const float positions_m[3][3] = { { -2.5f, 0, 2.375f }, { 2.5f, 0, 2.375f }, { 0, 0, 0.5f } };
static const struct asset_sensor file_sensors[2] = { { .surface_m = { -2.5f, 0, 2.375f } }, { .surface_m = { 2.5f, 0, 2.375f } } };
/* Distances of the vertices: 0 m, 7 m and unreachable from the first sensor; 7 m, 0 m and 4 m from the second. */
static const uint16_t geodesic[2 * ASSET_DISTANCE_BLOCK] = { 0, 0x8e00, ASSET_DISTANCE_NONE, [ASSET_DISTANCE_BLOCK] = 0x8e00, 0, 0x8800 };
static struct asset file = { .view = { .header = &header, .positions_m = positions_m, .sensors = file_sensors, .geodesic = geodesic } };
static struct scene_sensor sensors[] = {
    { .tag = 0, .column = 0, .position_m = { -2.5, 0, 2.4 }, .surface_m = { -2.5, 0, 2.375 }, .surface_distance_m = 0.025 },
    { .tag = 1, .column = 1, .position_m = { 2.5, 0, 2.4 }, .surface_m = { 2.5, 0, 2.4 } },
};
static struct scene_asset assets[] = {
    { .plant = &plant_assets[0],
      .file = &file,
      .bounds_min_m = { -3, -1, 0.5 },
      .bounds_max_m = { 3, 1, 2.5 },
      .sensors = sensors,
      .sensor_count = 2 },
    { .plant = &plant_assets[1], .bounds_min_m = { 5, -1, 0 }, .bounds_max_m = { 6.5, 1, 1.25 } },
};
static const struct scene scene = {
    .plant = &plant,
    .assets = assets,
    .asset_count = 2,
    .bounds_min_m = { -3, -1, 0 },
    .bounds_max_m = { 6.5, 1, 2.5 },
};

const struct scene *small_scene(void)
{
    return &scene;
}
