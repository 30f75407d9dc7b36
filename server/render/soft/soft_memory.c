/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a preview keeps between pictures: how much it is, and giving it back. */
#include "base/mem.h"
#include "render/soft/soft_impl.h"

void soft_bound(struct soft *soft, size_t bytes)
{
    visibility_store_bound(&soft->kept, bytes);
}

size_t soft_kept_bytes(const struct soft *soft)
{
    return soft->kept.bytes;
}

static size_t parts_bytes(const struct soft_parts *parts)
{
    return parts->part_capacity * sizeof(*parts->parts) + parts->vertex_capacity * sizeof(*parts->vertices) +
           parts->place_capacity * sizeof(*parts->places_m) + parts->corner_capacity + parts->plane_capacity * sizeof(*parts->planes) +
           (parts->closed ? parts->vertex_count : 0);
}

size_t soft_room_bytes(const struct soft *soft)
{
    size_t bytes = soft->pixel_capacity * (sizeof(*soft->depth) + sizeof(*soft->marks)) + soft->mesh_capacity * sizeof(*soft->meshes) +
                   soft->found_capacity * sizeof(*soft->found);
    for (size_t i = 0; i < soft->found_capacity; i++)
        bytes += soft->found[i].capacity * sizeof(*soft->found[i].items);
    for (size_t m = 0; m < soft->gpu_scene->model_count; m++)
        for (size_t l = 0; soft->parts[m] && l < soft->gpu_scene->models[m].level_count; l++)
            bytes += sizeof(struct soft_parts) + parts_bytes(&soft->parts[m][l]);
    return bytes;
}

size_t soft_light_bytes(const struct soft *soft)
{
    size_t bytes = 0;
    for (int i = 0; i < SOFT_LIGHTS; i++) {
        const struct soft_light *light = &soft->lights[i];
        size_t row = light->sun_map ? (size_t)light->sun_map_px + 1 : 0, side = light->ground ? (size_t)light->ground_px : 0;
        bytes += row * row * sizeof(*light->sun_map) + side * side * sizeof(*light->ground);
        for (size_t a = 0; light->baked && a < soft->gpu_scene->scene->asset_count; a++)
            bytes += 4 * soft->gpu_scene->of_asset[a]->mesh.vertex_count;
    }
    return bytes;
}

static void drop_parts(struct soft *soft)
{
    for (size_t m = 0; soft->parts && m < soft->gpu_scene->model_count; m++) {
        for (size_t l = 0; soft->parts[m] && l < soft->gpu_scene->models[m].level_count; l++)
            soft_parts_finish(&soft->parts[m][l]);
        mem_free(soft->parts[m]);
        soft->parts[m] = NULL;
    }
    for (size_t i = 0; i < soft->found_capacity; i++)
        mem_free(soft->found[i].items);
    mem_free(soft->found);
    soft->found = NULL;
    soft->found_capacity = 0;
}

static void drop_room(struct soft *soft)
{
    mem_free(soft->meshes);
    mem_free(soft->depth);
    mem_free(soft->marks);
    soft->meshes = NULL;
    soft->depth = NULL;
    soft->marks = NULL;
    soft->mesh_count = soft->vertex_count = 0;
    soft->mesh_capacity = soft->pixel_capacity = 0;
}

void soft_rest(struct soft *soft)
{
    drop_parts(soft);
    drop_room(soft);
    for (int i = 0; i < SOFT_LIGHTS; i++)
        soft_free_light(soft, &soft->lights[i]);
    visibility_store_finish(&soft->kept);
}
