/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One asset from a parsed model to the bytes of its file. */
#include "preprocess/build.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#define XXH_STATIC_LINKING_ONLY /* the hash state on the stack */
#include <xxhash.h>

#include "base/clock.h"
#include "base/mem.h"
#include "preprocess/clusters.h"
#include "preprocess/order.h"
#include "preprocess/split.h"

static void hash_text(XXH3_state_t *state, const char *text)
{
    XXH3_64bits_update(state, text ? text : "", text ? strlen(text) + 1 : 1);
}

/* What the splitting takes from the plant file. */
static void hash_field(XXH3_state_t *state, const struct plant *plant, const struct plant_sensor *sensor)
{
    const struct plant_tag *tag = &plant->tags[sensor->tag];
    const struct plant_group *group = &plant->groups[tag->group];
    const double numbers[5] = { tag->group, tag->strength, tag->decay, group->power, group->radius_m };
    XXH3_64bits_update(state, numbers, sizeof(numbers));
}

uint64_t build_key(uint64_t model_hash, const struct geometry_params *geometry, const struct plant *plant,
                   const struct plant_sensor *sensors, size_t sensor_count)
{
    const uint32_t numbers[3] = { ASSET_VERSION, BUILD_REVISION, (uint32_t)geometry->up };
    XXH3_state_t state;
    XXH3_INITSTATE(&state);
    XXH3_64bits_reset(&state);
    XXH3_64bits_update(&state, numbers, sizeof(numbers));
    XXH3_64bits_update(&state, &model_hash, sizeof(model_hash));
    XXH3_64bits_update(&state, geometry->nodes ? "n" : "a", 1);
    hash_text(&state, geometry->nodes);
    XXH3_64bits_update(&state, &geometry->unit_m, sizeof(geometry->unit_m));
    for (size_t i = 0; i < sensor_count; i++) {
        hash_text(&state, sensors[i].node);
        XXH3_64bits_update(&state, sensors[i].position_m, sizeof(sensors[i].position_m));
        hash_field(&state, plant, &sensors[i]);
    }
    return XXH3_64bits_digest(&state);
}

bool build_sensor_place(const struct gltf_model *model, const struct geometry_params *geometry, const struct plant_sensor *sensor,
                        double place_m[3])
{
    memcpy(place_m, sensor->position_m, sizeof(sensor->position_m));
    return !sensor->node || geometry_node_place(model, geometry, sensor->node, place_m);
}

/* Where each sensor is, less the origin. */
static bool place_sensors(const struct build_input *input, const struct geometry *geometry, double (*places)[3], int *missing, char *why)
{
    for (size_t i = 0; i < input->sensor_count; i++) {
        const struct plant_sensor *sensor = &input->sensors[i];
        double place[3];
        if (!build_sensor_place(input->model, &input->geometry, sensor, place)) {
            *missing = (int)i;
            snprintf(why, MODEL_WHY_BYTES, "the model has no node '%.200s'", sensor->node);
            return false;
        }
        for (int axis = 0; axis < 3; axis++)
            places[i][axis] = place[axis] - geometry->origin_m[axis];
    }
    return true;
}

static void drop_sensors(const struct surface *surface, const struct build_input *input, const double (*places)[3],
                         struct asset_sensor *out)
{
    for (size_t i = 0; i < input->sensor_count; i++) {
        struct surface_place at;
        surface_nearest(surface, places[i], &at);
        for (int axis = 0; axis < 3; axis++) {
            out[i].position_m[axis] = (float)places[i][axis];
            out[i].surface_m[axis] = (float)at.position_m[axis];
        }
        out[i].surface_distance_m = (float)at.distance_m;
        out[i].nearest_vertex = at.vertex;
        out[i].node_hash = input->sensors[i].node_hash;
    }
}

static size_t unreachable(const float *distances, size_t sensor_count, size_t vertex_count)
{
    size_t count = 0;
    for (size_t v = 0; v < vertex_count; v++) {
        bool reached = false;
        for (size_t s = 0; s < sensor_count && !reached; s++)
            reached = isfinite(distances[s * vertex_count + v]);
        count += !reached;
    }
    return count;
}

static double seconds_since(int64_t *since_ns)
{
    int64_t now_ns = clock_mono_ns();
    double seconds = (double)(now_ns - *since_ns) / NS_PER_S;
    *since_ns = now_ns;
    return seconds;
}

/* The sensors on the surface, and how far they are from everywhere. */
struct measured {
    struct surface *surface;
    struct surface_spot *spots;
    struct asset_sensor *sensors;
    float *distances, *sampled; /* [sensor][vertex]; [sensor][point of the surface] */
};

