/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads a plant's assets, one at a time, from a plant file with models or from a folder of prepared files. */
#include "preprocess/diff/diff_side.h"

#include <errno.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/mem.h"
#include "preprocess/pipeline/prepare.h"
#include "preprocess/pipeline/sensor_distances.h"

#define MANIFEST_MAX_BYTES ((size_t)64 << 20)

static int by_name(const void *a, const void *b)
{
    return strcmp(((const struct diff_side_tag *)a)->name, ((const struct diff_side_tag *)b)->name);
}

const struct diff_side_tag *diff_side_find_tag(const struct diff_side *side, const char *name)
{
    struct diff_side_tag wanted = { .name = name };
    return side->tag_count ? bsearch(&wanted, side->tags, side->tag_count, sizeof(*side->tags), by_name) : NULL;
}

/* --- a plant file -------------------------------------------------------------------------------------------------------------- */

static void take_tags(struct diff_side *side)
{
    const struct plant *plant = side->plant;
    size_t *columns = mem_array(plant->asset_count, sizeof(*columns));
    side->tags = mem_array(plant->tag_count, sizeof(*side->tags));
    for (size_t i = 0; i < plant->tag_count; i++) {
        const struct plant_tag *tag = &plant->tags[i];
        struct diff_side_tag *to = &side->tags[side->tag_count++];
        bool known = tag->asset >= 0, sensor = known && tag->group >= 0;
        *to = (struct diff_side_tag){ .name = tag->name,
                                      .asset = known ? plant->assets[tag->asset].id : tag->place.lost_asset,
                                      .is_sensor = sensor };
        if (!to->asset)
            to->asset = "";
        if (sensor)
            to->column = columns[tag->asset]++;
    }
    mem_free(columns);
}

static bool open_plant(struct diff_side *side, struct diag *diag)
{
    side->plant = plant_load_with_orphans(side->path, diag);
    if (!side->plant)
        return false;
    side->asset_count = side->plant->asset_count;
    side->assets = mem_array(side->asset_count, sizeof(*side->assets));
    for (size_t i = 0; i < side->asset_count; i++) {
        const struct plant_asset *asset = &side->plant->assets[i];
        struct diff_side_asset *to = &side->assets[i];
        *to = (struct diff_side_asset){ .id = asset->id, .plant = asset, .model = model_files_add(&side->models, asset) };
        to->work = to->model;
        memcpy(to->placement, asset->placement, sizeof(to->placement));
    }
    take_tags(side);
    return true;
}

static struct gltf_model *parse(struct diff_side *side, struct model_file *model, char *why)
{
    if (side->parsed == model)
        return &model->parsed;
    if (side->parsed)
        model_file_release(side->parsed);
    side->parsed = NULL;
    if (!model->good || !model_file_parse(model)) {
        model->good = false;
        wrong(why, "%.150s: %.200s", model->path, model->why);
        return NULL;
    }
    side->parsed = model;
    return &model->parsed;
}

/* Cuts an asset's geometry out of the model. The shape takes ownership of the geometry's triangles and positions. */
static bool cut_shape(const struct gltf_model *model, const struct geometry_params *params, struct diff_side_shape *shape, char *why)
{
    struct geometry g;
    if (!geometry_cut(&g, model, params, why))
        return false;
    *shape = (struct diff_side_shape){ .positions_m = (const float(*)[3])g.positions_m,
                                       .indices = g.indices,
                                       .vertex_count = g.vertex_count,
                                       .index_count = g.index_count,
                                       .own = true };
    memcpy(shape->origin_m, g.origin_m, sizeof(shape->origin_m));
    g.positions_m = NULL; /* the shape now owns the position and triangle arrays: keep geometry_finish() from freeing them */
    g.indices = NULL;
    geometry_finish(&g);
    return true;
}

