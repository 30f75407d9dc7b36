/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes a plant's scene from prepared asset files, after checking that they belong to this plant. */
#include "scene/scene_create.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <xxhash.h>

#include "base/mem.h"
#include "base/workers.h"
#include "plant/influence.h"
#include "plant/models/transform.h"
#include "plant/recipe.h"
#include "plant/sensors.h"
#include "scene/coincident.h"
#include "scene/extremes.h"
#include "scene/main_part.h"
#include "scene/manifest.h"

#define SAME_PLACE_M 1e-4

/* --- checks that a file belongs to the plant ---------------------------------------------------------------------------------------- */

/* Returns whether the prepared file and the plant have a sensor at the same position, or on the same model node. The tolerance
   grows with the distance from the file's origin, because the file has positions as floats relative to it. */
static bool same_place(const struct asset_header *header, const struct asset_sensor *in_file, const struct plant_sensor *in_plant)
{
    if (in_file->node_hash || in_plant->node)
        return in_file->node_hash == in_plant->node_hash;
    for (int i = 0; i < 3; i++) {
        double expected_m = in_plant->position_m[i] - header->origin_m[i];
        if (!(fabs(in_file->position_m[i] - expected_m) <= SAME_PLACE_M + fabs(expected_m) * 1e-6))
            return false;
    }
    return true;
}

static bool sensors_fit(struct log *log, const struct plant *plant, const struct scene_asset *asset, const struct plant_sensor *sensors,
                        size_t count)
{
    const struct asset_view *view = &asset->file->view;
    if (view->header->sensor_count != count) {
        log_err(log, "asset %s: the prepared file %s has %u sensors, but the tag list has %zu; run plantcast-prep again", asset->plant->id,
                asset->file->path, view->header->sensor_count, count);
        return false;
    }
    for (size_t i = 0; i < count; i++) {
        if (same_place(view->header, &view->sensors[i], &sensors[i]))
            continue;
        log_err(log, "asset %s: the tag list has another position for sensor %s than the prepared file %s; run plantcast-prep again",
                asset->plant->id, plant->tags[sensors[i].tag].name, asset->file->path);
        return false;
    }
    return true;
}

/* the sensors of a group whose place on the asset is known */
struct placed_sensors {
    size_t count;
    uint32_t columns_hash; /* influence_columns_hash() */
};

static struct placed_sensors find_placed(const struct plant *plant, const struct plant_sensor *sensors, size_t count, int group)
{
    struct placed_sensors placed;
    uint32_t *columns = mem_array(count, sizeof(*columns));
    placed.count = plant_placed_sensors(plant, sensors, count, group, columns);
    placed.columns_hash = influence_columns_hash(columns, placed.count);
    mem_free(columns);
    return placed;
}

/* Returns whether the `gp` parameters with which the asset file was prepared equal those that the plant file states. Parameters
   that it does not state were determined from readings, and are not compared; or, with few sensors, from the group's range. */
static bool is_as_stated(const struct plant_group *group, const struct influence_entry *entry)
{
    const struct plant_gp *gp = &group->gp;
    double noise = gp->noise, deviation = gp->deviation;
    if (entry->sensor_count < PLANT_GP_FITTED)
        plant_gp_defaults(group, &noise, &deviation);
    return (isnan(gp->range_m) || gp->range_m == entry->range_m) && (isnan(noise) || noise == entry->noise) &&
           (isnan(deviation) || deviation == entry->deviation);
}

/* Returns the prepared entry of a group; NULL: there is none for the plant file's present sensors. */
static const struct influence_entry *find_entry(struct log *log, const struct scene_asset *asset, size_t group, uint32_t kind,
                                                const struct placed_sensors *placed)
{
    const struct influence_entry *entry =
        asset_open_influence(log, asset->file) ? influence_find(&asset->file->influence, (uint32_t)group, kind) : NULL;
    return entry && entry->sensor_count == placed->count && entry->columns_hash == placed->columns_hash ? entry : NULL;
}

