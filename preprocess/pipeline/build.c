/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Builds the prepared file of one asset, from a parsed model or cached geometry. */
#include "preprocess/pipeline/build.h"

#include <math.h>
#include <string.h>
#define XXH_STATIC_LINKING_ONLY /* makes xxhash.h declare the hash state as a complete type, so that it can be a local variable */
#include <xxhash.h>

#include "base/clock.h"
#include "base/mem.h"
#include "preprocess/cache/build_cache.h"
#include "plant/exact.h"
#include "plant/influence.h"
#include "plant/recipe.h"
#include "plant/singles.h"
#include "preprocess/influence/influence_file.h"
#include "preprocess/levels/clusters.h"
#include "preprocess/pipeline/sensor_distances.h"
#include "preprocess/levels/vertex_order.h"
#include "preprocess/subdivision/subdivide.h"
#include "preprocess/pipeline/geometry_cache.h"
#include "surface/surface_store.h"

static void hash_text(XXH3_state_t *state, const char *text)
{
    XXH3_64bits_update(state, text ? text : "", text ? strlen(text) + 1 : 1);
}

/* Returns whether all points of the asset show the same value. This is so if each group has only one sensor on the asset,
   Shepard interpolation, and no reach (distance beyond which a sensor has no influence). Distances then do not affect the
   picture. */
static bool is_constant(const struct plant *plant, const struct plant_sensor *sensors, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        const struct plant_group *group = &plant->groups[plant->tags[sensors[i].tag].group];
        if (group->reach_m < INFINITY || plant_cuts_for_paper(group, 1) || !plant_sensor_is_alone(plant, sensors, count, i))
            return false;
    }
    return true;
}

/* Hashes what else the result of a fit to recorded readings depends on: the names of the group's tags, by which the file's columns are
   found; with too few sensors for a fit, the group's range, from which defaults are taken. */
static void hash_fit(XXH3_state_t *state, const struct plant *plant, const struct plant_sensor *sensors, size_t count, int group)
{
    const double range = plant->groups[group].max - plant->groups[group].min;
    uint32_t *columns = mem_array(count, sizeof(*columns));
    size_t placed = plant_placed_sensors(plant, sensors, count, group, columns);
    for (size_t i = 0; i < placed; i++)
        hash_text(state, plant->tags[sensors[columns[i]].tag].name);
    mem_free(columns);
    if (placed < PLANT_GP_FITTED)
        XXH3_64bits_update(state, &range, sizeof(range));
}

/* Hashes the settings for the interpolation `gp` (Gaussian process) and the recorded readings that its parameters are fitted
 * to. Covers the groups that have a sensor in `sensors`. */
static void hash_gp(XXH3_state_t *state, const struct plant *plant, const struct plant_sensor *sensors, size_t count)
{
    for (size_t g = 0; g < plant->group_count; g++) {
        const struct plant_gp *gp = &plant->groups[g].gp;
        const double numbers[3] = { gp->range_m, gp->noise, gp->deviation };
        bool has_sensor = false;
        uint64_t readings = 0;
        for (size_t i = 0; i < count; i++)
            has_sensor |= plant->tags[sensors[i].tag].group == (int)g;
        if (!has_sensor || !plant_prepares(&plant->groups[g], INTERPOLATION_GP))
            continue;
        if (gp->fit)
            /* ignore an unreadable readings file: reading it for the fit will report the error */
            plant_model_hash(gp->fit, &readings);
        XXH3_64bits_update(state, numbers, sizeof(numbers));
        XXH3_64bits_update(state, &readings, sizeof(readings));
        if (gp->fit)
            hash_fit(state, plant, sensors, count, (int)g);
    }
}

uint64_t build_recipe(uint64_t model_hash, const struct geometry_params *geometry)
{
    XXH3_state_t state;
    XXH3_INITSTATE(&state);
    XXH3_64bits_reset(&state);
    XXH3_64bits_update(&state, &(uint64_t){ build_geometry_key(model_hash, geometry) }, sizeof(uint64_t));
    XXH3_64bits_update(&state, geometry->nodes ? "n" : "a", 1);
    hash_text(&state, geometry->nodes);
    return XXH3_64bits_digest(&state);
}

