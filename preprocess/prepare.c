/* SPDX-License-Identifier: GPL-3.0-or-later */
/* All assets of a plant: keys, what is there already, and building the rest model by model. */
#include "preprocess/prepare.h"

#include <errno.h>
#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/clock.h"
#include "base/mem.h"
#include "plant/recipe.h"
#include "preprocess/folder.h"

#define FAR_M 0.25       /* a sensor farther from its surface than this, */
#define FAR_OF_SIZE 0.05 /* or than this share of the asset, is worth a warning */

struct model { /* one model file; parsed once, while its assets are built */
    const char *path;
    int line; /* in the plant file, of the first asset that names it */
    struct model_source source;
    uint64_t file_hash; /* of the file itself, for the manifest */
    bool good;
};

struct run {
    struct prepare *prepare;
    struct log *log;
    struct workers *workers;
    const struct prepare_params *params;
    struct model *models;
    size_t model_count;
    size_t *asset_model;
    struct gltf_model *parsed; /* of the model in hand */
    size_t *todo;              /* assets to build from it */
    size_t todo_count;
    pthread_mutex_t lock;
    /* --- below: under lock */
    struct diag *diag;
    size_t finished;
    bool failed;
};

static struct geometry_params geometry_params_of(const struct plant_asset *asset)
{
    return (struct geometry_params){ .nodes = asset->nodes, .unit_m = asset->unit_m, .up = asset->up };
}

static void fail(struct run *run, const char *file, int line, const char *fmt, ...) __attribute__((format(printf, 4, 5)));
static void fail(struct run *run, const char *file, int line, const char *fmt, ...)
{
    va_list ap;
    char text[MODEL_WHY_BYTES + 200];
    va_start(ap, fmt);
    vsnprintf(text, sizeof(text), fmt, ap);
    va_end(ap);
    diag_error(run->diag, file, line, 0, "%s", text);
    run->failed = true;
}

static void fail_asset(struct run *run, const struct prepare_asset *asset, const char *why)
{
    fail(run, run->prepare->plant->path, asset->plant->line, "asset %s: %s: %s", asset->plant->id, asset->plant->model, why);
}

/* --- models and keys ------------------------------------------------------------------------------------------------------ */

static size_t model_of(struct run *run, const struct plant_asset *asset)
{
    for (size_t i = 0; i < run->model_count; i++)
        if (strcmp(run->models[i].path, asset->model) == 0)
            return i;
    struct model *model = &run->models[run->model_count];
    char why[MODEL_WHY_BYTES];
    *model = (struct model){ .path = asset->model, .line = asset->line };
    model->good = model_source_open(&model->source, asset->model, why);
    if (!model->good)
        fail(run, run->prepare->plant->path, asset->line, "asset %s: %s: %s", asset->id, asset->model, why);
    else if (!plant_model_hash(asset->model, &model->file_hash))
        fail(run, run->prepare->plant->path, asset->line, "asset %s: %s: %s", asset->id, asset->model, strerror(errno));
    return run->model_count++;
}

static void find_keys(struct run *run)
{
    for (size_t i = 0; i < run->prepare->asset_count; i++) {
        struct prepare_asset *asset = &run->prepare->assets[i];
        if (run->params->only && strcmp(asset->plant->id, run->params->only) != 0)
            continue;
        size_t model = run->asset_model[i] = model_of(run, asset->plant);
        struct geometry_params geometry = geometry_params_of(asset->plant);
        asset->sensor_count = plant_sensors(run->prepare->plant, (int)i, &asset->sensors);
        if (run->models[model].good)
            asset->key = build_key(run->models[model].source.hash, &geometry, run->prepare->plant, asset->sensors, asset->sensor_count);
    }
}

/* --- what is in the folder -------------------------------------------------------------------------------------------------- */

/* Takes from a checked file what the summary, the warnings and the report need. */
static void take_file(struct prepare_asset *asset, const struct asset_view *view)
{
    const struct asset_level *finest = &view->levels[0];
    asset->vertices = view->header->vertex_count;
    asset->triangles = 0;
    for (uint32_t p = 0; p < finest->primitive_count; p++)
        asset->triangles += view->primitives[finest->first_primitive + p].index_count / 3;
    asset->surface_distances_m = mem_array(asset->sensor_count, sizeof(*asset->surface_distances_m));
    for (size_t s = 0; s < asset->sensor_count && s < view->header->sensor_count; s++)
        asset->surface_distances_m[s] = view->sensors[s].surface_distance_m;
}