static bool influence_fits(struct log *log, const struct plant *plant, const struct scene_asset *asset, const struct plant_sensor *sensors,
                           size_t count)
{
    for (size_t g = 0; g < plant->group_count; g++) {
        const struct plant_group *group = &plant->groups[g];
        if (!plant_prepares_any(group))
            continue;
        struct placed_sensors placed = find_placed(plant, sensors, count, (int)g);
        if (placed.count == 0)
            continue;
        bool heat = group->heat && !find_entry(log, asset, g, INFLUENCE_HEAT, &placed);
        if (heat || (group->directed && !find_entry(log, asset, g, INFLUENCE_TRANSPORT, &placed))) {
            log_err(log, "asset %s: the prepared %s for sensor group %s are missing, damaged or outdated; run plantcast-prep again",
                    asset->plant->id, heat ? "heat distances" : "directions", group->id);
            return false;
        }
        for (int i = INTERPOLATION_HARMONIC; i < INTERPOLATIONS; i++) {
            if (!plant_prepares(group, (enum interpolation)i))
                continue;
            if (!asset_open_influence(log, asset->file)) {
                log_err(log, "asset %s: the prepared file of sensor weights is missing, damaged or outdated; run plantcast-prep again",
                        asset->plant->id);
                return false;
            }
            const struct influence_entry *entry = find_entry(log, asset, g, (uint32_t)i, &placed);
            double decay_m = i == INTERPOLATION_FIN ? plant_decay_m(asset->plant) : 0;
            if (entry && entry->disc_m == group->disc_m && entry->decay_m == decay_m &&
                (i != INTERPOLATION_GP || (entry->deviations && is_as_stated(group, entry))))
                continue;
            log_err(log,
                    "asset %s: the sensor weights of group %s are outdated: the tag list, the order of the groups, `disc_m`, `gp`, `min` "
                    "or `max` of a group with `gp`, `thickness_m`, `conductivity` or `heat_transfer` was changed; run plantcast-prep "
                    "again",
                    asset->plant->id, group->id);
            return false;
        }
    }
    return true;
}

/* Hashes the model of an asset, without reading again a model that was hashed for an earlier asset (0: it was not, because that asset
   is missing). Returns false with errno if the model cannot be read. */
static bool model_hash(const struct plant *plant, uint64_t *hashes, int index)
{
    for (int i = 0; i < index; i++)
        if (hashes[i] && !strcmp(plant->assets[i].model, plant->assets[index].model)) {
            hashes[index] = hashes[i];
            return true;
        }
    return plant_model_hash(plant->assets[index].model, &hashes[index]);
}

static bool recipe_fits(struct log *log, const struct plant *plant, uint64_t *hashes, int index, const struct manifest_entry *entry)
{
    const struct plant_asset *asset = &plant->assets[index];
    if (!model_hash(plant, hashes, index)) {
        log_err(log, "asset %s: %s: cannot be read: %s", asset->id, asset->model, strerror(errno));
        return false;
    }
    if (plant_recipe(asset, hashes[index]) == entry->recipe)
        return true;
    log_err(log,
            "asset %s: the model %s, or the asset's 'nodes', 'units', 'scale' or 'up', has changed since plantcast-prep ran; run "
            "plantcast-prep again",
            asset->id, asset->model);
    return false;
}

/* --- one asset -------------------------------------------------------------------------------------------------------------- */

static void grow_box(double min_m[3], double max_m[3], const double point_m[3])
{
    for (int i = 0; i < 3; i++) {
        min_m[i] = fmin(min_m[i], point_m[i]);
        max_m[i] = fmax(max_m[i], point_m[i]);
    }
}

static void empty_box(double min_m[3], double max_m[3])
{
    for (int i = 0; i < 3; i++) {
        min_m[i] = INFINITY;
        max_m[i] = -INFINITY;
    }
}

static void place(struct scene_asset *asset)
{
    const struct asset_header *header = asset->file->view.header;
    double to_asset_frame[16];
    memcpy(to_asset_frame, transform_identity, sizeof(to_asset_frame));
    memcpy(&to_asset_frame[12], header->origin_m, sizeof(header->origin_m));
    transform_multiply(asset->plant->placement, to_asset_frame, asset->placement);
    empty_box(asset->bounds_min_m, asset->bounds_max_m);
    for (int corner = 0; corner < 8; corner++) {
        double point[3];
        for (int i = 0; i < 3; i++)
            point[i] = (corner >> i & 1 ? header->bounds_max_m : header->bounds_min_m)[i];
        transform_point(asset->placement, point, point);
        grow_box(asset->bounds_min_m, asset->bounds_max_m, point);
    }
}

static void place_sensor(const struct scene_asset *asset, int column, int tag, struct scene_sensor *out)
{
    const struct asset_sensor *sensor = &asset->file->view.sensors[column];
    double position[3], surface[3];
    for (int i = 0; i < 3; i++) {
        position[i] = sensor->position_m[i];
        surface[i] = sensor->surface_m[i];
    }
    *out = (struct scene_sensor){ .tag = tag, .column = column, .surface_distance_m = sensor->surface_distance_m };
    transform_point(asset->placement, position, out->position_m);
    transform_point(asset->placement, surface, out->surface_m);
}