uint64_t build_geometry_key(uint64_t geometry_hash, const struct geometry_params *geometry)
{
    const uint32_t numbers[3] = { ASSET_VERSION, BUILD_REVISION, (uint32_t)geometry->up };
    XXH3_state_t state;
    XXH3_INITSTATE(&state);
    XXH3_64bits_reset(&state);
    XXH3_64bits_update(&state, numbers, sizeof(numbers));
    XXH3_64bits_update(&state, &geometry_hash, sizeof(geometry_hash));
    XXH3_64bits_update(&state, &geometry->unit_m, sizeof(geometry->unit_m));
    if (geometry->tolerance_m > 0)
        XXH3_64bits_update(&state, &geometry->tolerance_m, sizeof(geometry->tolerance_m));
    return XXH3_64bits_digest(&state);
}

uint64_t build_key(uint64_t geometry_key, const struct plant *plant, const struct plant_sensor *sensors, size_t sensor_count)
{
    XXH3_state_t state;
    XXH3_INITSTATE(&state);
    XXH3_64bits_reset(&state);
    XXH3_64bits_update(&state, &geometry_key, sizeof(geometry_key));
    for (size_t i = 0; i < sensor_count; i++) {
        hash_text(&state, sensors[i].node);
        XXH3_64bits_update(&state, sensors[i].position_m, sizeof(sensors[i].position_m));
    }
    XXH3_64bits_update(&state, &(uint64_t){ plant_cuts_recipe(plant, sensors, sensor_count) }, sizeof(uint64_t));
    hash_gp(&state, plant, sensors, sensor_count);
    if (sensor_count && !sensor_distances_matter(plant, sensors, sensor_count))
        XXH3_64bits_update(&state, "a", 1);
    return XXH3_64bits_digest(&state);
}

static double seconds_since(int64_t *since_ns)
{
    int64_t now_ns = clock_mono_ns();
    double seconds = (double)(now_ns - *since_ns) / NS_PER_S;
    *since_ns = now_ns;
    return seconds;
}

/* State of building one asset. */
struct build {
    struct log *log;
    struct workers *workers;
    const struct build_input *input;
    struct build_output *output;
    struct geometry geometry;
    struct levels levels;
    struct sensor_distances measured;
    struct asset_level file[LEVELS_MAX]; /* levels of detail as stored in the asset file */
    /* serialised geometry and levels of detail for the geometry cache; empty if they came from it */
    struct text parts;
    bool surface_kept;              /* true: the surface has been written to the build cache */
    struct distance_rows distances; /* distances of the vertices from the sensors, in the vertices' final order */
    struct clusters_making *making[LEVELS_MAX];
    size_t making_count;
    bool keeps; /* true: write subdivision results to the cache for the next run */
    struct subdiv_cache findings;
    struct sample_cache sample_cache;
    struct build_report geometry_report;
    struct workers_task *keeping;          /* workers' task that writes the asset's caches */
    struct workers_task *sending;          /* workers' task that writes the asset's file to disk */
    void (*tasks[2])(struct build *build); /* two build steps that run concurrently */
    bool failed[2];
    int write_error; /* errno of a failed write to the asset's file; 0: none failed */
    char *why;
};

static void run_task(void *arg, size_t begin, size_t end)
{
    struct build *build = arg;
    for (size_t i = begin; i < end; i++)
        if (build->tasks[i])
            build->tasks[i](build);
}

static bool run_both(struct build *build, void (*first)(struct build *build), void (*second)(struct build *build))
{
    build->tasks[0] = first;
    build->tasks[1] = second;
    workers_for(build->workers, 2, 1, run_task, build);
    return !build->failed[0] && !build->failed[1];
}

/* --- two concurrent tasks: making levels of detail, and computing distances --- */

static void make_levels(struct build *build)
{
    struct build_report *report = &build->output->report;
    int64_t since_ns = clock_mono_ns();
    build->failed[0] = !levels_make(&build->levels, &build->geometry, build->workers);
    if (build->failed[0])
        wrong(build->why, "cannot compute the levels of detail: out of memory (%u vertices)", build->geometry.vertex_count);
    report->repeated_triangles = (uint32_t)build->levels.repeated;
    report->levels_s = seconds_since(&since_ns);
}

