/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Prepares all assets of a plant: computes keys, checks existing asset files, and builds the rest, one batch of models at a time. */
#include "preprocess/influence/influence_file.h"
#include "preprocess/pipeline/prepare.h"

#include <errno.h>
#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include "base/clock.h"
#include "base/mem.h"
#include "base/system/service_manager.h"
#include "plant/recipe.h"
#include "preprocess/cache/model_cache.h"
#include "preprocess/cache/folder.h"
#include "preprocess/pipeline/progress.h"
#include "preprocess/pipeline/sensor_distances.h"
#include "preprocess/pipeline/build_report_json.h"

/* A sensor farther from the surface than FAR_M metres, or than this share of the asset's size, causes a warning. */
#define FAR_M 0.25
#define FAR_OF_SIZE 0.05

/* minimum number of triangles in a batch: models are parsed until their assets have this many; then these assets are built */
#define BATCH_TRIANGLES 4e6
/* assets with more triangles are built one at a time on all cores, because two at a time would need twice the memory */
#define ALONE_TRIANGLES 1e6
/* for estimating the remaining time: cost of an asset's first sensor, as the number of triangles that take equally long to build */
#define SENSORS_WORK 6e4

struct prepare_run {
    struct prepare *prepare;
    struct log *log;
    struct workers *workers;
    const struct prepare_params *params;
    size_t *todo; /* indices of the assets to build, grouped by model */
    size_t todo_count, batch_begin, batch_end;
    struct model_cache known, cuts; /* model caches: of the last run (known), and for the next run (cuts) */
    /* triangles of the models that were parsed to compute keys and stay in memory until their assets are built */
    double parsed_triangles;
    pthread_mutex_t lock;
    /* --- members below: protected by `lock` */
    struct diag *diag;
    struct progress progress;
    /* failed: an error occurred; unusable: an error occurred that is not a model's fault, so the manifest is not written */
    bool failed, unusable;
};

struct geometry_params prepare_geometry(const struct plant_asset *asset)
{
    return (struct geometry_params){ .nodes = asset->nodes, .unit_m = asset->unit_m, .up = asset->up, .tolerance_m = asset->tolerance_m };
}

double prepare_far_m(double diagonal_m)
{
    return fmin(FAR_M, FAR_OF_SIZE * diagonal_m);
}

static void fail(struct prepare_run *run, const char *file, int line, const char *fmt, ...) __attribute__((format(printf, 4, 5)));
static void fail(struct prepare_run *run, const char *file, int line, const char *fmt, ...)
{
    va_list ap;
    char text[MODEL_WHY_BYTES + 200];
    va_start(ap, fmt);
    vsnprintf(text, sizeof(text), fmt, ap);
    va_end(ap);
    diag_error(run->diag, file, line, 0, "%s", text);
    run->failed = true;
}

static void fail_asset(struct prepare_run *run, const struct prepare_asset *asset, const char *why)
{
    fail(run, run->prepare->plant->files.path, asset->plant->line, "asset %s: %s: %s", asset->plant->id, asset->plant->model, why);
}

/* Marks an asset as failed because its model is invalid, or lacks something that the plant refers to. */
static void lose(struct prepare_asset *asset, const char *why)
{
    asset->state = PREPARE_FAILED;
    asset->missing = mem_strdup(why);
}

static bool is_stopped(const struct prepare_run *run)
{
    return run->params->stop && atomic_load(run->params->stop);
}

/* --- keys ------------------------------------------------------------------------------------------------------------------- */

static bool is_possible(const struct prepare_run *run, const struct prepare_asset *asset)
{
    return asset->wanted && asset->state != PREPARE_FAILED && asset->model < run->prepare->models.count;
}

static size_t first_with_key(const struct prepare_run *run, size_t i)
{
    const struct prepare_asset *assets = run->prepare->assets;
    for (size_t j = 0; j < i; j++)
        if (assets[j].key == assets[i].key && is_possible(run, &assets[j]))
            return j;
    return i;
}

