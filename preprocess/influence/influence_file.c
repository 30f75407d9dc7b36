/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes the interpolations that each group requests, and writes all results to an influence file. */
#include "preprocess/influence/influence_file.h"

#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>

#include "base/files/cache_file.h"
#include "base/math/vec.h"
#include "base/mem.h"
#include "plant/influence.h"
#include "preprocess/cache/folder.h"
#include "preprocess/influence/cloud_heat.h"
#include "preprocess/influence/gaussian_fit.h"
#include "preprocess/influence/influence.h"
#include "preprocess/influence/transport.h"
#include "protocol/influence_format.h"

/* number of mesh edges per correlation range that the mesh is made with; a finer mesh makes no visible difference */
#define EDGES 5.0
/* minimum number of mesh edges per correlation range; on a coarser mesh, the computed uncertainty of the interpolated values
   would be too small */
#define MIN_EDGES 2.0
#define LONGEST 10.0  /* maximum correlation range, in multiples of the surface's size; longer ranges look the same */
#define FIT_MIN 0.05  /* smallest correlation range that is fitted, in multiples of the surface's size */
#define FIT_MAX 3.0
/* maximum number of points at which the bend (interpolation error, influence_bend.h) is measured; with more, it is not measured
 * at all, because that would take too long */
enum { BEND_PLACES = 8000000 };

struct influence_making {
    struct log *log;
    struct workers *workers;
    const struct influence_input *input;
    struct vertex_embedding *embedding;
    struct cloud_heat *cloud; /* point cloud for distances by heat, created for the first group that requests them; NULL: not created yet */
    struct influence_header header;
    struct influence_entry *entries;
    struct influence *found; /* by entry of the influence file: the sensors' weights computed for it */
    size_t capacity, found_capacity;
};

/* the sensors of a group that have a known position on the asset */
struct group_sensors {
    int group;
    size_t count;
    double (*places_m)[3];
    uint32_t *columns; /* their indices in the asset file */
};

static struct group_sensors sensors_of(const struct influence_input *input, int group)
{
    struct group_sensors sensors = { .group = group };
    sensors.places_m = mem_array(input->sensor_count, sizeof(*sensors.places_m));
    sensors.columns = mem_array(input->sensor_count, sizeof(*sensors.columns));
    sensors.count = plant_placed_sensors(input->plant, input->sensors, input->sensor_count, group, sensors.columns);
    for (size_t i = 0; i < sensors.count; i++)
        memcpy(sensors.places_m[i], input->places_m[sensors.columns[i]], sizeof(*sensors.places_m));
    return sensors;
}

static void group_sensors_finish(struct group_sensors *sensors)
{
    mem_free(sensors->places_m);
    mem_free(sensors->columns);
}

bool influence_is_wanted(const struct plant *plant, const struct plant_sensor *sensors, size_t sensor_count)
{
    for (size_t i = 0; i < sensor_count; i++)
        if (!plant->tags[sensors[i].tag].place.assumed && plant_prepares_any(&plant->groups[plant->tags[sensors[i].tag].group]))
            return true;
    return false;
}

static const struct plant_asset *asset_of(const struct influence_input *input)
{
    return &input->plant->assets[input->plant->tags[input->sensors[0].tag].asset];
}

/* Returns the names of a group's sensors. The caller frees the list (mem_free). */
static const char **names_of(const struct influence_input *input, const struct group_sensors *sensors)
{
    const char **names = mem_array(sensors->count, sizeof(*names));
    for (size_t i = 0; i < sensors->count; i++)
        names[i] = input->plant->tags[input->sensors[sensors->columns[i]].tag].name;
    return names;
}

/* Sets the Gaussian process parameters that the plant file omits to defaults, for an asset with too few sensors for a fit
 * (PLANT_GP_FITTED). */
static void take_defaults(const struct influence_making *making, const struct plant_group *of, size_t count, struct gaussian_params *gp)
{
    gp->range_m = isnan(gp->range_m) ? PLANT_GP_RANGE * surface_report(making->input->surface)->size_m : gp->range_m;
    plant_gp_defaults(of, &gp->noise, &gp->deviation);
    log_warn(making->log,
             "asset %s, group %s: the Gaussian process (gp) cannot be fitted to %zu sensors (at least %d are needed): using default range "
             "%.3g m, noise %.3g, "
             "deviation %.3g %s",
             asset_of(making->input)->id, of->id, count, PLANT_GP_FITTED, gp->range_m, gp->noise, gp->deviation, of->unit);
}

