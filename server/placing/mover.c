/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Creates the relocation object of an asset, which computes geodesic distances from sensors moved on the asset's surface. */
#include "placing/mover.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "scene/manifest.h"

static void shape_of(const struct scene_asset *asset, struct relocation_shape *shape)
{
    const struct asset_view *view = &asset->file->view;
    const struct asset_level *finest = &view->levels[0];
    const struct asset_primitive *first = &view->primitives[finest->first_primitive], *last = first + finest->primitive_count - 1;
    *shape = (struct relocation_shape){ .positions_m = view->positions_m,
                                        .normals = view->normals,
                                        .vertex_count = view->header->vertex_count,
                                        .triangles = view->indices + first->first_index,
                                        .triangle_count = (last->first_index + last->index_count - first->first_index) / 3,
                                        .tolerance_m = asset->plant->tolerance_m };
}

/* Returns whether the manifest names the file that the daemon has opened. Otherwise the prepared surface may be of another model. */
static bool is_same_file(const struct scene_asset *asset, const struct manifest_entry *entry)
{
    const char *slash = strrchr(asset->file->path, '/');
    return entry->file && !strcmp(slash ? slash + 1 : asset->file->path, entry->file);
}

struct relocation *mover_create(struct log *log, struct workers *workers, const struct scene *scene, const char *folder, int asset)
{
    const struct scene_asset *of = &scene->assets[asset];
    struct manifest manifest = { 0 };
    struct relocation_shape shape;
    char *path = NULL;
    shape_of(of, &shape);
    bool read = manifest_read(log, folder, &manifest);
    const struct manifest_entry *entry = read ? manifest_find(&manifest, of->plant->id) : NULL;
    if (entry && entry->surface && is_same_file(of, entry)) {
        shape.surface_path = path = mem_printf("%s/%s", folder, entry->surface);
        /* the prepared surface is in the file KEY.surface, with the key in hexadecimal digits */
        shape.surface_key = strtoull(entry->surface, NULL, 16);
    }
    struct relocation *relocation = relocation_create(log, workers, &shape);
    mem_free(path);
    if (read)
        manifest_finish(&manifest);
    return relocation;
}