static void find_distances(struct build *build)
{
    char why[MODEL_WHY_BYTES];
    build->failed[1] =
        !sensor_distances_find(&build->measured, build->log, build->workers, build->input, &build->geometry, build->output, why);
    if (build->failed[1])
        memcpy(build->why, why, sizeof(why));
}

static void assume_sensors(struct build *build)
{
    if (build->input->sensor_count > 0)
        sensor_distances_assume(&build->measured, build->workers, build->input, &build->geometry);
}

/* --- two concurrent tasks: subdivision, and checking the distances --- */

/* Starts partitioning a finished level of detail into clusters while the next level is subdivided, because meshoptimizer uses
 * only one core. Called for each level once it is subdivided. */
static void begin_clusters(void *arg, const struct level *level)
{
    struct build *build = arg;
    const struct geometry *g = &build->geometry;
    build->making[build->making_count++] = clusters_begin(build->workers, level, (const float(*)[3])g->positions_m, g->vertex_count);
}

/* Waits for the clusters of all levels of detail and collects them. Must be called before the levels are merged into one index array. */
static void end_clusters(struct build *build, struct clusters *clusters)
{
    uint32_t first_index = 0;
    for (size_t l = 0; l < build->making_count; l++) {
        clusters_end(&build->making[l], first_index, clusters);
        first_index += build->levels.at[l].index_count;
    }
    build->making_count = 0;
}

static void split(struct build *build)
{
    const struct build_input *input = build->input;
    struct sensor_distances *measured = &build->measured;
    struct linear_error linear;
    int64_t since_ns = clock_mono_ns();
    float(*places)[3] = mem_array(input->sensor_count, sizeof(*places));
    for (size_t i = 0; i < input->sensor_count; i++)
        memcpy(places[i], measured->sensors[i].surface_m, sizeof(*places));
    linear_error_init(&linear, input->plant, input->sensors, input->sensor_count, (const float(*)[3])places);
    build->keeps = input->folder && build->geometry.index_count / 3 >= GEOMETRY_CACHE_TRIANGLES;
    if (build->keeps) {
        sample_cache_open(&build->sample_cache, build->log, input->folder, input->geometry_key);
        subdiv_cache_open(&build->findings, build->log, input->folder, input->distances_key, &linear);
    }
    build->failed[0] = !subdivide_levels(&build->levels, &build->geometry,
                                         &(struct subdiv_input){ .linear = &linear,
                                                                 .surface = measured->surface,
                                                                 .field = &measured->field,
                                                                 .sensors = measured->sensors,
                                                                 .workers = build->workers,
                                                                 .cache = &build->findings,
                                                                 .sample_cache = build->keeps ? &build->sample_cache : NULL,
                                                                 .level_done = begin_clusters,
                                                                 .arg = build },
                                         &build->distances);
    if (build->failed[0])
        wrong(build->why, "cannot compute the levels of detail: out of memory (%u vertices)", build->geometry.vertex_count);
    build->output->report.split_measured = build->findings.measured_count;
    build->output->report.split_kept = build->findings.kept_count;
    linear_error_finish(&linear);
    mem_free(places);
    build->output->report.split_s = seconds_since(&since_ns);
}

/* Compares some of the asset's distances with those of the heat method, for the report. For a small asset this would take
 * longer than everything else, so it is skipped if the field is constant or the cache has the result. */
static void check(struct build *build)
{
    const struct build_input *input = build->input;
    struct sensor_distances *measured = &build->measured;
    struct surface_report *report = &build->output->report.surface;
    const struct surface_report *found = surface_report(measured->surface);
    bool known = input->cache && !isnan(report->heat_disagreement);
    if (!known && !is_constant(input->plant, input->sensors, input->sensor_count))
        build->failed[1] = !surface_check(measured->surface, &measured->field);
    if (build->failed[1])
        wrong(build->why, "cannot check the distances along the asset's surface: out of memory");
    if (!input->cache) {
        *report = *found;
    } else if (!known) {
        report->time_m2 = found->time_m2;
        report->heat_disagreement = found->heat_disagreement;
    }
}