/* Determines the parameters of a group's Gaussian process: takes them from the plant file, and fits those that it omits to the
 * readings file it names. */
static bool find_params(struct influence_making *making, const struct group_sensors *sensors, struct gaussian_params *gp)
{
    const struct influence_input *input = making->input;
    const size_t count = sensors->count;
    const struct plant_group *of = &input->plant->groups[sensors->group];
    const char *asset = asset_of(input)->id;
    const double size = surface_report(input->surface)->size_m;
    struct readings_table table;
    struct influence_mesh mesh = { 0 };
    char why[300];
    *gp = (struct gaussian_params){ of->gp.range_m, of->gp.noise, of->gp.deviation };
    if (gp->range_m > LONGEST * size)
        log_warn(making->log,
                 "asset %s, group %s: range_m %g of the Gaussian process (gp) is far longer than the asset (%.3g m): using %.3g m, which "
                 "gives the same values",
                 asset, of->id, gp->range_m, size, LONGEST * size);
    if (!isnan(gp->range_m) && !isnan(gp->noise) && !isnan(gp->deviation))
        return true;
    if (count < PLANT_GP_FITTED) {
        take_defaults(making, of, count, gp);
        return true;
    }
    const char **names = names_of(input, sensors);
    double least_m = FIT_MIN * size, edge_m = (isnan(gp->range_m) ? least_m : min_of(gp->range_m, LONGEST * size)) / MIN_EDGES;
    bool good = readings_table_read(&table, of->gp.fit, names, count, why);
    if (good && !influence_mesh_init(&mesh, input->surface, (const double(*)[3])sensors->places_m, count, of->disc_m, edge_m)) {
        snprintf(why, sizeof(why), "out of memory");
        good = false;
    }
    good = good && gaussian_fit(gp, &(struct gaussian_data){ making->log, making->workers, &mesh, &table }, least_m, FIT_MAX * size, why);
    if (good)
        log_info(making->log,
                 "asset %s, group %s: gp (Gaussian process): estimated from %zu readings of each of %zu sensors: range_m %.3g, "
                 "noise %.3g, deviation %.3g %s",
                 asset, of->id, table.instants, count, gp->range_m, gp->noise, gp->deviation, of->unit);
    else
        log_err(making->log, "asset %s, group %s: gp: %s", asset, of->id, why);
    influence_mesh_finish(&mesh);
    readings_table_finish(&table);
    mem_free(names);
    return good;
}

/* Returns whether the mesh has at least MIN_EDGES edges per correlation range; otherwise logs an error. */
static bool range_good(const struct influence_making *making, int group, const struct influence_mesh *mesh,
                       const struct gaussian_params *gp)
{
    if (mesh->longest_m * MIN_EDGES <= gp->range_m)
        return true;
    log_err(making->log,
            "asset %s, group %s: range_m %.3g of the Gaussian process (gp) is too short: the triangles between %zu points are up to %.3g "
            "m long, so range_m must be at least %.3g",
            asset_of(making->input)->id, making->input->plant->groups[group].id, gp->range_m, mesh->mesh.point_count, mesh->longest_m,
            mesh->longest_m * MIN_EDGES);
    return false;
}

static bool solve(struct influence_making *making, struct influence *found, enum interpolation interpolation, double decay_m,
                  const struct influence_task *task, const struct gaussian_params *gp)
{
    struct gaussian_params taken = *gp;
    taken.range_m = min_of(gp->range_m, LONGEST * surface_report(making->input->surface)->size_m);
    return interpolation == INTERPOLATION_GP ? gaussian_solve(found, task, &taken) : influence_conduct(found, task, decay_m);
}

/* Computes found->errors (interpolation errors by vertex), or sets them all to 1 (unknown) if they were not measured. Returns
 * false if out of memory. */