/* Gets an asset's geometry hash and its sensors' positions from the model cache. Returns false if the model must be parsed instead. */
static bool recall_cut(struct prepare_run *run, struct prepare_asset *asset, uint64_t *geometry)
{
    bool known = model_cache_find(&run->known, asset->recipe, geometry);
    for (size_t s = 0; s < asset->sensor_count && known; s++)
        if (asset->sensors[s].node)
            known = model_cache_find_node(&run->known, asset->recipe, asset->sensors[s].node_hash, asset->sensors[s].position_m);
    return known;
}

static double all_triangles(const struct gltf_model *model)
{
    double corners = 0;
    for (uint32_t p = 0; p < model->primitive_count; p++)
        corners += (double)model->primitives[p].index_count;
    return corners / 3;
}

/* Parses the model unless it is parsed already. Returns false on failure; reports the error only once. */
static bool have_parsed(struct prepare_run *run, struct model_file *model)
{
    if (model->is_parsed || !model->good)
        return model->good;
    if (!model_file_parse(model)) {
        model->good = false;
        fail(run, run->prepare->plant->files.path, model->line, "%s: %s", model->path, model->why);
    }
    return model->good;
}

static bool look_up_cut(struct prepare_run *run, struct prepare_asset *asset, uint64_t *geometry)
{
    struct model_file *model = &run->prepare->models.at[asset->model];
    struct geometry_params params = prepare_geometry(asset->plant);
    char why[MODEL_WHY_BYTES];
    if (!have_parsed(run, model)) {
        lose(asset, model->why);
        return false;
    }
    if (!geometry_hash(geometry, &model->parsed, &params, why)) {
        fail_asset(run, asset, why);
        lose(asset, why);
        return false;
    }
    for (size_t s = 0; s < asset->sensor_count; s++) {
        struct plant_sensor *sensor = &asset->sensors[s];
        const struct plant_tag *tag = &run->prepare->plant->tags[sensor->tag];
        if (!sensor->node || geometry_node_place(&model->parsed, &params, sensor->node, sensor->position_m, why))
            continue;
        fail(run, run->prepare->plant->files.tags_path, tag->line, "tag %s: asset %s: %s", tag->name, asset->plant->id, why);
        if (!asset->missing)
            lose(asset, why);
    }
    return asset->state != PREPARE_FAILED;
}

static void take_cut(struct prepare_run *run, struct prepare_asset *asset, uint64_t geometry)
{
    struct geometry_params params = prepare_geometry(asset->plant);
    asset->geometry_key = build_geometry_key(geometry, &params);
    asset->key = build_key(asset->geometry_key, run->prepare->plant, asset->sensors, asset->sensor_count);
    asset->distances_key = XXH3_64bits_withSeed(asset->plant->id, strlen(asset->plant->id), asset->geometry_key);
    model_cache_add(&run->cuts, asset->recipe, geometry);
    for (size_t s = 0; s < asset->sensor_count; s++)
        if (asset->sensors[s].node)
            model_cache_add_node(&run->cuts, asset->recipe, asset->sensors[s].node_hash, asset->sensors[s].position_m);
}

/* Computes the keys of one model's assets that are to be prepared. Keeps the parsed model in memory for building, unless there
 * are too many triangles in memory already. */
static void find_keys_of_model(struct prepare_run *run, size_t number)
{
    struct model_file *model = &run->prepare->models.at[number];
    for (size_t i = 0; i < run->prepare->asset_count && !is_stopped(run); i++) {
        struct prepare_asset *asset = &run->prepare->assets[i];
        struct geometry_params params = prepare_geometry(asset->plant);
        uint64_t geometry = 0;
        if (!asset->wanted || asset->model != number || !model->good)
            continue;
        asset->recipe = build_recipe(model->hash, &params);
        if (recall_cut(run, asset, &geometry) || look_up_cut(run, asset, &geometry))
            take_cut(run, asset, geometry);
    }
    if (!model->is_parsed)
        return;
    double triangles = all_triangles(&model->parsed);
    if (run->parsed_triangles + triangles > BATCH_TRIANGLES)
        model_file_release(model);
    else
        run->parsed_triangles += triangles;
}

