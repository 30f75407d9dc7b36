/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Projects sensors onto an asset's surface and computes the distances of all surface points from them. */
#include "preprocess/pipeline/sensor_distances.h"

#include <math.h>
#include <string.h>

#include "base/clock.h"
#include "base/math/vec.h"
#include "base/mem.h"
#include "preprocess/cache/distance_cache.h"
#include "preprocess/pipeline/geometry_cache.h"
#include "surface/mesh/bvh.h"

bool build_sensor_place(const struct gltf_model *model, const struct geometry_params *geometry, const struct plant_sensor *sensor,
                        double place_m[3], char why[MODEL_WHY_BYTES])
{
    memcpy(place_m, sensor->position_m, sizeof(sensor->position_m));
    return !sensor->node || geometry_node_place(model, geometry, sensor->node, place_m, why);
}

/* Computes each sensor's position relative to the geometry's origin. */
static void place_sensors(struct sensor_distances *measured, const struct build_input *input, const struct geometry *geometry)
{
    measured->places_m = mem_array(input->sensor_count, sizeof(*measured->places_m));
    measured->sensors = mem_array(input->sensor_count, sizeof(*measured->sensors));
    for (size_t i = 0; i < input->sensor_count; i++)
        for (int axis = 0; axis < 3; axis++)
            measured->places_m[i][axis] = input->sensors[i].position_m[axis] - geometry->origin_m[axis];
}

static struct asset_sensor sensor_at(const struct plant_sensor *sensor, const double place_m[3], const double surface_m[3],
                                     double distance_m, uint32_t vertex)
{
    struct asset_sensor out = { .surface_distance_m = (float)distance_m, .nearest_vertex = vertex, .node_hash = sensor->node_hash };
    for (int axis = 0; axis < 3; axis++) {
        out.position_m[axis] = (float)place_m[axis];
        out.surface_m[axis] = (float)surface_m[axis];
    }
    return out;
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
        drop->out[i] = sensor_at(&drop->input->sensors[i], drop->places[i], at.position_m, at.distance_m, at.vertex);
    }
}

static void drop_sensors(const struct sensor_distances *measured, struct workers *workers, const struct build_input *input)
{
    struct drop drop = { measured->surface, input, (const double(*)[3])measured->places_m, measured->sensors };
    workers_for(workers, input->sensor_count, 8, drop_some, &drop);
}

/* Returns the number of vertices that no path along the surface connects to a sensor. */
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

/* Computes the distances of all surface points from all sensors. For a sensor that has not moved, takes the distances from the
 * distance cache. */
static bool solve(struct sensor_distances *measured, struct log *log, const struct build_input *input, uint32_t triangles, uint32_t *kept)
{
    const double(*places_m)[3] = (const double(*)[3])measured->places_m;
    struct distance_cache columns = { 0 };
    bool keep = input->folder && triangles >= GEOMETRY_CACHE_TRIANGLES;
    if (keep)
        distance_cache_open(&columns, log, input->folder, input->distances_key, surface_column_length(measured->surface), places_m,
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
    place_sensors(measured, input, g);
    char cause[SURFACE_WHY_BYTES] = "out of memory";
    if (!measured->surface)
        measured->surface = surface_create(log, workers, (const float(*)[3])g->positions_m, g->vertex_count, g->indices, g->index_count / 3,
                                           &(struct surface_params){ .tolerance_m = input->geometry.tolerance_m, .why = cause });
    int64_t made_ns = clock_mono_ns();
    if (!measured->surface || !solve(measured, log, input, g->index_count / 3, &report->kept_sensors))
        return wrong(why, "the asset's distances to %zu sensors cannot be computed: %s", input->sensor_count, cause);
    drop_sensors(measured, workers, input);
    report->unreachable_vertices = unreachable(measured, g->vertex_count);
    report->surface_s = (double)(made_ns - start_ns) / NS_PER_S;
    report->solve_s = (double)(clock_mono_ns() - made_ns) / NS_PER_S;
    return true;
}

/* --- sensors that all have assumed positions -------------------------------------------------------------------------------------- */

bool sensor_distances_matter(const struct plant *plant, const struct plant_sensor *sensors, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (!plant->tags[sensors[i].tag].place.assumed)
            return true;
    return false;
}

struct assume {
    const struct bvh *bvh;
    const struct build_input *input;
    struct sensor_distances *measured;
    const struct trimesh *mesh;
};

static void assume_some(void *arg, size_t begin, size_t end)
{
    const struct assume *assume = arg;
    for (size_t i = begin; i < end; i++) {
        const double *place_m = assume->measured->places_m[i];
        struct bvh_place at;
        bvh_nearest(assume->bvh, place_m, INFINITY, NULL, NULL, &at);
        const uint32_t *v = assume->mesh->tris[at.tri];
        uint32_t nearest = v[0];
        for (int c = 1; c < 3; c++)
            if (vec_distance2(assume->mesh->points[v[c]], place_m) < vec_distance2(assume->mesh->points[nearest], place_m))
                nearest = v[c];
        assume->measured->sensors[i] = sensor_at(&assume->input->sensors[i], place_m, at.point, at.distance_m, nearest);
    }
}

void sensor_distances_assume(struct sensor_distances *measured, struct workers *workers, const struct build_input *input,
                             const struct geometry *g)
{
    struct trimesh mesh = { 0 };
    place_sensors(measured, input, g);
    for (uint32_t v = 0; v < g->vertex_count; v++)
        trimesh_add_point(
            &mesh, (const double[3]){ (double)g->positions_m[v][0], (double)g->positions_m[v][1], (double)g->positions_m[v][2] });
    for (uint32_t i = 0; i < g->index_count; i += 3)
        trimesh_add_tri(&mesh, g->indices[i], g->indices[i + 1], g->indices[i + 2], i / 3);
    struct bvh *bvh = bvh_create(&mesh);
    struct assume assume = { bvh, input, measured, &mesh };
    workers_for(workers, input->sensor_count, 8, assume_some, &assume);
    bvh_destroy(&bvh);
    trimesh_finish(&mesh);
}

void sensor_distances_even(struct distance_rows *distances, size_t sensor_count, uint32_t vertex_count)
{
    *distances = (struct distance_rows){ .distances_m = mem_array(sensor_count, sizeof(*distances->distances_m)),
                                         .place_of = mem_array(vertex_count, sizeof(*distances->place_of)),
                                         .sensor_count = sensor_count,
                                         .vertex_count = vertex_count };
}

void sensor_distances_finish(struct sensor_distances *measured)
{
    surface_field_finish(&measured->field);
    surface_destroy(&measured->surface);
    mem_free(measured->sensors);
    mem_free(measured->places_m);
}