/* --- writing the caches that the next run reads ------------------------------------------------------------------------------ */

/* Serialises geometry and levels of detail for the geometry cache, before subdivision changes them. */
static void pack_parts(struct build *build)
{
    const struct build_input *input = build->input;
    if (input->folder && !input->cache && build->geometry.index_count / 3 >= GEOMETRY_CACHE_TRIANGLES)
        geometry_cache_pack(&build->parts, &build->geometry, &build->levels);
}

static bool write_surface(const struct build *build)
{
    const struct build_input *input = build->input;
    struct text packed = { 0 };
    surface_pack(build->measured.surface, &packed);
    bool good = build_cache_write(input->folder, BUILD_CACHE_SURFACE, input->geometry_key,
                                  &(struct atomic_file_part){ packed.at, packed.length }, 1) == 0;
    text_finish(&packed);
    return good;
}

/* Writes the geometry cache. Ignores errors: the next run then only takes longer. */
static void write_geometry(const struct build *build)
{
    const struct build_input *input = build->input;
    if (build->surface_kept)
        geometry_cache_write(input->folder, input->geometry_key, build->parts.at, build->parts.length, &build->geometry_report);
}

/* Checks the distances against the heat method, then writes the surface with the check's result to the cache. Runs while levels
 * of detail are subdivided. */
static void check_and_keep(struct build *build)
{
    check(build);
    build->surface_kept = !build->failed[1] && !build->input->cache && build->parts.length && write_surface(build);
}

static void write_caches(void *arg)
{
    const struct build *build = arg;
    const struct build_input *input = build->input;
    if (build->keeps) {
        subdiv_cache_write(&build->findings, input->folder, input->distances_key);
        sample_cache_write(&build->sample_cache, input->folder, input->geometry_key);
    }
    write_geometry(build);
}

/* Orders the vertices by level of detail, so that each level uses only the beginning of the array. own: number of vertices
 * before subdivision. */
static bool put_in_order(struct build *build, uint32_t own)
{
    struct build_report *report = &build->output->report;
    struct geometry *g = &build->geometry;
    size_t sensors = build->input->sensor_count;
    uint32_t *new_of = NULL;
    bool good = vertex_order_apply(g, &build->levels, own, build->file, &new_of);
    if (good && sensors)
        distance_rows_renumber(&build->distances, new_of, g->vertex_count);
    for (size_t s = 0; good && s < sensors; s++)
        build->measured.sensors[s].nearest_vertex = new_of[build->measured.sensors[s].nearest_vertex];
    report->level_count = build->levels.count;
    report->levels_given_up = build->levels.given_up;
    for (size_t i = 0; good && i < build->levels.count; i++) {
        report->levels[i].triangles = build->levels.at[i].whole_count / 3;
        report->levels[i].split_triangles = build->levels.at[i].index_count / 3;
        report->levels[i].vertices = build->file[i].vertex_count;
        report->levels[i].error_m = build->file[i].error_m;
        memcpy(report->levels[i].left, build->levels.at[i].left, sizeof(report->levels[i].left));
    }
    mem_free(new_of);
    return good || wrong(build->why, "cannot compute the levels of detail: out of memory (%u vertices)", g->vertex_count);
}