static bool shape_of_plant(struct diff_side *side, const struct diff_side_asset *asset, struct diff_side_shape *shape, char *why)
{
    struct geometry_params params = prepare_geometry(asset->plant);
    struct plant_sensor *sensors;
    const struct gltf_model *model = parse(side, &side->models.at[asset->model], why);
    shape->unreadable = !model;
    if (!model || !cut_shape(model, &params, shape, why))
        return false;
    shape->sensor_count = plant_sensors(side->plant, (int)(asset->plant - side->plant->assets), &sensors);
    shape->places_m = mem_array(shape->sensor_count, sizeof(*shape->places_m));
    shape->whys = mem_array(shape->sensor_count, sizeof(*shape->whys));
    for (size_t s = 0; s < shape->sensor_count; s++) {
        bool there = build_sensor_place(model, &params, &sensors[s], shape->places_m[s], why);
        shape->whys[s] = there ? NULL : mem_strdup(why);
        for (int axis = 0; axis < 3; axis++)
            shape->places_m[s][axis] = there ? shape->places_m[s][axis] - shape->origin_m[axis] : (double)NAN;
    }
    mem_free(sensors);
    return true;
}

bool diff_side_node_in_box(struct diff_side *side, const struct diff_side_asset *asset, const struct diff_side_box *box, double tolerance_m,
                           uint32_t *node, char *name, size_t name_bytes)
{
    char why[MODEL_WHY_BYTES];
    const struct gltf_model *model = side->plant ? parse(side, &side->models.at[asset->model], why) : NULL;
    if (!model)
        return false;
    struct geometry_params params = prepare_geometry(asset->plant);
    double(*boxes)[2][3] = geometry_node_boxes(model, &params);
    bool found = false;
    for (; *node < model->node_count; ++*node) {
        found = true;
        for (int axis = 0; axis < 3; axis++)
            found = found && fabs(boxes[*node][0][axis] - box->low_m[axis]) <= tolerance_m &&
                    fabs(boxes[*node][1][axis] - box->high_m[axis]) <= tolerance_m;
        if (found)
            break;
    }
    size_t alike = 0;
    for (uint32_t i = 0; found && i < model->node_count; i++)
        alike += strcmp(model->nodes[i].name, model->nodes[*node].name) == 0;
    if (found && alike == 1 && *model->nodes[*node].name)
        snprintf(name, name_bytes, "'%.150s'", model->nodes[*node].name);
    else if (found)
        snprintf(name, name_bytes, "'#%u'", model->nodes[*node].number);
    mem_free(boxes);
    return found;
}

bool diff_side_shape_of_node(struct diff_side *side, const struct diff_side_asset *asset, uint32_t node, struct diff_side_shape *shape,
                             char why[MODEL_WHY_BYTES])
{
    char pattern[16];
    struct geometry_params params = prepare_geometry(asset->plant);
    const struct gltf_model *model = parse(side, &side->models.at[asset->model], why);
    if (!model)
        return false;
    snprintf(pattern, sizeof(pattern), "#%u", model->nodes[node].number);
    params.nodes = pattern;
    return cut_shape(model, &params, shape, why);
}

/* --- reading a folder of prepared files ------------------------------------------------------------------------------------------- */

static bool take_entry(struct diff_side *side, const json_t *entry)
{
    const json_t *placement = json_object_get(entry, "placement"), *tags = json_object_get(entry, "tags");
    const char *id = json_string_value(json_object_get(entry, "id")), *key = json_string_value(json_object_get(entry, "key"));
    struct diff_side_asset *asset = &side->assets[side->asset_count++];
    if (!id || !key || json_array_size(placement) != 16 || !json_is_array(tags))
        return false;
    *asset = (struct diff_side_asset){ .id = id,
                                       .key = strtoull(key, NULL, 16),
                                       .missing = json_string_value(json_object_get(entry, "missing")) };
    for (size_t n = 0; n < 16; n++)
        asset->placement[n] = json_number_value(json_array_get(placement, n));
    for (size_t t = 0; t < json_array_size(tags); t++) {
        const char *name = json_string_value(json_array_get(tags, t));
        if (!name)
            return false;
        side->tags[side->tag_count++] = (struct diff_side_tag){ .name = name, .asset = id, .column = t, .is_sensor = true };
    }
    return true;
}