/* Sets up an asset that plantcast-prep could not prepare. The scene has the asset, with the reason why it is missing, but the
   asset is not drawn and does not extend the plant's box. */
static bool create_missing(struct log *log, struct scene_asset *asset, const struct manifest_entry *entry)
{
    log_warn(log, "asset %s cannot be shown: %s; repair its model, then run plantcast-prep again", asset->plant->id, entry->missing);
    asset->missing = mem_strdup(entry->missing);
    asset->file = asset_stand_in();
    if (asset->file)
        place(asset);
    return asset->file != NULL;
}

struct file_use {
    const char *name; /* name of the asset's file in the prepared folder */
    int asset;
    uint64_t cuts;            /* as in struct manifest_entry (scene/manifest.h) */
    uint64_t resolved_levels; /* bit mask of levels of detail, as in struct asset (scene/asset.h) */
};

/* Checks that the asset's opened file matches the plant file's sensors and the group settings, and places the asset and its
   sensors in the scene. Logs and returns false if the file could not be opened or does not match. */
static bool create_asset(struct log *log, struct scene *scene, const struct file_use *use)
{
    struct scene_asset *asset = &scene->assets[use->asset];
    struct plant_sensor *sensors = NULL;
    if (!asset->file) {
        log_err(log, "asset %s: the prepared file is missing, damaged or outdated; run plantcast-prep again", asset->plant->id);
        return false;
    }
    size_t count = plant_sensors(scene->plant, use->asset, &sensors);
    bool good = sensors_fit(log, scene->plant, asset, sensors, count) && influence_fits(log, scene->plant, asset, sensors, count);
    if (good) {
        place(asset);
        asset->sensors = mem_array(count, sizeof(*asset->sensors));
        asset->sensor_count = count;
        for (size_t i = 0; i < count; i++)
            place_sensor(asset, (int)i, sensors[i].tag, &asset->sensors[i]);
        asset->file->cuts_differ |= plant_cuts_recipe(scene->plant, sensors, count) != use->cuts;
        asset->file->resolved_levels = asset->file->cuts_differ ? 0 : use->resolved_levels;
    }
    mem_free(sensors);
    return good;
}

/* --- files ------------------------------------------------------------------------------------------------------------------ */

struct file_uses {
    struct log *log;
    struct scene *scene;
    struct file_use *at;
    size_t count;
};

static int compare_uses(const void *a, const void *b)
{
    return strcmp(((const struct file_use *)a)->name, ((const struct file_use *)b)->name);
}

static int compare_assets(const void *a, const void *b)
{
    return ((const struct file_use *)a)->asset - ((const struct file_use *)b)->asset;
}

/* Opens the files with the indices begin to end - 1, as one job of a worker. The list is sorted by file name: the first asset
   that uses a name opens the file, and the next ones share it. */
static void open_some(void *arg, size_t begin, size_t end)
{
    const struct file_uses *uses = arg;
    for (size_t i = begin; i < end; i++) {
        const char *name = uses->at[i].name;
        if (i > 0 && !strcmp(uses->at[i - 1].name, name))
            continue;
        char *path = mem_printf("%s/%s", uses->scene->folder, name);
        struct asset *file = asset_open(uses->log, path);
        for (size_t u = i; file && u < uses->count && !strcmp(uses->at[u].name, name); u++)
            uses->scene->assets[uses->at[u].asset].file = u == i ? file : asset_ref(file);
        mem_free(path);
    }
}

/* Opens each file once, on all cores: checking the files takes longer than all other steps of loading. */
static void open_files(struct file_uses *uses)
{
    qsort(uses->at, uses->count, sizeof(*uses->at), compare_uses);
    struct workers *workers = workers_create(0);
    workers_for(workers, uses->count, 1, open_some, uses);
    workers_destroy(&workers);
}

/* Hashes of the assets' models; 0: the asset is missing. */
struct model_hashes {
    uint64_t *files; /* by asset: hash of the model file alone, which the recipe contains */
    uint64_t *shown; /* by asset: hash of the model file and of the files that it refers to, as far as the manifest states it */
};