static void find_keys(struct prepare_run *run)
{
    struct prepare *prepare = run->prepare;
    for (size_t i = 0; i < prepare->asset_count && !is_stopped(run); i++) {
        struct prepare_asset *asset = &prepare->assets[i];
        size_t known = prepare->models.count;
        if (!asset->wanted)
            continue;
        asset->model = model_files_add(&prepare->models, asset->plant);
        const struct model_file *model = &prepare->models.at[asset->model];
        asset->sensor_count = plant_sensors(prepare->plant, (int)i, &asset->sensors);
        if (!model->good && prepare->models.count > known)
            fail_asset(run, asset, model->why);
        if (!model->good)
            lose(asset, model->why);
    }
    for (size_t m = 0; m < prepare->models.count && !is_stopped(run); m++)
        find_keys_of_model(run, m);
    for (size_t i = 0; i < prepare->asset_count && !is_stopped(run); i++) {
        struct prepare_asset *asset = &prepare->assets[i];
        if (asset->wanted && asset->state != PREPARE_FAILED && !prepare->models.at[asset->model].good)
            lose(asset, prepare->models.at[asset->model].why);
        asset->same_as = first_with_key(run, i);
    }
}

/* --- checking the existing prepared files ----------------------------------------------------------------------------------------- */

/* Copies the numbers that the report and the warnings need from an existing, checked asset file. */
static void take_file(struct prepare_asset *asset, const struct asset_view *view)
{
    const struct asset_level *finest = &view->levels[0];
    double size2 = 0;
    asset->vertices = view->header->vertex_count;
    asset->triangles = 0;
    for (uint32_t p = 0; p < finest->primitive_count; p++)
        asset->triangles += view->primitives[finest->first_primitive + p].index_count / 3;
    for (int axis = 0; axis < 3; axis++) {
        double side = (double)view->header->bounds_max_m[axis] - (double)view->header->bounds_min_m[axis];
        size2 += side * side;
        asset->size_m[axis] = side;
    }
    asset->far_m = prepare_far_m(sqrt(size2));
    asset->surface_distances_m = mem_array(asset->sensor_count, sizeof(*asset->surface_distances_m));
    for (size_t s = 0; s < asset->sensor_count && s < view->header->sensor_count; s++)
        asset->surface_distances_m[s] = view->sensors[s].surface_distance_m;
}

static void take_report(const struct prepare_run *run, struct prepare_asset *asset)
{
    json_t *numbers = folder_report(run->log, run->params->folder, asset->key);
    asset->reported = numbers && build_report_from_json(numbers, &asset->report);
    json_decref(numbers);
}

/* Opens the asset's prepared file and checks its influence file, if the asset needs one. Returns the same values as
 * folder_open(). If a file is damaged, *damaged receives its path and what is wrong with it; the caller frees the text. */
static int open_prepared(const struct prepare_run *run, const struct prepare_asset *asset, struct folder_file *file, char **damaged)
{
    const char *folder = run->params->folder;
    char why[CACHE_FILE_WHY_BYTES], *path = folder_asset_path(folder, asset->key);
    int found = folder_open(file, folder, asset->key, why);
    if (found == 1 && influence_is_wanted(run->prepare->plant, asset->sensors, asset->sensor_count) &&
        !influence_file_good(folder, asset->key, why)) {
        folder_close(file);
        mem_free(path);
        path = folder_influence_path(folder, asset->key);
        found = -1;
    }
    if (found < 0)
        *damaged = mem_printf("%s: %s", path, why);
    mem_free(path);
    return found;
}

static void look_at_some(void *arg, size_t begin, size_t end)
{
    struct prepare_run *run = arg;
    for (size_t i = begin; i < end && !is_stopped(run); i++) {
        struct prepare_asset *asset = &run->prepare->assets[i];
        struct folder_file file;
        if (!is_possible(run, asset) || asset->same_as != i)
            continue;
        if (open_prepared(run, asset, &file, &asset->rebuilt_because) != 1)
            continue;
        take_file(asset, &file.view);
        take_report(run, asset);
        asset->state = PREPARE_UNCHANGED;
        folder_close(&file);
    }
}