static bool bound_errors(const struct influence_making *making, const struct plant_group *group, enum interpolation interpolation,
                         struct influence_bend *bend, struct influence *found)
{
    double around = interpolation == INTERPOLATION_FIN ? (group->ambient - group->min) / (group->max - group->min) : 0;
    /* one extra element: the file pads the array to a multiple of 8 bytes */
    found->errors = mem_try_array(making->input->vertex_count + 1, sizeof(*found->errors));
    if (!found->errors)
        return false;
    if (bend)
        influence_bend_measure(bend, around, NULL, found->errors, making->input->bend);
    else
        making->input->bend->unmeasured++;
    for (size_t v = 0; !bend && v < making->input->vertex_count; v++)
        found->errors[v] = 1;
    return true;
}

/* Adds an entry without weights to the influence file. Returns its index. */
static uint32_t new_entry(struct influence_making *making, const struct group_sensors *sensors, uint32_t kind)
{
    uint32_t at = making->header.entry_count++;
    mem_grow(&making->entries, &making->capacity, at + 1, sizeof(*making->entries));
    mem_grow(&making->found, &making->found_capacity, at + 1, sizeof(*making->found));
    making->entries[at] = (struct influence_entry){ .group = (uint32_t)sensors->group,
                                                    .interpolation = kind,
                                                    .sensor_count = (uint32_t)sensors->count,
                                                    .columns_hash = influence_columns_hash(sensors->columns, sensors->count) };
    return at;
}

/* Computes one interpolation of a group and adds it to the influence file's entries. task->bend: measures the interpolation
 * errors; NULL: there are too many places (corners of overlaps) to measure them. */
static bool add_entry(struct influence_making *making, const struct group_sensors *sensors, enum interpolation interpolation,
                      const struct influence_task *task, const struct gaussian_params *gp)
{
    const struct influence_input *input = making->input;
    const struct plant_group *group = &input->plant->groups[sensors->group];
    double decay_m = interpolation == INTERPOLATION_FIN ? plant_decay_m(asset_of(input)) : (double)INFINITY;
    uint32_t at = new_entry(making, sensors, interpolation);
    making->entries[at].disc_m = group->disc_m;
    making->entries[at].decay_m = isfinite(decay_m) ? decay_m : 0;
    if (interpolation == INTERPOLATION_GP) {
        making->entries[at].range_m = gp->range_m;
        making->entries[at].noise = gp->noise;
        making->entries[at].deviation = gp->deviation;
    }
    return solve(making, &making->found[at], interpolation, decay_m, task, gp) &&
           bound_errors(making, group, interpolation, task->bend, &making->found[at]);
}

static bool add_transport(struct influence_making *making, const struct group_sensors *sensors, const struct influence_mesh *mesh,
                          const struct influence_anchor *anchors)
{
    uint32_t at = new_entry(making, sensors, INFLUENCE_TRANSPORT);
    return transport_angles(&making->found[at], making->log, making->workers, mesh, anchors, making->input->normals,
                            making->input->vertex_count);
}

/* --- distances by heat ------------------------------------------------------------------------------------------------------ */

struct cloud_sum {
    double error_m, worst_m, largest_m;
    size_t vertices;
};

static bool compare(struct influence_making *making, const double place_m[3], const float *by_heat_m, float *ours_m, struct cloud_sum *sum)
{
    struct cloud_report *report = making->input->cloud;
    if (!vertex_embedding_distances(making->embedding, place_m, ours_m))
        return false;
    for (size_t v = 0; v < making->input->vertex_count; v++) {
        bool both = isfinite(by_heat_m[v]) && isfinite(ours_m[v]);
        report->reached += isfinite(by_heat_m[v]) && !both;
        report->unreached += isfinite(ours_m[v]) && !both;
        double error_m = both ? fabs((double)by_heat_m[v] - (double)ours_m[v]) : 0;
        sum->error_m += error_m;
        sum->worst_m = fmax(sum->worst_m, error_m);
        sum->largest_m = both ? fmax(sum->largest_m, (double)ours_m[v]) : sum->largest_m;
        sum->vertices += both;
    }
    return true;
}

struct heat_work {
    struct influence_making *making;
    const double (*places_m)[3];
    float *out;
    atomic_bool failed;
};