static void warn_of_far_sensors(struct run *run, const struct prepare_asset *asset, const struct asset_view *view)
{
    const struct plant *plant = run->prepare->plant;
    double size2 = 0;
    for (int axis = 0; axis < 3; axis++) {
        double side = (double)view->header->bounds_max_m[axis] - (double)view->header->bounds_min_m[axis];
        size2 += side * side;
    }
    double limit_m = fmin(FAR_M, FAR_OF_SIZE * sqrt(size2));
    for (size_t s = 0; s < asset->sensor_count; s++) {
        const struct plant_tag *tag = &plant->tags[asset->sensors[s].tag];
        double distance_m = (double)asset->surface_distances_m[s];
        if (distance_m > limit_m)
            diag_warning(run->diag, plant->tags_path, tag->line, 0, "tag %s: %.3f m from the surface of asset %s (more than %.3f m)",
                         tag->name, distance_m, asset->plant->id, limit_m);
    }
}

/* The asset's line on the terminal, and its warnings. Under lock. */
static void finish_asset(struct run *run, struct prepare_asset *asset)
{
    static const char *const words[] = { "failed", "unchanged", "shared", "built" };
    struct folder_file file;
    char why[200];
    if (asset->state != PREPARE_FAILED && folder_open(&file, run->params->folder, asset->key, why) == 1) {
        take_file(asset, &file.view);
        warn_of_far_sensors(run, asset, &file.view);
        folder_close(&file);
    }
    run->finished++;
    size_t total = run->params->only ? 1 : run->prepare->asset_count;
    if (run->params->progress && asset->state != PREPARE_UNCHANGED) {
        fprintf(run->params->progress, "%3zu %%  %zu/%zu  %-16s %-9s %8u triangles %7u vertices %4zu sensors %6.2f s%s%s%s\n",
                100 * run->finished / total, run->finished, total, asset->plant->id, words[asset->state], asset->triangles, asset->vertices,
                asset->sensor_count, asset->seconds, asset->rebuilt_because ? " (the file there was no good: " : "",
                asset->rebuilt_because ? asset->rebuilt_because : "", asset->rebuilt_because ? ")" : "");
        fflush(run->params->progress);
    }
}

static bool is_wanted(const struct run *run, size_t i)
{
    const struct prepare_asset *asset = &run->prepare->assets[i];
    return !run->params->only || strcmp(asset->plant->id, run->params->only) == 0;
}

/* The first asset with the same key, which then builds for all. */
static size_t first_with_key(const struct run *run, size_t i)
{
    for (size_t j = 0; j < i; j++)
        if (is_wanted(run, j) && run->models[run->asset_model[j]].good && run->prepare->assets[j].key == run->prepare->assets[i].key)
            return j;
    return i;
}

static bool is_there(struct run *run, struct prepare_asset *asset)
{
    struct folder_file file;
    char why[200];
    int found = folder_open(&file, run->params->folder, asset->key, why);
    if (found == 1)
        folder_close(&file);
    if (found < 0)
        asset->rebuilt_because = mem_strdup(why);
    return found == 1;
}

/* --- building --------------------------------------------------------------------------------------------------------------- */

static void build_one(struct run *run, struct prepare_asset *asset)
{
    struct build_input input = { .model = run->parsed,
                                 .geometry = geometry_params_of(asset->plant),
                                 .plant = run->prepare->plant,
                                 .sensors = asset->sensors,
                                 .sensor_count = asset->sensor_count,
                                 .key = asset->key };
    struct build_output output;
    char why[MODEL_WHY_BYTES];
    int64_t start_ns = clock_mono_ns();
    bool good = build_asset(run->log, run->workers, &input, &output, why);
    int status = good ? folder_write(run->params->folder, asset->key, output.bytes, output.size) : 0;
    asset->seconds = (double)(clock_mono_ns() - start_ns) / NS_PER_S;
    free(output.bytes);
    pthread_mutex_lock(&run->lock);
    const struct plant *plant = run->prepare->plant;
    if (!good && output.missing_node >= 0) {
        const struct plant_tag *tag = &plant->tags[asset->sensors[output.missing_node].tag];
        fail(run, plant->tags_path, tag->line, "tag %s: asset %s: %s", tag->name, asset->plant->id, why);
    } else if (!good) {
        fail_asset(run, asset, why);
    } else if (status != 0) {
        fail(run, plant->path, asset->plant->line, "asset %s: %s cannot be written: %s", asset->plant->id, run->params->folder,
             strerror(-status));
    } else {
        asset->state = PREPARE_BUILT;
        asset->report = output.report;
    }
    finish_asset(run, asset);
    pthread_mutex_unlock(&run->lock);
}

static void build_some(void *arg, size_t begin, size_t end)
{
    struct run *run = arg;
    for (size_t i = begin; i < end; i++)
        build_one(run, &run->prepare->assets[run->todo[i]]);
}

static int larger_first(const void *a, const void *b, void *arg)
{
    const struct run *run = arg;
    size_t p = run->prepare->assets[*(const size_t *)a].sensor_count, q = run->prepare->assets[*(const size_t *)b].sensor_count;
    return p == q ? (*(const size_t *)a < *(const size_t *)b ? -1 : 1) : p > q ? -1 : 1;
}