/* Determines which assets have an up-to-date file and which must be built, and groups the latter by model. */
static void sort_out(struct prepare_run *run)
{
    struct prepare *prepare = run->prepare;
    size_t own = 0;
    workers_for(run->workers, prepare->asset_count, 1, look_at_some, run);
    for (size_t m = 0; m < prepare->models.count; m++)
        for (size_t i = 0; i < prepare->asset_count; i++) {
            const struct prepare_asset *asset = &prepare->assets[i];
            if (!is_possible(run, asset) || asset->model != m || asset->same_as != i)
                continue;
            own++;
            if (asset->state != PREPARE_UNCHANGED)
                run->todo[run->todo_count++] = i;
        }
    progress_begin(&run->progress, run->params->progress, own, own - run->todo_count, clock_mono_ns());
}

/* --- building --------------------------------------------------------------------------------------------------------------- */

static int write_file(const struct prepare_run *run, const struct prepare_asset *asset, struct build_output *output)
{
    json_t *numbers = build_report_to_json(&output->report);
    char *report = numbers ? json_dumps(numbers, JSON_COMPACT | JSON_REAL_PRECISION(9)) : NULL;
    int status = folder_put(&output->file, run->params->folder, asset->key, report);
    free(report);
    json_decref(numbers);
    return status;
}

/* Reports the result of building an asset. Returns false if building failed. The caller holds run->lock. */
static bool is_built(struct prepare_run *run, const struct prepare_asset *asset, bool good, int status, const char *why)
{
    if (!good)
        fail_asset(run, asset, why);
    else if (status != 0)
        fail(run, run->prepare->plant->files.path, asset->plant->line, "asset %s: %s cannot be written: %s", asset->plant->id,
             run->params->folder, strerror(-status));
    return good && status == 0;
}

/* Sends the progress to the service manager as a status line. The caller holds run->lock. */
static void say_status(struct prepare_run *run)
{
    const struct progress *progress = &run->progress;
    char *text = mem_printf("preparing the plant: %zu of %zu assets", progress->there + progress->done, progress->total);
    service_patience_status(run->params->patience, text);
    mem_free(text);
}

static void build_one(struct prepare_run *run, struct prepare_asset *asset)
{
    struct build_input input = { .model = &run->prepare->models.at[asset->model].parsed,
                                 .geometry = prepare_geometry(asset->plant),
                                 .plant = run->prepare->plant,
                                 .sensors = asset->sensors,
                                 .sensor_count = asset->sensor_count,
                                 .key = asset->key,
                                 .cache = asset->cache.parts.bytes ? &asset->cache : NULL,
                                 .folder = run->params->folder,
                                 .geometry_key = asset->geometry_key,
                                 .distances_key = asset->distances_key };
    struct build_output output;
    char why[MODEL_WHY_BYTES];
    int64_t start_ns = clock_mono_ns();
    bool good = build_asset(run->log, run->workers, &input, &output, why);
    int status = good ? write_file(run, asset, &output) : 0;
    if (good)
        take_file(asset, &output.view);
    folder_draft_close(&output.file);
    geometry_cache_close(&asset->cache);
    asset->reported = good;
    asset->report = output.report;
    asset->seconds = (double)(clock_mono_ns() - start_ns) / NS_PER_S;
    pthread_mutex_lock(&run->lock);
    asset->state = is_built(run, asset, good, status, why) ? PREPARE_BUILT : PREPARE_FAILED;
    run->unusable |= good && status != 0;
    if (!good)
        asset->missing = mem_strdup(why);
    progress_step(&run->progress, asset->work, clock_mono_ns());
    say_status(run);
    pthread_mutex_unlock(&run->lock);
}

static void build_some(void *arg, size_t begin, size_t end)
{
    struct prepare_run *run = arg;
    for (size_t i = begin; i < end; i++) {
        if (!is_stopped(run))
            build_one(run, &run->prepare->assets[run->todo[run->batch_begin + i]]);
    }
}

static int heavier_first(const void *a, const void *b, void *arg)
{
    const struct prepare_run *run = arg;
    size_t i = *(const size_t *)a, j = *(const size_t *)b;
    double p = run->prepare->assets[i].work, q = run->prepare->assets[j].work;
    return p == q ? (i < j ? -1 : 1) : p > q ? -1 : 1;
}