/* Computes the influence file (weights of sensors for harmonic, fin and gp). Requires the surface and the final vertex order. */
static bool make_influence(struct build *build)
{
    const struct build_input *input = build->input;
    const struct geometry *g = &build->geometry;
    int64_t since_ns = clock_mono_ns();
    char why[200];
    struct bend_level levels[LEVELS_MAX];
    size_t triangles = 0;
    if (!influence_is_wanted(input->plant, input->sensors, input->sensor_count))
        return true;
    for (size_t l = 0; l < build->levels.count; l++) {
        levels[l] = (struct bend_level){ build->levels.at[l].index_count / 3, (double)build->levels.at[l].error_m };
        triangles += levels[l].triangle_count;
    }
    const struct influence_input wanted = { .plant = input->plant,
                                            .sensors = input->sensors,
                                            .places_m = (const double(*)[3])build->measured.places_m,
                                            .sensor_count = input->sensor_count,
                                            .surface = build->measured.surface,
                                            .positions_m = (const float(*)[3])g->positions_m,
                                            .normals = (const float(*)[3])g->normals,
                                            .triangles = g->indices,
                                            .vertex_count = g->vertex_count,
                                            .triangle_count = triangles,
                                            .levels = levels,
                                            .level_count = build->levels.count,
                                            .folder = input->folder,
                                            .key = input->key,
                                            .cloud = &build->output->report.cloud,
                                            .bend = &build->output->report.bend };
    if (!influence_file_make(build->log, build->workers, &wanted, why))
        return wrong(build->why, "%s", why);
    double seconds = seconds_since(&since_ns);
    log_info(build->log, "computed the weights of %zu sensors at %u vertices in %.1f s", input->sensor_count, g->vertex_count, seconds);
    return true;
}

static void send_file(void *arg)
{
    folder_draft_send(arg);
}

/* Converts the distances to the asset file's format and starts writing them to disk early: they are most of the file, and are
 * written while other sections are hashed and checked. */
static void write_distances(void *arg, uint16_t *codes)
{
    struct build *build = arg;
    struct folder_draft *file = &build->output->file;
    off_t at = (char *)codes - (char *)file->bytes;
    build->write_error = distance_rows_write(&build->distances, build->workers, file->file.fd, at);
    build->sending = workers_begin(build->workers, send_file, &build->output->file);
}

static void *make_file(void *arg, size_t bytes)
{
    struct build *build = arg;
    int status = folder_draft(&build->output->file, build->input->folder, build->input->key, bytes);
    if (status != 0)
        wrong(build->why, "the asset's prepared file (%zu bytes) cannot be written to %s: %s", bytes, build->input->folder,
              strerror(-status));
    return build->output->file.bytes;
}