static void find_by_heat(void *arg, size_t begin, size_t end)
{
    struct heat_work *work = arg;
    const struct influence_input *input = work->making->input;
    for (size_t i = begin; i < end; i++)
        if (!cloud_heat_distances(work->making->cloud, work->places_m[i], input->positions_m, input->vertex_count,
                                  work->out + i * input->vertex_count))
            work->failed = true;
}

/* Computes distances by heat on a point cloud for a group. For the report, compares those of the first CLOUD_CHECKED sensors
   with the distances along the mesh that plantcast-prep computes otherwise. */
static bool add_heat(struct influence_making *making, const struct group_sensors *sensors)
{
    const struct influence_input *input = making->input;
    struct cloud_sum sum = { 0 };
    const double(*places_m)[3] = (const double(*)[3])sensors->places_m;
    const size_t count = sensors->count;
    if (!making->cloud && !(making->cloud = cloud_heat_create(making->log, input->surface)))
        return false;
    const uint32_t at = new_entry(making, sensors, INFLUENCE_HEAT);
    struct influence *found = &making->found[at];
    *found = (struct influence){ .count = count,
                                 .vertex_count = input->vertex_count,
                                 .shares = mem_try_array(count * input->vertex_count, sizeof(float)),
                                 .precision = mem_try_array(count * count, sizeof(double)) };
    float *ours_m = mem_try_array(input->vertex_count, sizeof(*ours_m));
    struct heat_work work = { making, places_m, found->shares, false };
    bool good = found->shares && found->precision && ours_m;
    if (good)
        workers_for(making->workers, count, 1, find_by_heat, &work);
    good = good && !work.failed;
    for (size_t i = 0; good && i < count && i < CLOUD_CHECKED; i++)
        good = compare(making, places_m[i], found->shares + i * input->vertex_count, ours_m, &sum);
    if (good && sum.vertices > 0 && sum.largest_m > 0) {
        struct cloud_report *report = input->cloud;
        report->points = cloud_heat_count(making->cloud);
        report->k = cloud_heat_k(making->cloud);
        report->spacing_m = cloud_heat_spacing_m(making->cloud);
        report->mean = fmax(report->mean, sum.error_m / (double)sum.vertices / sum.largest_m);
        report->worst = fmax(report->worst, sum.worst_m / sum.largest_m);
    }
    mem_free(ours_m);
    return good;
}

/* --- computing the entries of all groups, and writing the file -------------------------------------------------------------- */

static bool add_group(struct influence_making *making, int group)
{
    const struct influence_input *input = making->input;
    const struct plant_group *of = &input->plant->groups[group];
    struct influence_mesh mesh = { 0 };
    struct group_sensors sensors = sensors_of(input, group);
    const double(*places_m)[3] = (const double(*)[3])sensors.places_m;
    const size_t count = sensors.count;
    bool good = true;
    if (count > 0 && of->heat)
        good = add_heat(making, &sensors);
    if (good && count > 0 && (of->prepared >> INTERPOLATION_HARMONIC || of->directed)) {
        struct influence_anchor *anchors = NULL;
        struct influence_bend bend = { 0 };
        bool bounded = false;
        struct gaussian_params gp = { .range_m = INFINITY };
        bool has_gp = plant_prepares(of, INTERPOLATION_GP);
        good = (!has_gp || find_params(making, &sensors, &gp)) &&
               influence_mesh_init(&mesh, input->surface, places_m, count, of->disc_m, gp.range_m / EDGES) &&
               range_good(making, group, &mesh, &gp);
        anchors = good ? mem_try_array(input->vertex_count, sizeof(*anchors)) : NULL;
        good = anchors != NULL;
        if (good)
            influence_mesh_anchors(&mesh, making->embedding, input->vertex_count, anchors);
        if (good && of->prepared >> INTERPOLATION_HARMONIC) {
            const struct bend_drawn drawn = { input->positions_m, input->triangles, input->vertex_count, input->triangle_count, anchors,
                                              input->levels,      input->level_count };
            bounded = influence_bend_init(&bend, &mesh, input->surface, &drawn, BEND_PLACES);
        }
        const struct influence_task task = { making->log, making->workers, &mesh, anchors, input->vertex_count, bounded ? &bend : NULL };
        for (int i = INTERPOLATION_HARMONIC; good && i < INTERPOLATIONS; i++)
            if (plant_prepares(of, (enum interpolation)i))
                good = add_entry(making, &sensors, (enum interpolation)i, &task, &gp);
        if (good && of->directed)
            good = add_transport(making, &sensors, &mesh, anchors);
        mem_free(anchors);
        influence_bend_finish(&bend);
        influence_mesh_finish(&mesh);
    }
    group_sensors_finish(&sensors);
    return good;
}