/* Opens an asset's geometry cache. Returns false if the model must be parsed instead. */
static bool find_stock(const struct prepare_run *run, struct prepare_asset *asset)
{
    return asset->sensor_count > 0 && geometry_cache_open(&asset->cache, run->log, run->params->folder, asset->geometry_key);
}

static double own_triangles(const struct prepare_asset *asset, const struct model_file *model)
{
    struct geometry_params geometry = prepare_geometry(asset->plant);
    return asset->cache.parts.bytes ? asset->cache.report.triangles : (double)geometry_triangles(&model->parsed, &geometry);
}

/* Parses the models of the assets in todo[], from index batch_begin on, until there is enough work for a batch
 * (BATCH_TRIANGLES). Assets whose model cannot be parsed fail. */
static void parse_batch(struct prepare_run *run)
{
    struct prepare *prepare = run->prepare;
    double triangles = 0;
    run->batch_end = run->batch_begin;
    while (run->batch_end < run->todo_count && !is_stopped(run)) {
        struct prepare_asset *asset = &prepare->assets[run->todo[run->batch_end]];
        struct model_file *model = &prepare->models.at[asset->model];
        bool fresh = run->batch_end == 0 || prepare->assets[run->todo[run->batch_end - 1]].model != asset->model;
        if (fresh && triangles > BATCH_TRIANGLES)
            break;
        if (!find_stock(run, asset))
            have_parsed(run, model);
        if (!model->good) {
            lose(asset, model->why);
        } else {
            double own = own_triangles(asset, model);
            asset->work = own + (sensor_distances_matter(prepare->plant, asset->sensors, asset->sensor_count) ? SENSORS_WORK : 0);
            triangles += own;
        }
        progress_expect(&run->progress, asset->work);
        run->batch_end++;
    }
}

/* Builds the batch's assets that have a valid model: large assets one after the other, small ones in parallel. */
static void build_batch(struct prepare_run *run)
{
    struct prepare *prepare = run->prepare;
    size_t *todo = run->todo + run->batch_begin, count = 0;
    for (size_t i = run->batch_begin; i < run->batch_end; i++)
        if (prepare->models.at[prepare->assets[run->todo[i]].model].good)
            todo[count++] = run->todo[i];
    qsort_r(todo, count, sizeof(*todo), heavier_first, run);
    size_t alone = 0, begin = run->batch_begin;
    while (alone < count && prepare->assets[todo[alone]].work > ALONE_TRIANGLES)
        alone++;
    for (size_t i = 0; i < alone; i++)
        build_some(run, i, i + 1);
    run->batch_begin += alone;
    workers_for(run->workers, count - alone, 1, build_some, run);
    run->batch_begin = begin;
    for (size_t i = 0; i < count; i++)
        model_file_release(&prepare->models.at[prepare->assets[todo[i]].model]);
}

static void build_all(struct prepare_run *run)
{
    for (run->batch_begin = 0; run->batch_begin < run->todo_count; run->batch_begin = run->batch_end) {
        parse_batch(run);
        if (run->batch_end == run->batch_begin)
            break;
        build_batch(run);
    }
    progress_end(&run->progress);
}

/* --- the end ---------------------------------------------------------------------------------------------------------------- */

static void share(struct prepare_run *run)
{
    const struct prepare *prepare = run->prepare;
    for (size_t i = 0; i < prepare->asset_count; i++) {
        struct prepare_asset *asset = &prepare->assets[i];
        const struct prepare_asset *first = &prepare->assets[asset->same_as];
        if (!is_possible(run, asset) || first == asset)
            continue;
        asset->state = first->state == PREPARE_FAILED || first->state == PREPARE_LEFT ? first->state : PREPARE_SHARED;
        if (first->missing && !asset->missing)
            asset->missing = mem_strdup(first->missing);
        if (!first->surface_distances_m)
            continue;
        asset->triangles = first->triangles;
        asset->vertices = first->vertices;
        asset->far_m = first->far_m;
        memcpy(asset->size_m, first->size_m, sizeof(asset->size_m));
        asset->reported = first->reported;
        asset->report = first->report;
        asset->surface_distances_m = mem_array(asset->sensor_count, sizeof(*asset->surface_distances_m));
        /* copies the sensors' distances from the surface from the first asset with this key: assets with equal keys have equal
           sensors */
        for (size_t s = 0; s < asset->sensor_count; s++)
            asset->surface_distances_m[s] = first->surface_distances_m[s];
    }
}