static void measured_finish(struct measured *measured)
{
    surface_destroy(&measured->surface);
    mem_free(measured->spots);
    mem_free(measured->sensors);
    mem_free(measured->distances);
    mem_free(measured->sampled);
}

static bool solve(const struct build_input *input, const struct geometry *g, const double (*places)[3], struct measured *measured)
{
    size_t count = input->sensor_count;
    measured->distances = mem_try_array(count * (size_t)g->vertex_count, sizeof(*measured->distances));
    measured->sampled = mem_try_array(count * surface_sampled_count(measured->surface), sizeof(*measured->sampled));
    if (!measured->distances || !measured->sampled ||
        !surface_distances_sampled(measured->surface, places, count, measured->distances, measured->sampled))
        return false;
    measured->spots = mem_array(count, sizeof(*measured->spots));
    measured->sensors = mem_array(count, sizeof(*measured->sensors));
    for (size_t i = 0; i < count; i++)
        surface_find_spot(measured->surface, places[i], NULL, &measured->spots[i]);
    drop_sensors(measured->surface, input, places, measured->sensors);
    return true;
}

static bool measure(struct log *log, struct workers *workers, const struct build_input *input, const struct geometry *g,
                    struct measured *measured, struct build_output *output, char *why)
{
    struct build_report *report = &output->report;
    int64_t since_ns = clock_mono_ns();
    double(*places)[3] = mem_array(input->sensor_count, sizeof(*places));
    bool good = place_sensors(input, g, places, &output->missing_node, why);
    if (good) {
        measured->surface = surface_create(log, workers, (const float(*)[3])g->positions_m, g->vertex_count, g->indices, g->index_count / 3,
                                           &(struct surface_params){ 0 });
        report->surface_s = seconds_since(&since_ns);
        good = measured->surface && solve(input, g, (const double(*)[3])places, measured);
        if (!good)
            snprintf(why, MODEL_WHY_BYTES, "its distances to %zu sensors cannot be computed", input->sensor_count);
    }
    if (good) {
        report->surface = *surface_report(measured->surface);
        report->unreachable_vertices = unreachable(measured->distances, input->sensor_count, g->vertex_count);
        report->solve_s = seconds_since(&since_ns);
    }
    mem_free(places);
    return good;
}

/* Distances of one sensor after another follow the vertices to their new numbers. */
static bool move_distances(float *distances, size_t sensor_count, uint32_t vertex_count, const uint32_t *new_of)
{
    float *column = mem_try_array(vertex_count, sizeof(*column));
    for (size_t s = 0; column && s < sensor_count; s++) {
        float *at = distances + s * vertex_count;
        for (uint32_t v = 0; v < vertex_count; v++)
            column[new_of[v]] = at[v];
        memcpy(at, column, vertex_count * sizeof(*column));
    }
    mem_free(column);
    return column != NULL;
}

static bool split(struct workers *workers, const struct build_input *input, struct geometry *g, struct levels *levels,
                  struct measured *measured)
{
    struct straight straight;
    float(*places)[3] = mem_array(input->sensor_count, sizeof(*places)), *distances;
    for (size_t i = 0; i < input->sensor_count; i++)
        memcpy(places[i], measured->sensors[i].surface_m, sizeof(*places));
    straight_init(&straight, input->plant, input->sensors, input->sensor_count, (const float(*)[3])places);
    bool good = split_levels(levels, g,
                             &(struct split_input){ .straight = &straight,
                                                    .surface = measured->surface,
                                                    .sources = measured->spots,
                                                    .sampled = measured->sampled,
                                                    .distances = measured->distances,
                                                    .sensors = measured->sensors,
                                                    .workers = workers },
                             &distances);
    if (good) {
        mem_free(measured->distances);
        measured->distances = distances;
    }
    straight_finish(&straight);
    mem_free(places);
    return good;
}

