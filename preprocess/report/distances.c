/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Prints one sensor's distances as a table. */
#include "preprocess/report/distances.h"

#include <math.h>

#include "base/mem.h"
#include "plant/models/transform.h"
#include "preprocess/cache/folder.h"
#include "preprocess/pipeline/sensor_distances.h"
#include "protocol/asset_distance.h"

static int column_of(const struct prepare_asset *asset, int tag)
{
    for (size_t i = 0; i < asset->sensor_count; i++)
        if (asset->sensors[i].tag == tag)
            return (int)i;
    return -1;
}

static void to_plant(const struct asset_view *view, const double placement[16], const float position[3], double out[3])
{
    double p[3];
    for (int axis = 0; axis < 3; axis++)
        p[axis] = view->header->origin_m[axis] + (double)position[axis];
    transform_point(placement, p, out);
}

/* Returns whether the vertex comes from the model, rather than from preparation. */
static bool is_own(const struct asset_view *view, uint32_t vertex)
{
    uint32_t level = 0;
    while (level + 1 < view->header->level_count && vertex < view->levels[level + 1].vertex_count)
        level++;
    return vertex < view->levels[level].vertex_count - view->levels[level].added_count;
}

bool distances_print(const struct prepare *prepare, const char *folder, int asset_number, int tag, FILE *out, struct diag *diag)
{
    const struct prepare_asset *asset = &prepare->assets[asset_number];
    int column = column_of(asset, tag);
    struct folder_file file;
    char why[200] = "missing";
    if (column < 0) {
        diag_error(diag, prepare->plant->files.tags_path, prepare->plant->tags[tag].line, 0, "tag %s is not a sensor of asset %s",
                   prepare->plant->tags[tag].name, asset->plant->id);
        return false;
    }
    if (prepare->plant->tags[tag].place.assumed && !sensor_distances_matter(prepare->plant, asset->sensors, asset->sensor_count)) {
        diag_error(diag, prepare->plant->files.tags_path, prepare->plant->tags[tag].line, 0,
                   "tag %s: the position on asset %s is only assumed: the sensor represents the whole asset and has no distances",
                   prepare->plant->tags[tag].name, asset->plant->id);
        return false;
    }
    if (folder_open(&file, folder, asset->key, why) != 1) {
        char *path = folder_asset_path(folder, asset->key);
        diag_error(diag, prepare->plant->files.path, asset->plant->line, 0,
                   "asset %s: the prepared file %s: %s; run plantcast-prep again", asset->plant->id, path, why);
        mem_free(path);
        return false;
    }
    if (!folder_unpack(&file)) {
        diag_error(diag, prepare->plant->files.path, asset->plant->line, 0, "asset %s: cannot compute the asset's distances: out of memory",
                   asset->plant->id);
        folder_close(&file);
        return false;
    }
    const struct asset_view *view = &file.view;
    uint32_t vertices = view->header->vertex_count;
    double source[3];
    to_plant(view, asset->plant->placement, view->sensors[column].surface_m, source);
    fprintf(out, "x,y,z,geodesic_m,euclidean_m\n");
    for (uint32_t v = 0; v < vertices; v++) {
        double p[3];
        if (!is_own(view, v))
            continue;
        to_plant(view, asset->plant->placement, view->positions_m[v], p);
        double euclidean_m = sqrt(pow(p[0] - source[0], 2) + pow(p[1] - source[1], 2) + pow(p[2] - source[2], 2));
        fprintf(out, "%.9g,%.9g,%.9g,%.7g,%.7g\n", p[0], p[1], p[2], (double)asset_distance_m(view, (size_t)column, v), euclidean_m);
    }
    folder_close(&file);
    return true;
}