static void warn(struct prepare_run *run, const struct prepare_asset *asset)
{
    const struct plant *plant = run->prepare->plant;
    if (asset->rebuilt_because)
        diag_warning(run->diag, plant->files.path, asset->plant->line, 0, "asset %s: the prepared file is unusable and will be rebuilt "
                                                                          "(%s)",
                     asset->plant->id, asset->rebuilt_because);
    for (size_t s = 0; asset->surface_distances_m && s < asset->sensor_count; s++) {
        const struct plant_tag *tag = &plant->tags[asset->sensors[s].tag];
        double distance_m = (double)asset->surface_distances_m[s];
        if (distance_m > asset->far_m)
            diag_warning(run->diag, plant->files.tags_path, tag->line, 0,
                         "tag %s: the sensor is %.3f m from the surface of asset %s (limit: %.3f m)", tag->name, distance_m,
                         asset->plant->id, asset->far_m);
    }
}

/* Writes the model cache. Keeps the entries of assets that this run does not prepare. Ignores errors: the next run then only
 * takes longer. */
static void write_cuts(struct prepare_run *run)
{
    bool all = !run->params->only && !run->prepare->interrupted;
    for (size_t i = 0; i < run->known.count && !all; i++)
        model_cache_add(&run->cuts, run->known.at[i].recipe, run->known.at[i].geometry);
    for (size_t i = 0; i < run->known.node_count && !all; i++)
        model_cache_add_node(&run->cuts, run->known.nodes[i].recipe, run->known.nodes[i].node_hash, run->known.nodes[i].place_m);
    if (!model_cache_same(&run->cuts, &run->known))
        model_cache_write(&run->cuts, run->params->folder);
}

static bool any_good(const struct prepare *prepare)
{
    for (size_t i = 0; i < prepare->asset_count; i++)
        if (prepare->assets[i].state != PREPARE_FAILED)
            return true;
    return false;
}

/* Lists the textures and extensions of the asset's model that are not drawn; NULL if this run did not parse the model. Only a
 * model's first asset gets the texts, because a plant may have thousands of assets of the same model. */
static void name_left_out(const struct prepare *prepare, size_t index, struct folder_entry *entry)
{
    static const char *const none[] = { NULL };
    const struct model_file *model = &prepare->models.at[prepare->assets[index].model];
    size_t first = 0;
    while (prepare->assets[first].model != prepare->assets[index].model)
        first++;
    if (first != index || (model->was_parsed && !model->left_out))
        entry->left_out = none;
    else if (model->was_parsed) {
        entry->left_out = (const char *const *)model->left_out;
        entry->left_out_count = model->left_out_textures;
    }
}

/* Returns the hash of the other files that the pictures depend on: panoramas, and the readings to which interpolations are fitted;
   0: the plant file names none. An unreadable file counts as an empty one: the code that uses the file reports the error. */
static uint64_t hash_named_files(const struct plant *plant)
{
    uint64_t *hashes = mem_array(plant->group_count + plant->display.environment_count + 1, sizeof(*hashes)), hash = 0;
    size_t count = 0;
    for (size_t g = 0; g < plant->group_count; g++)
        if (plant->groups[g].gp.fit && !plant_model_hash(plant->groups[g].gp.fit, &hashes[count++]))
            hashes[count - 1] = 0;
    for (size_t e = 0; e < plant->display.environment_count; e++)
        if (!plant_model_hash(plant->display.environments[e].path, &hashes[count++]))
            hashes[count - 1] = 0;
    if (count)
        hash = XXH3_64bits(hashes, count * sizeof(*hashes));
    mem_free(hashes);
    return hash;
}