static bool lay_out(struct build *build, const struct clusters *clusters)
{
    const struct build_input *input = build->input;
    const struct geometry *g = &build->geometry;
    struct build_output *output = build->output;
    if (!distance_rows_pack(&build->distances, build->workers))
        return wrong(build->why, "cannot compute the distances from %zu sensors: out of memory", input->sensor_count);
    struct asset_parts parts = {
        .key = input->key,
        .positions_m = (const float(*)[3])g->positions_m,
        .normals = (const float(*)[3])g->normals,
        .texcoords = (const float(*)[2])g->texcoords,
        .second_texcoords = (const float(*)[2])g->second_texcoords,
        .colors = (const uint8_t(*)[4])g->colors,
        .indices = g->indices,
        .primitives = g->primitives,
        .levels = build->file,
        .level_count = (uint32_t)output->report.level_count,
        .clusters = clusters->at,
        .cluster_count = clusters->count,
        .materials = g->materials,
        .textures = g->textures,
        .texels = g->texels,
        .sensors = build->measured.sensors,
        .write_geodesic = write_distances,
        .packed_bytes = build->distances.packed_bytes,
        .write_arg = build,
        .make_room = make_file,
        .room_arg = build,
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
    memcpy(parts.origin_m, g->origin_m, sizeof(parts.origin_m));
    size_t size;
    /* sets the error text for the case that asset_build() runs out of memory; a later failure overwrites it */
    wrong(build->why, "cannot create the asset's prepared file: out of memory");
    void *bytes = asset_build(&parts, &size);
    if (bytes && build->write_error)
        return wrong(build->why, "the distances from the asset's sensors cannot be written to %s: %s", input->folder,
                     strerror(build->write_error));
    if (!bytes)
        return false;
    /* check the asset file as a reader would, so that an invalid file is never written */
    return asset_view_fresh(&output->view, bytes, size, view_why) ||
           wrong(build->why, "plantcast-prep computed an invalid file for this asset: %s", view_why);
}

static bool build_file(struct build *build)
{
    const struct build_input *input = build->input;
    struct clusters clusters = { 0 };
    bool any = sensor_distances_matter(input->plant, input->sensors, input->sensor_count);
    uint32_t own = build->geometry.vertex_count;
    if (!run_both(build, input->cache ? NULL : make_levels, any ? find_distances : assume_sensors))
        return false;
    if (any) {
        pack_parts(build);
        if (!run_both(build, split, check_and_keep))
            return false;
        build->geometry_report = build->output->report;
        build->keeping = workers_begin(build->workers, write_caches, build);
        surface_field_finish(&build->measured.field); /* free the surface's distances early, because they take much memory */
    }
    if (!any && input->sensor_count > 0)
        sensor_distances_even(&build->distances, input->sensor_count, own);
    for (size_t l = 0; l < build->levels.count && !any; l++)
        begin_clusters(build, &build->levels.at[l]);
    end_clusters(build, &clusters);
    bool good = put_in_order(build, own) && make_influence(build) && lay_out(build, &clusters);
    clusters_finish(&clusters);
    return good;
}

static bool unpack(struct build *build)
{
    const struct build_input *input = build->input;
    enum build_cache_kind damaged;
    if (geometry_cache_unpack(input->cache, build->log, build->workers, &build->geometry, &build->levels, &build->measured.surface,
                              &damaged))
        return true;
    char *path = build_cache_path(input->folder, damaged, input->geometry_key);
    wrong(build->why, "the contents of cache file %.300s are damaged, or memory ran out: delete the file and run plantcast-prep again",
          path);
    mem_free(path);
    return false;
}

/* Gets the asset's geometry: from the cache, together with levels of detail and surface, or else by cutting it out of the model. */
static bool begin(struct build *build)
{
    const struct build_input *input = build->input;
    const struct geometry *g = &build->geometry;
    struct build_report *report = &build->output->report;
    int64_t since_ns = clock_mono_ns();
    if (!input->cache && !geometry_cut(&build->geometry, input->model, &input->geometry, build->why))
        return false;
    if (input->cache && !unpack(build))
        return false;
    *report = (struct build_report){ .nodes = g->node_count,
                                     .triangles = g->index_count / 3,
                                     .vertices = g->vertex_count,
                                     .primitives = g->primitive_count,
                                     .materials = g->material_count,
                                     .textures = g->texture_count,
                                     .degenerate_triangles = g->degenerate_triangles,
                                     .turned_triangles = g->turned_triangles,
                                     .closed_gaps = g->closed_gaps,
                                     .computed_normals = g->computed_normals,
                                     .skipped_lines = g->skipped_lines,
                                     .skipped_points = g->skipped_points,
                                     .stocked = input->cache != NULL,
                                     .read_s = seconds_since(&since_ns) };
    if (!input->cache)
        stray_text(g, input->model, &input->geometry, report->stray);
    if (input->cache) {
        struct surface_report *surface = &report->surface;
        memcpy(report->stray, input->cache->report.stray, sizeof(report->stray));
        report->repeated_triangles = input->cache->report.repeated_triangles;
        *surface = input->cache->report.surface;
        surface->weld_s = surface->bridge_s = surface->sample_s = surface->laplacian_s = surface->factor_s = surface->check_s = 0;
    }
    return true;
}

bool build_asset(struct log *log, struct workers *workers, const struct build_input *input, struct build_output *output,
                 char why[MODEL_WHY_BYTES])
{
    struct build build = { .log = log, .workers = workers, .input = input, .output = output, .why = why };
    *output = (struct build_output){ 0 };
    struct clusters left = { 0 };
    bool good = begin(&build) && build_file(&build);
    workers_end(&build.keeping);
    workers_end(&build.sending);
    end_clusters(&build, &left);
    clusters_finish(&left);
    subdiv_cache_close(&build.findings);
    if (build.keeps)
        sample_cache_close(&build.sample_cache);
    sensor_distances_finish(&build.measured);
    levels_finish(&build.levels);
    geometry_finish(&build.geometry);
    text_finish(&build.parts);
    distance_rows_finish(&build.distances);
    if (!good)
        folder_draft_close(&output->file);
    return good;
}