static void build_from(struct run *run, size_t model)
{
    struct gltf_model parsed;
    char why[MODEL_WHY_BYTES];
    run->todo_count = 0;
    for (size_t i = 0; i < run->prepare->asset_count; i++) {
        struct prepare_asset *asset = &run->prepare->assets[i];
        if (!is_wanted(run, i) || run->asset_model[i] != model)
            continue;
        if (first_with_key(run, i) != i) {
            asset->state = PREPARE_SHARED;
        } else if (is_there(run, asset)) {
            asset->state = PREPARE_UNCHANGED;
            finish_asset(run, asset);
        } else {
            run->todo[run->todo_count++] = i;
        }
    }
    if (run->todo_count == 0)
        return;
    if (!gltf_load(&parsed, &run->models[model].source, why)) {
        fail(run, run->prepare->plant->path, run->models[model].line, "%s: %s", run->models[model].path, why);
        return;
    }
    if (run->params->progress && (parsed.skipped_lines || parsed.skipped_points))
        fprintf(run->params->progress, "%s: %u primitives of lines and %u of points are skipped\n", run->models[model].path,
                parsed.skipped_lines, parsed.skipped_points);
    if (run->params->progress && parsed.left_out_textures)
        fprintf(run->params->progress, "%s: %u textures are left out, which lie otherwise than their material's first\n",
                run->models[model].path, parsed.left_out_textures);
    qsort_r(run->todo, run->todo_count, sizeof(*run->todo), larger_first, run);
    run->parsed = &parsed;
    workers_for(run->workers, run->todo_count, 1, build_some, run);
    run->parsed = NULL;
    gltf_free(&parsed);
}

static void finish_shared(struct run *run)
{
    for (size_t i = 0; i < run->prepare->asset_count; i++) {
        struct prepare_asset *asset = &run->prepare->assets[i];
        if (asset->state != PREPARE_SHARED)
            continue;
        if (run->prepare->assets[first_with_key(run, i)].state == PREPARE_FAILED)
            asset->state = PREPARE_FAILED;
        finish_asset(run, asset);
    }
}

static void write_manifest(struct run *run)
{
    struct prepare *prepare = run->prepare;
    struct folder_entry *entries = mem_array(prepare->asset_count, sizeof(*entries));
    for (size_t i = 0; i < prepare->asset_count; i++)
        entries[i] = (struct folder_entry){ .id = prepare->assets[i].plant->id,
                                            .key = prepare->assets[i].key,
                                            .recipe = plant_recipe(prepare->assets[i].plant, run->models[run->asset_model[i]].file_hash) };
    int status = folder_finish(run->params->folder, entries, prepare->asset_count, &prepare->removed);
    if (status != 0)
        fail(run, prepare->plant->path, 0, "%s: the manifest cannot be written: %s", run->params->folder, strerror(-status));
    mem_free(entries);
}

bool prepare_run(struct prepare *prepare, struct log *log, struct workers *workers, const struct plant *plant,
                 const struct prepare_params *params, struct diag *diag)
{
    struct run run = { .prepare = prepare, .log = log, .workers = workers, .params = params, .diag = diag };
    int64_t start_ns = clock_mono_ns();
    *prepare = (struct prepare){ .plant = plant, .asset_count = plant->asset_count };
    prepare->assets = mem_array(plant->asset_count, sizeof(*prepare->assets));
    run.models = mem_array(plant->asset_count, sizeof(*run.models));
    run.asset_model = mem_array(plant->asset_count, sizeof(*run.asset_model));
    run.todo = mem_array(plant->asset_count, sizeof(*run.todo));
    pthread_mutex_init(&run.lock, NULL);
    for (size_t i = 0; i < plant->asset_count; i++)
        prepare->assets[i].plant = &plant->assets[i];
    if (mkdir(params->folder, 0777) != 0 && errno != EEXIST)
        fail(&run, plant->path, 0, "%s: cannot be made: %s", params->folder, strerror(errno));
    if (!run.failed)
        find_keys(&run);
    for (size_t i = 0; i < run.model_count; i++) {
        if (run.models[i].good)
            build_from(&run, i);
        model_source_finish(&run.models[i].source);
    }
    finish_shared(&run);
    if (!run.failed && !params->only)
        write_manifest(&run);
    prepare->seconds = (double)(clock_mono_ns() - start_ns) / NS_PER_S;
    pthread_mutex_destroy(&run.lock);
    mem_free(run.models);
    mem_free(run.asset_model);
    mem_free(run.todo);
    return !run.failed;
}

void prepare_finish(struct prepare *prepare)
{
    for (size_t i = 0; i < prepare->asset_count; i++) {
        mem_free(prepare->assets[i].sensors);
        mem_free(prepare->assets[i].surface_distances_m);
        mem_free(prepare->assets[i].rebuilt_because);
    }
    mem_free(prepare->assets);
    *prepare = (struct prepare){ 0 };
}