static void write_manifest(struct prepare_run *run)
{
    struct prepare *prepare = run->prepare;
    struct folder_entry *entries = mem_array(prepare->asset_count, sizeof(*entries));
    uint64_t named = hash_named_files(prepare->plant);
    /* an array for the tags of all assets together: one element per tag suffices, because a tag is a sensor of at most one
       asset */
    const char **tags = mem_array(prepare->plant->tag_count, sizeof(*tags)), **next = tags;
    for (size_t i = 0; i < prepare->asset_count; i++) {
        const struct prepare_asset *asset = &prepare->assets[i];
        for (size_t s = 0; s < asset->sensor_count; s++)
            next[s] = prepare->plant->tags[asset->sensors[s].tag].name;
        entries[i] = (struct folder_entry){ .id = asset->plant->id,
                                            .key = asset->key,
                                            .geometry_key = asset->geometry_key,
                                            .distances_key = asset->distances_key,
                                            .recipe = plant_recipe(asset->plant, prepare->models.at[asset->model].file_hash),
                                            .model = prepare->models.at[asset->model].hash ^ named,
                                            .cuts = plant_cuts_recipe(prepare->plant, asset->sensors, asset->sensor_count),
                                            .placement = asset->plant->placement,
                                            .missing = asset->missing,
                                            .tags = next,
                                            .tag_count = asset->sensor_count };
        name_left_out(prepare, i, &entries[i]);
        next += asset->sensor_count;
    }
    int status = folder_finish(run->log, run->params->folder, entries, prepare->asset_count, run->failed ? NULL : &prepare->removed);
    if (status != 0)
        fail(run, prepare->plant->files.path, 0, "%s: this list of the prepared files (manifest) cannot be written: %s",
             run->params->folder, strerror(-status));
    mem_free(entries);
    mem_free(tags);
}

bool prepare_run(struct prepare *prepare, struct log *log, struct workers *workers, const struct plant *plant,
                 const struct prepare_params *params, struct diag *diag)
{
    struct prepare_run run = { .prepare = prepare, .log = log, .workers = workers, .params = params, .diag = diag };
    int64_t start_ns = clock_mono_ns();
    *prepare = (struct prepare){ .plant = plant, .asset_count = plant->asset_count };
    prepare->assets = mem_array(plant->asset_count, sizeof(*prepare->assets));
    run.todo = mem_array(plant->asset_count, sizeof(*run.todo));
    pthread_mutex_init(&run.lock, NULL);
    for (size_t i = 0; i < plant->asset_count; i++)
        prepare->assets[i] =
            (struct prepare_asset){ .plant = &plant->assets[i], .wanted = !params->only || strcmp(plant->assets[i].id, params->only) == 0 };
    if (mkdir(params->folder, 0777) != 0 && errno != EEXIST)
        fail(&run, plant->files.path, 0, "%s: cannot be created: %s", params->folder, strerror(errno));
    int lock = run.failed ? -1 : folder_lock(params->folder, log, params->stop);
    if (!run.failed) {
        model_cache_read(&run.known, log, params->folder);
        find_keys(&run);
        sort_out(&run);
        build_all(&run);
        share(&run);
        for (size_t i = 0; i < prepare->asset_count; i++)
            warn(&run, &prepare->assets[i]);
    }
    prepare->interrupted = is_stopped(&run);
    if (lock >= 0)
        write_cuts(&run);
    if (lock >= 0 && !run.unusable && !params->only && !prepare->interrupted && any_good(prepare))
        write_manifest(&run);
    model_cache_finish(&run.known);
    model_cache_finish(&run.cuts);
    if (lock >= 0)
        close(lock);
    prepare->seconds = (double)(clock_mono_ns() - start_ns) / NS_PER_S;
    pthread_mutex_destroy(&run.lock);
    mem_free(run.todo);
    return !run.failed && !prepare->interrupted;
}

void prepare_finish(struct prepare *prepare)
{
    for (size_t i = 0; i < prepare->asset_count; i++) {
        geometry_cache_close(&prepare->assets[i].cache);
        mem_free(prepare->assets[i].sensors);
        mem_free(prepare->assets[i].surface_distances_m);
        mem_free(prepare->assets[i].rebuilt_because);
        mem_free(prepare->assets[i].missing);
    }
    mem_free(prepare->assets);
    model_files_finish(&prepare->models);
    *prepare = (struct prepare){ 0 };
}
