/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Dropping sensors onto an asset's surface, and finding their distances there. */
#include "preprocess/pipeline/sensor_distances.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "base/mem.h"
#include "preprocess/cache/distance_cache.h"
#include "preprocess/pipeline/geometry_cache.h"

bool build_sensor_place(const struct gltf_model *model, const struct geometry_params *geometry, const struct plant_sensor *sensor,
                        double place_m[3], char why[MODEL_WHY_BYTES])
{
    memcpy(place_m, sensor->position_m, sizeof(sensor->position_m));
    return !sensor->node || geometry_node_place(model, geometry, sensor->node, place_m, why);
}

/* Where each sensor is, less the origin. */
static void place_sensors(const struct build_input *input, const struct geometry *geometry, double (*places)[3])
{
    for (size_t i = 0; i < input->sensor_count; i++)
        for (int axis = 0; axis < 3; axis++)
            places[i][axis] = input->sensors[i].position_m[axis] - geometry->origin_m[axis];
}

struct drop {
    const struct surface *surface;
    const struct build_input *input;
    const double (*places)[3];
    struct asset_sensor *out;
};

static void drop_some(void *arg, size_t begin, size_t end)
{
    const struct drop *drop = arg;
    for (size_t i = begin; i < end; i++) {
        struct surface_place at;
        surface_nearest(drop->surface, drop->places[i], &at);
        for (int axis = 0; axis < 3; axis++) {
            drop->out[i].position_m[axis] = (float)drop->places[i][axis];
            drop->out[i].surface_m[axis] = (float)at.position_m[axis];
        }
        drop->out[i].surface_distance_m = (float)at.distance_m;
        drop->out[i].nearest_vertex = at.vertex;
        drop->out[i].node_hash = drop->input->sensors[i].node_hash;
    }
}

static void drop_sensors(const struct sensor_distances *measured, struct workers *workers, const struct build_input *input)
{
    struct drop drop = { measured->surface, input, (const double(*)[3])measured->places_m, measured->sensors };
    if (workers)
        workers_for(workers, input->sensor_count, 8, drop_some, &drop);
    else
        drop_some(&drop, 0, input->sensor_count);
}

/* Vertices without a finite distance. */
static size_t unreachable(const struct sensor_distances *measured, size_t vertex_count)
{
    size_t count = 0, sensors = measured->field.source_count;
    float *row = mem_array(sensors, sizeof(*row));
    for (uint32_t v = 0; v < vertex_count; v++) {
        bool reached = false;
        surface_field_at_vertex(&measured->field, measured->surface, v, row);
        for (size_t s = 0; s < sensors && !reached; s++)
            reached = isfinite(row[s]);
        count += !reached;
    }
    mem_free(row);
    return count;
}

/* Distances of sensors that stand where some stood before are fetched. */
static bool solve(struct sensor_distances *measured, const struct build_input *input, uint32_t triangles, uint32_t *kept)
{
    const double(*places_m)[3] = (const double(*)[3])measured->places_m;
    struct distance_cache columns = { 0 };
    bool keep = input->folder && triangles >= GEOMETRY_CACHE_TRIANGLES;
    if (keep)
        distance_cache_open(&columns, input->folder, input->distances_key, surface_column_length(measured->surface), places_m,
                            input->sensor_count);
    const struct surface_columns known = distance_cache_for_surface(&columns);
    bool good = surface_field_init(&measured->field, measured->surface, places_m, input->sensor_count, keep ? &known : NULL);
    *kept = (uint32_t)columns.kept;
    distance_cache_close(&columns);
    return good;
}

bool sensor_distances_find(struct sensor_distances *measured, struct log *log, struct workers *workers, const struct build_input *input,
                           const struct geometry *g, struct build_output *output, char why[MODEL_WHY_BYTES])
{
    struct build_report *report = &output->report;
    int64_t start_ns = clock_mono_ns();
    measured->places_m = mem_array(input->sensor_count, sizeof(*measured->places_m));
    measured->sensors = mem_array(input->sensor_count, sizeof(*measured->sensors));
    place_sensors(input, g, measured->places_m);
    char cause[SURFACE_WHY_BYTES] = "out of memory";
    if (!measured->surface)
        measured->surface = surface_create(log, workers, (const float(*)[3])g->positions_m, g->vertex_count, g->indices, g->index_count / 3,
                                           &(struct surface_params){ .tolerance_m = input->geometry.tolerance_m, .why = cause });
    int64_t made_ns = clock_mono_ns();
    if (!measured->surface || !solve(measured, input, g->index_count / 3, &report->kept_sensors))
        return wrong(why, "its distances to %zu sensors cannot be computed: %s", input->sensor_count, cause);
    drop_sensors(measured, workers, input);
    report->unreachable_vertices = unreachable(measured, g->vertex_count);
    report->surface_s = (double)(made_ns - start_ns) / NS_PER_S;
    report->solve_s = (double)(clock_mono_ns() - made_ns) / NS_PER_S;
    return true;
}

void sensor_distances_finish(struct sensor_distances *measured)
{
    surface_field_finish(&measured->field);
    surface_destroy(&measured->surface);
    mem_free(measured->sensors);
    mem_free(measured->places_m);
}
