/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes debug views (GLB files) of the selected assets, one model after the other. */
#include "preprocess/debug/debug_views.h"

#include <ctype.h>
#include <errno.h>
#include <string.h>
#include <sys/stat.h>

#include "base/mem.h"
#include "preprocess/debug/debug_view.h"
#include "preprocess/pipeline/prepare.h"
#include "preprocess/pipeline/sensor_distances.h"

struct views {
    struct log *log;
    struct workers *workers;
    const struct plant *plant;
    const struct debug_views_params *params;
    struct diag *diag;
    bool failed;
};

struct subject { /* the asset whose debug view is being built */
    const struct plant_asset *asset;
    const struct gltf_model *model;
    struct geometry_params params;
    struct geometry geometry;
    struct plant_sensor *sensors;
    double (*places_m)[3];
    size_t sensor_count, chosen;
    struct surface *surface;
    struct surface_field field; /* distances from the chosen sensor */
};

char *debug_views_folder(const struct plant *plant)
{
    char *prepared = plant_prepared_folder(plant), *folder;
    folder = mem_printf("%.*s.debug", (int)(strrchr(prepared, '.') - prepared), prepared);
    mem_free(prepared);
    return folder;
}

/* Returns the path of an asset's debug view; characters unsuitable in file names are replaced by %XX. The caller frees it. */
static char *file_of(const char *folder, const char *id)
{
    struct text name = { 0 };
    text_add(&name, "%s/", folder);
    for (; *id; id++)
        if (isalnum((unsigned char)*id) || strchr("-_.", *id) || (unsigned char)*id >= 0x80)
            text_add_bytes(&name, id, 1);
        else
            text_add(&name, "%%%02X", (unsigned char)*id);
    text_add(&name, ".glb");
    return name.at;
}

static bool place_sensors(struct subject *subject, const struct plant *plant, const char *wanted, char *why)
{
    subject->sensor_count = plant_sensors(plant, (int)(subject->asset - plant->assets), &subject->sensors);
    subject->places_m = mem_array(subject->sensor_count, sizeof(*subject->places_m));
    for (size_t i = 0; i < subject->sensor_count; i++) {
        const struct plant_sensor *sensor = &subject->sensors[i];
        if (!build_sensor_place(subject->model, &subject->params, sensor, subject->places_m[i], why))
            return false;
        for (int axis = 0; axis < 3; axis++)
            subject->places_m[i][axis] -= subject->geometry.origin_m[axis];
        if (wanted && strcmp(plant->tags[sensor->tag].name, wanted) == 0)
            subject->chosen = i;
    }
    return true;
}

static bool find_distances(struct subject *subject, char *why)
{
    const double(*chosen)[3] = (const double(*)[3])subject->places_m + subject->chosen;
    if (!surface_field_init(&subject->field, subject->surface, chosen, 1, NULL))
        return wrong(why, "the distances along the surface of the asset cannot be computed");
    return true;
}

static bool look_at(struct views *views, struct subject *subject, char *why)
{
    struct geometry *g = &subject->geometry;
    if (!geometry_cut(g, subject->model, &subject->params, why) || !place_sensors(subject, views->plant, views->params->sensor, why))
        return false;
    subject->surface = surface_create(views->log, views->workers, (const float(*)[3])g->positions_m, g->vertex_count, g->indices,
                                      g->index_count / 3, &(struct surface_params){ .tolerance_m = subject->params.tolerance_m });
    if (!subject->surface)
        return wrong(why, "the surface of the asset cannot be built from its triangles");
    return subject->sensor_count == 0 || find_distances(subject, why);
}

static void subject_finish(struct subject *subject)
{
    surface_destroy(&subject->surface);
    geometry_finish(&subject->geometry);
    mem_free(subject->sensors);
    mem_free(subject->places_m);
    surface_field_finish(&subject->field);
}

static void write_one(struct views *views, const struct plant_asset *asset, const struct gltf_model *model)
{
    struct subject subject = { .asset = asset, .model = model, .params = prepare_geometry(asset) };
    char why[MODEL_WHY_BYTES], *path = file_of(views->params->folder, asset->id);
    bool good = look_at(views, &subject, why);
    if (good) {
        bool any = subject.sensor_count > 0;
        struct debug_view view = { .name = asset->id,
                                   .surface = subject.surface,
                                   .distances_m = subject.field.distances_m,
                                   .sensor = any ? views->plant->tags[subject.sensors[subject.chosen].tag].name : "",
                                   .sensors_m = (const double(*)[3])subject.places_m,
                                   .sensor_count = subject.sensor_count,
                                   .chosen = subject.chosen };
        int status = debug_view_save(&view, path);
        good = status == 0 || wrong(why, "%s cannot be written: %s", path, strerror(-status));
    }
    if (good && views->params->say)
        fprintf(views->params->say, "%s: %zu bridges across gaps, %zu points added\n", path, surface_report(subject.surface)->bridges,
                surface_report(subject.surface)->samples);
    if (!good) {
        diag_error(views->diag, views->plant->files.path, asset->line, 0, "asset %s: %s", asset->id, why);
        views->failed = true;
    }
    subject_finish(&subject);
    mem_free(path);
}

static bool is_wanted(const struct views *views, const struct plant_asset *asset)
{
    const struct debug_views_params *params = views->params;
    int tag = params->sensor ? plant_find_tag(views->plant, params->sensor) : -1;
    if (params->asset && strcmp(params->asset, asset->id) != 0)
        return false;
    return tag < 0 || views->plant->tags[tag].asset == (int)(asset - views->plant->assets);
}

/* Writes debug views of the selected assets of one model. A model without such assets is not parsed. */
static void write_model(struct views *views, struct model_file *model)
{
    for (size_t i = 0; i < views->plant->asset_count; i++) {
        const struct plant_asset *asset = &views->plant->assets[i];
        if (strcmp(asset->model, model->path) != 0 || !is_wanted(views, asset))
            continue;
        if (!model->was_parsed && !model_file_parse(model)) {
            diag_error(views->diag, views->plant->files.path, asset->line, 0, "asset %s: %s: %s", asset->id, model->path, model->why);
            views->failed = true;
            return;
        }
        write_one(views, asset, &model->parsed);
    }
    model_file_release(model);
}

bool debug_views_write(struct log *log, struct workers *workers, const struct plant *plant, const struct debug_views_params *params,
                       struct diag *diag)
{
    struct views views = { .log = log, .workers = workers, .plant = plant, .params = params, .diag = diag };
    struct model_files models = { 0 };
    int tag = params->sensor ? plant_find_tag(plant, params->sensor) : 0;
    if (params->sensor && (tag < 0 || plant->tags[tag].asset < 0 || plant->tags[tag].group < 0)) {
        diag_error(diag, plant->files.tags_path, tag < 0 ? 0 : plant->tags[tag].line, 0, "tag %s is not a sensor of any asset",
                   params->sensor);
        return false;
    }
    if (mkdir(params->folder, 0777) != 0 && errno != EEXIST) {
        diag_error(diag, plant->files.path, 0, 0, "%s: cannot be created: %s", params->folder, strerror(errno));
        return false;
    }
    for (size_t i = 0; i < plant->asset_count; i++)
        if (is_wanted(&views, &plant->assets[i]))
            model_files_add(&models, &plant->assets[i]);
    for (size_t i = 0; i < models.count; i++)
        write_model(&views, &models.at[i]);
    model_files_finish(&models);
    return !views.failed;
}