/* Levels first, then each is split; so a level has no more vertices than it needs. */
static bool add_levels(struct workers *workers, const struct build_input *input, struct geometry *g, struct measured *measured,
                       struct asset_level *file, struct build_report *report, char *why)
{
    struct levels levels = { 0 };
    uint32_t *new_of = NULL, own = g->vertex_count;
    int64_t since_ns = clock_mono_ns();
    bool good = levels_make(&levels, g, workers);
    report->level_count = levels.count;
    for (size_t i = 0; i < levels.count; i++)
        report->levels[i].triangles = levels.at[i].index_count / 3;
    report->levels_s = seconds_since(&since_ns);
    if (good && input->sensor_count)
        good = split(workers, input, g, &levels, measured);
    report->split_s = seconds_since(&since_ns);
    good = good && order_vertices(g, &levels, own, file, &new_of) &&
           move_distances(measured->distances, input->sensor_count, g->vertex_count, new_of);
    for (size_t s = 0; good && s < input->sensor_count; s++)
        measured->sensors[s].nearest_vertex = new_of[measured->sensors[s].nearest_vertex];
    for (size_t i = 0; good && i < levels.count; i++) {
        report->levels[i].split_triangles = levels.at[i].index_count / 3;
        report->levels[i].vertices = file[i].vertex_count;
        report->levels[i].error_m = file[i].error_m;
        report->levels[i].field_error = levels.at[i].field_error;
    }
    if (!good)
        snprintf(why, MODEL_WHY_BYTES, "out of memory for the levels of %u vertices", g->vertex_count);
    levels_finish(&levels);
    mem_free(new_of);
    return good;
}

static bool lay_out(const struct build_input *input, const struct geometry *g, const struct asset_level *levels, size_t level_count,
                    const struct clusters *clusters, const struct asset_sensor *sensors, const float *distances,
                    struct build_output *output, char *why)
{
    struct asset_parts parts = {
        .key = input->key,
        .positions_m = (const float(*)[3])g->positions_m,
        .normals = (const float(*)[3])g->normals,
        .texcoords = (const float(*)[2])g->texcoords,
        .colors = (const uint8_t(*)[4])g->colors,
        .indices = g->indices,
        .primitives = g->primitives,
        .levels = levels,
        .level_count = (uint32_t)level_count,
        .clusters = clusters->at,
        .cluster_count = clusters->count,
        .materials = g->materials,
        .textures = g->textures,
        .texels = g->texels,
        .sensors = sensors,
        .geodesic_m = distances,
        .names = g->names.at,
        .vertex_count = g->vertex_count,
        .index_count = g->index_count,
        .primitive_count = g->primitive_count,
        .material_count = g->material_count,
        .texture_count = g->texture_count,
        .sensor_count = (uint32_t)input->sensor_count,
        .texel_bytes = g->texel_bytes,
        .name_bytes = g->names.length,
    };
    char view_why[200];
    struct asset_view view;
    memcpy(parts.origin_m, g->origin_m, sizeof(parts.origin_m));
    output->bytes = asset_build(&parts, &output->size);
    if (!output->bytes) {
        snprintf(why, MODEL_WHY_BYTES, "out of memory for its file");
        return false;
    }
    if (!asset_view_init(&view, output->bytes, output->size, view_why)) { /* what a reader would refuse is not written */
        snprintf(why, MODEL_WHY_BYTES, "its file would be wrong: %s", view_why);
        return false;
    }
    return true;
}

bool build_asset(struct log *log, struct workers *workers, const struct build_input *input, struct build_output *output,
                 char why[MODEL_WHY_BYTES])
{
    struct geometry geometry = { 0 };
    struct measured measured = { 0 };
    struct asset_level levels[LEVELS_MAX] = { 0 };
    struct clusters clusters = { 0 };
    int64_t since_ns = clock_mono_ns();
    *output = (struct build_output){ .missing_node = -1 };
    if (!geometry_cut(&geometry, input->model, &input->geometry, why))
        return false;
    output->report = (struct build_report){ .nodes = geometry.node_count,
                                            .triangles = geometry.index_count / 3,
                                            .vertices = geometry.vertex_count,
                                            .primitives = geometry.primitive_count,
                                            .materials = geometry.material_count,
                                            .textures = geometry.texture_count,
                                            .degenerate_triangles = geometry.degenerate_triangles,
                                            .computed_normals = geometry.computed_normals,
                                            .skipped_lines = geometry.skipped_lines,
                                            .skipped_points = geometry.skipped_points,
                                            .read_s = seconds_since(&since_ns) };
    bool good = (!input->sensor_count || measure(log, workers, input, &geometry, &measured, output, why)) &&
                add_levels(workers, input, &geometry, &measured, levels, &output->report, why);
    if (good) {
        clusters_make(&clusters, &geometry, workers);
        good = lay_out(input, &geometry, levels, output->report.level_count, &clusters, measured.sensors, measured.distances, output, why);
    }
    clusters_finish(&clusters);
    measured_finish(&measured);
    geometry_finish(&geometry);
    if (!good) {
        free(output->bytes);
        output->bytes = NULL;
    }
    return good;
}