/* Adds the asset's file to the list, unless the asset is missing. Logs and returns false if the file does not match the plant. */
static bool find_file(struct file_uses *uses, const struct manifest *manifest, struct model_hashes *hashes, int index)
{
    struct log *log = uses->log;
    struct scene *scene = uses->scene;
    struct scene_asset *asset = &scene->assets[index];
    asset->plant = &scene->plant->assets[index];
    const struct manifest_entry *entry = manifest_find(manifest, asset->plant->id);
    if (!entry) {
        log_err(log, "asset %s is not in the list of prepared assets, %s; run plantcast-prep again", asset->plant->id, manifest->path);
        return false;
    }
    if (entry->missing)
        return create_missing(log, asset, entry);
    if (!recipe_fits(log, scene->plant, hashes->files, index, entry))
        return false;
    hashes->shown[index] = entry->model ? entry->model : hashes->files[index];
    uses->at[uses->count++] = (struct file_use){ entry->file, index, entry->cuts, entry->resolved_levels };
    return true;
}

/* --- all assets of the scene ------------------------------------------------------------------------------------------------ */

/* Gives the assets that could not be prepared the bounding box of the plant, so that a view of such an asset shows the plant.
   Returns false if no asset could be prepared. */
static bool bound_missing(struct scene *scene)
{
    for (size_t i = 0; i < scene->asset_count; i++)
        if (scene->assets[i].missing) {
            memcpy(scene->assets[i].bounds_min_m, scene->bounds_min_m, sizeof(scene->bounds_min_m));
            memcpy(scene->assets[i].bounds_max_m, scene->bounds_max_m, sizeof(scene->bounds_max_m));
        }
    return scene->bounds_min_m[0] <= scene->bounds_max_m[0];
}

/* Logs how many assets have triangles that were cut for other parameters or sensors than those of the plant file. */
static void say_cuts_differ(struct log *log, const struct scene *scene)
{
    const char *first = NULL;
    size_t count = 0;
    for (size_t i = 0; i < scene->asset_count; i++)
        if (scene->assets[i].file && scene->assets[i].file->cuts_differ && count++ == 0)
            first = scene->assets[i].plant->id;
    if (count > 0)
        log_warn(
            log,
            "assets prepared by an older plantcast-prep, or for other parameters of a group or tag: %zu (the first: %s); pictures mark "
            "places where their field may be wrong; run plantcast-prep again for a more accurate field",
            count, first);
}

/* Creates all assets. Checks and logs every asset, and returns false if one does not match its prepared file. */
static bool create_assets(struct log *log, struct scene *scene, const struct manifest *manifest)
{
    struct file_uses uses = { .log = log, .scene = scene, .at = mem_array(scene->asset_count, sizeof(*uses.at)) };
    struct model_hashes hashes = { mem_array(scene->asset_count, sizeof(*hashes.files)),
                                   mem_array(scene->asset_count, sizeof(*hashes.shown)) };
    bool good = true;
    for (size_t i = 0; i < scene->asset_count; i++)
        good = find_file(&uses, manifest, &hashes, (int)i) && good;
    open_files(&uses);
    qsort(uses.at, uses.count, sizeof(*uses.at), compare_assets);
    for (size_t i = 0; i < uses.count; i++) {
        const struct scene_asset *asset = &scene->assets[uses.at[i].asset];
        if (!create_asset(log, scene, &uses.at[i])) {
            good = false;
            continue;
        }
        grow_box(scene->bounds_min_m, scene->bounds_max_m, asset->bounds_min_m);
        grow_box(scene->bounds_min_m, scene->bounds_max_m, asset->bounds_max_m);
    }
    say_cuts_differ(log, scene);
    scene->models_hash = XXH3_64bits(hashes.shown, scene->asset_count * sizeof(*hashes.shown));
    mem_free(hashes.files);
    mem_free(hashes.shown);
    mem_free(uses.at);
    return good;
}

/* Does the work of scene_create(), but logs no advice on how to prepare the plant. */
static struct scene *create(struct log *log, const struct plant *plant, const char *prepared_folder)
{
    struct manifest manifest;
    if (!manifest_read(log, prepared_folder, &manifest))
        return NULL;
    struct scene *scene = mem_new(sizeof(*scene));
    scene->plant = plant;
    scene->folder = mem_strdup(prepared_folder);
    scene->asset_count = plant->asset_count;
    scene->assets = mem_array(plant->asset_count, sizeof(*scene->assets));
    empty_box(scene->bounds_min_m, scene->bounds_max_m);
    bool good = create_assets(log, scene, &manifest);
    manifest_finish(&manifest);
    if (good && !bound_missing(scene)) {
        log_err(
            log,
            "%s: plantcast-prep could not prepare any asset, so there is nothing to show: repair the models, then run plantcast-prep again",
            prepared_folder);
        good = false;
    }
    if (good) {
        memcpy(scene->whole_min_m, scene->bounds_min_m, sizeof(scene->whole_min_m));
        memcpy(scene->whole_max_m, scene->bounds_max_m, sizeof(scene->whole_max_m));
        main_part_find(log, scene);
        coincident_find(scene);
        extremes_find(scene);
    } else {
        scene_destroy(&scene);
    }
    return scene;
}

