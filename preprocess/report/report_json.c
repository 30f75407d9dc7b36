/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Prints the report as JSON; REPORT.md explains the names. */
#include <jansson.h>
#include <stdlib.h>

#include "base/mem.h"
#include "base/text/json_text.h"
#include "preprocess/cache/folder.h"
#include "plant/models/asset_size.h"
#include "preprocess/report/report.h"
#include "preprocess/pipeline/build_report_json.h"

static json_t *sensors_json(const struct prepare *prepare, const struct prepare_asset *asset)
{
    json_t *sensors = json_array();
    for (size_t s = 0; asset->surface_distances_m && s < asset->sensor_count; s++) {
        double distance_m = (double)asset->surface_distances_m[s];
        json_array_append_new(sensors,
                              json_pack("{s:s,s:f,s:f,s:b}", "tag", prepare->plant->tags[asset->sensors[s].tag].name, "surface_distance_m",
                                        distance_m, "limit_m", asset->far_m, "far", distance_m > asset->far_m));
    }
    return sensors;
}

static json_t *asset_json(const struct prepare *prepare, const struct prepare_asset *asset)
{
    char *file = folder_file_name(asset->key);
    json_t *root = json_pack("{s:s,s:s,s:s,s:I,s:I,s:f,s:o?,s:o}", "id", asset->plant->id, "state", report_states[asset->state], "file",
                             file, "triangles", (json_int_t)asset->triangles, "vertices", (json_int_t)asset->vertices, "seconds",
                             asset->seconds, "rebuilt_because", asset->rebuilt_because ? json_of_text(asset->rebuilt_because) : NULL,
                             "sensors", sensors_json(prepare, asset));
    if (asset_longest_m(asset->size_m) > 0)
        json_object_set_new(root, "size_m", json_pack("[f,f,f]", asset->size_m[0], asset->size_m[1], asset->size_m[2]));
    if (asset->reported) {
        json_object_set_new(root, "vertices_added", json_integer(report_added(asset)));
        json_object_update_new(root, build_report_to_json(&asset->report));
    }
    mem_free(file);
    return root;
}

static json_t *model_json(const struct model_file *model)
{
    json_t *root = json_pack("{s:o,s:b}", "path", json_of_text(model->path), "read", model->was_parsed);
    json_t *left_out = json_array();
    for (uint32_t i = 0; i < model->left_out_textures; i++)
        json_array_append_new(left_out, json_of_text(model->left_out[i]));
    if (model->was_parsed)
        json_object_update_new(root, json_pack("{s:f,s:I,s:I,s:I,s:I,s:O}", "seconds", model->parse_s, "skipped_lines",
                                               (json_int_t)model->skipped_lines, "skipped_points", (json_int_t)model->skipped_points,
                                               "scaled_rotations", (json_int_t)model->scaled_rotations, "left_out_textures",
                                               (json_int_t)model->left_out_textures, "left_out", left_out));
    json_decref(left_out);
    return root;
}

static json_t *concerns_json(const struct prepare *prepare)
{
    size_t count;
    struct report_concern *concerns = report_concerns(prepare, &count);
    json_t *list = json_array();
    for (size_t i = 0; i < count; i++)
        json_array_append_new(list, json_pack("{s:s,s:o}", "asset", concerns[i].asset->plant->id, "text", json_of_text(concerns[i].text)));
    report_concerns_free(concerns, count);
    return list;
}

bool report_json(const struct prepare *prepare, FILE *out)
{
    json_t *assets = json_array(), *models = json_array();
    json_t *root = json_pack("{s:s,s:f,s:I,s:b,s:o,s:o,s:o}", "plant", prepare->plant->name, "seconds", prepare->seconds, "removed",
                             (json_int_t)prepare->removed, "interrupted", prepare->interrupted, "look_at", concerns_json(prepare), "models",
                             models, "assets", assets);
    for (size_t i = 0; i < prepare->models.count; i++)
        json_array_append_new(models, model_json(&prepare->models.at[i]));
    for (size_t i = 0; i < prepare->asset_count; i++)
        if (prepare->assets[i].wanted)
            json_array_append_new(assets, asset_json(prepare, &prepare->assets[i]));
    char *text = root ? json_dumps(root, JSON_INDENT(1) | JSON_REAL_PRECISION(9)) : NULL;
    if (text)
        fprintf(out, "%s\n", text);
    free(text);
    json_decref(root);
    return text != NULL;
}