static uint64_t padded(uint64_t bytes)
{
    return (bytes + 7) / 8 * 8;
}

/* Writes all arrays to the influence file, each padded to 8 bytes. Returns 0 or -errno. */
static int write_file(struct influence_making *making)
{
    static const char zeros[8];
    const struct influence_input *input = making->input;
    struct atomic_file_part *parts = mem_array(2 + 5 * making->header.entry_count, sizeof(*parts));
    size_t count = 0;
    uint64_t at = sizeof(making->header) + making->header.entry_count * sizeof(*making->entries);
    parts[count++] = (struct atomic_file_part){ &making->header, sizeof(making->header) };
    parts[count++] = (struct atomic_file_part){ making->entries, making->header.entry_count * sizeof(*making->entries) };
    for (uint32_t i = 0; i < making->header.entry_count; i++) {
        struct influence_entry *entry = &making->entries[i];
        const uint64_t sensors = entry->sensor_count, squares = 8 * sensors * sensors, shares = 4 * sensors * input->vertex_count;
        entry->precision = at;
        entry->shares = at + squares;
        at += squares + padded(shares);
        const uint64_t deviations = making->found[i].deviations ? padded(8 * input->vertex_count) : 0;
        entry->deviations = deviations ? at : 0;
        at += deviations;
        parts[count++] = (struct atomic_file_part){ making->found[i].precision, squares };
        parts[count++] = (struct atomic_file_part){ making->found[i].shares, shares };
        parts[count++] = (struct atomic_file_part){ zeros, padded(shares) - shares };
        if (deviations)
            parts[count++] = (struct atomic_file_part){ making->found[i].deviations, deviations };
        const uint64_t errors = making->found[i].errors ? padded(4 * input->vertex_count) : 0;
        entry->errors = errors ? at : 0;
        at += errors;
        if (errors)
            parts[count++] = (struct atomic_file_part){ making->found[i].errors, errors };
    }
    char *path = folder_influence_path(input->folder, input->key);
    int status = cache_file_write_parts(path, INFLUENCE_MAGIC, input->key, parts, count);
    mem_free(path);
    mem_free(parts);
    return status;
}

bool influence_file_make(struct log *log, struct workers *workers, const struct influence_input *input, char why[200])
{
    struct influence_making making = { .log = log, .workers = workers, .input = input };
    making.header.vertex_count = (uint32_t)input->vertex_count;
    making.embedding = vertex_embedding_create(input->surface, input->positions_m, input->normals, input->vertex_count, input->triangles,
                                               input->levels[0].triangle_count);
    bool good = making.embedding;
    for (size_t g = 0; good && g < input->plant->group_count; g++)
        good = add_group(&making, (int)g);
    int status = good ? write_file(&making) : 0;
    if (!good)
        snprintf(why, 200,
                 "cannot compute the weights of %zu sensors at %zu vertices, so the asset cannot be prepared: see the messages above",
                 input->sensor_count, input->vertex_count);
    else if (status != 0)
        snprintf(why, 200, "cannot write the weights of the asset's sensors to the folder %.80s: %s", input->folder, strerror(-status));
    for (uint32_t i = 0; i < making.header.entry_count; i++)
        influence_finish(&making.found[i]);
    vertex_embedding_destroy(&making.embedding);
    cloud_heat_destroy(&making.cloud);
    mem_free(making.entries);
    mem_free(making.found);
    return good && status == 0;
}

bool influence_file_good(const char *folder, uint64_t key, char why[CACHE_FILE_WHY_BYTES])
{
    struct cache_file file;
    char *path = folder_influence_path(folder, key);
    bool good = cache_file_open(&file, path, INFLUENCE_MAGIC, key, why);
    if (good)
        cache_file_close(&file);
    mem_free(path);
    return good;
}