struct scene *scene_create(struct log *log, const struct plant *plant, const char *prepared_folder)
{
    struct scene *scene = create(log, plant, prepared_folder);
    char *own = scene ? NULL : plant_service_folder(plant->files.path, "prepared");
    if (own && !strcmp(own, prepared_folder))
        log_err(
            log,
            "%s: the prepared files in %s cannot be used; the service prepares them when it starts: restart the service, or read its log",
            plant->files.path, prepared_folder);
    else if (!scene)
        log_err(log, "%s: the prepared files in %s cannot be used; run plantcast-prep -o %s %s", plant->files.path, prepared_folder,
                prepared_folder, plant->files.path);
    mem_free(own);
    return scene;
}

void scene_destroy(struct scene **scene_ptr)
{
    struct scene *scene = *scene_ptr;
    if (!scene)
        return;
    for (size_t i = 0; i < scene->asset_count; i++) {
        asset_unref(&scene->assets[i].file);
        mem_free(scene->assets[i].sensors);
        mem_free(scene->assets[i].missing);
    }
    mem_free(scene->assets);
    mem_free(scene->extremes_m);
    mem_free(scene->folder);
    mem_free(scene);
    *scene_ptr = NULL;
}

void scene_home(const struct scene *scene, double aspect, struct camera *camera)
{
    const struct plant_view *view = &scene->plant->display.view;
    camera_fit_up(camera, scene->plant->up, scene->bounds_min_m, scene->bounds_max_m, aspect);
    if (!view->set && scene->extreme_count > 0) {
        double forward[3];
        for (int i = 0; i < 3; i++)
            forward[i] = camera->target_m[i] - camera->eye_m[i];
        camera_fit_points(camera, forward, (const double(*)[3])scene->extremes_m, scene->extreme_count, aspect,
                          &(struct camera_window){ 0 });
    }
    if (!view->set)
        return;
    memcpy(camera->eye_m, view->eye_m, sizeof(camera->eye_m));
    memcpy(camera->target_m, view->target_m, sizeof(camera->target_m));
    camera->fov_deg = view->fov_deg;
    /* the camera looks straight down, so that `up` is parallel to the view, which is invalid: sets `up` to north, as on a map */
    if (!camera_valid(camera))
        memcpy(camera->up, scene->plant->up == AXIS_Y ? (double[]){ 0, 0, -1 } : (double[]){ 0, 1, 0 }, sizeof(camera->up));
}

void scene_depth_box(const struct scene *scene, const double eye_m[3], double min_m[3], double max_m[3])
{
    /* away_m: distance from the eye to the main part; farthest_m2: squared distance from the eye to the farthest corner of the box of
       everything */
    double away_m = 0, farthest_m2 = 0;
    for (int c = 0; c < 3; c++) {
        away_m = fmax(away_m, fmax(scene->bounds_min_m[c] - eye_m[c], eye_m[c] - scene->bounds_max_m[c]));
        farthest_m2 += pow(fmax(fabs(scene->whole_min_m[c] - eye_m[c]), fabs(scene->whole_max_m[c] - eye_m[c])), 2);
    }
    bool whole = scene->outside.triangles > 0 && away_m > CAMERA_NEAR_TO_FAR * sqrt(farthest_m2);
    memcpy(min_m, whole ? scene->whole_min_m : scene->bounds_min_m, 3 * sizeof(*min_m));
    memcpy(max_m, whole ? scene->whole_max_m : scene->bounds_max_m, 3 * sizeof(*max_m));
}

bool scene_asset_mirrored(const struct scene_asset *asset)
{
    const double *m = asset->placement;
    return m[0] * (m[5] * m[10] - m[6] * m[9]) - m[4] * (m[1] * m[10] - m[2] * m[9]) + m[8] * (m[1] * m[6] - m[2] * m[5]) < 0;
}