static bool open_folder(struct diff_side *side, struct diag *diag)
{
    char *path = mem_printf("%s/manifest.json", side->path);
    size_t size, tags = 0;
    json_error_t error;
    side->manifest = text_read_file(path, MANIFEST_MAX_BYTES, &size);
    if (!side->manifest)
        diag_error(diag, path, 0, 0, "cannot be read: %s", strerror(errno));
    side->root = side->manifest ? json_loadb(side->manifest, size, 0, &error) : NULL;
    const json_t *entries = json_object_get(side->root, "assets");
    for (size_t i = 0; i < json_array_size(entries); i++)
        tags += json_array_size(json_object_get(json_array_get(entries, i), "tags"));
    side->assets = mem_array(json_array_size(entries), sizeof(*side->assets));
    side->tags = mem_array(tags, sizeof(*side->tags));
    bool good = json_is_array(entries);
    for (size_t i = 0; good && i < json_array_size(entries); i++)
        good = take_entry(side, json_array_get(entries, i));
    if (side->manifest && !good)
        diag_error(
            diag, path, 0, 0,
            "this list of prepared files (manifest) lacks the placements of assets and the names of sensors: run plantcast-prep again");
    mem_free(path);
    return good;
}

static bool shape_of_folder(struct diff_side *side, const struct diff_side_asset *asset, struct diff_side_shape *shape, char *why)
{
    char file_why[200] = "is missing";
    *shape = (struct diff_side_shape){ 0 };
    if (asset->missing) {
        wrong(why, "%.400s", asset->missing);
        return false;
    }
    if (folder_open(&shape->file, side->path, asset->key, file_why) != 1) {
        char *path = folder_asset_path(side->path, asset->key);
        wrong(why, "prepared file %.250s: %s; run plantcast-prep again", path, file_why);
        mem_free(path);
        shape->unreadable = true;
        return false;
    }
    const struct asset_view *view = &shape->file.view;
    const struct asset_level *finest = &view->levels[0];
    memcpy(shape->origin_m, view->header->origin_m, sizeof(shape->origin_m));
    shape->positions_m = view->positions_m;
    shape->indices = view->indices + view->primitives[finest->first_primitive].first_index;
    shape->vertex_count = finest->vertex_count;
    for (uint32_t p = 0; p < finest->primitive_count; p++)
        shape->index_count += view->primitives[finest->first_primitive + p].index_count;
    shape->sensor_count = view->header->sensor_count;
    shape->places_m = mem_array(shape->sensor_count, sizeof(*shape->places_m));
    shape->whys = mem_array(shape->sensor_count, sizeof(*shape->whys));
    for (size_t s = 0; s < shape->sensor_count; s++)
        for (int axis = 0; axis < 3; axis++)
            shape->places_m[s][axis] = (double)view->sensors[s].position_m[axis];
    return true;
}

/* --- functions for either kind of side: a plant file, or a folder of prepared files --------------------------------------------------- */

bool diff_side_open(struct diff_side *side, const char *path, struct diag *diag)
{
    struct stat st;
    *side = (struct diff_side){ .path = path };
    bool good = stat(path, &st) == 0 && S_ISDIR(st.st_mode) ? open_folder(side, diag) : open_plant(side, diag);
    if (good && side->tag_count)
        qsort(side->tags, side->tag_count, sizeof(*side->tags), by_name);
    return good;
}

void diff_side_finish(struct diff_side *side)
{
    model_files_finish(&side->models);
    mem_free(side->assets);
    mem_free(side->tags);
    json_decref(side->root);
    mem_free(side->manifest);
    plant_destroy(&side->plant);
}

bool diff_side_shape(struct diff_side *side, const struct diff_side_asset *asset, struct diff_side_shape *shape, char why[MODEL_WHY_BYTES])
{
    return (side->plant ? shape_of_plant : shape_of_folder)(side, asset, shape, why);
}

void diff_side_shape_finish(struct diff_side_shape *shape)
{
    if (shape->own) {
        mem_free((void *)(uintptr_t)shape->positions_m);
        mem_free((void *)(uintptr_t)shape->indices);
    }
    mem_free(shape->places_m);
    for (size_t s = 0; shape->whys && s < shape->sensor_count; s++)
        mem_free(shape->whys[s]);
    mem_free(shape->whys);
    folder_close(&shape->file);
    *shape = (struct diff_side_shape){ 0 };
}
