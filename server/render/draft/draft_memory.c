/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a draft keeps between pictures: how much it is, and giving it back. */
#include "base/mem.h"
#include "render/draft/draft_impl.h"

void draft_bound(struct draft *draft, size_t bytes)
{
    visibility_buffers_bound(&draft->kept, bytes);
}

size_t draft_kept_bytes(const struct draft *draft)
{
    return draft->kept.bytes;
}

static size_t chunk_bytes(const struct draft_chunk *chunk)
{
    return sizeof(*chunk) + chunk->triangle_capacity * sizeof(*chunk->triangles) + chunk->extra_capacity * sizeof(*chunk->extra) +
           chunk->band_capacity * sizeof(*chunk->bands) + chunk->sorted_capacity * sizeof(*chunk->sorted) +
           chunk->start_capacity * sizeof(*chunk->starts);
}

static size_t parts_bytes(const struct draft_parts *parts)
{
    return parts->part_capacity * sizeof(*parts->parts) + parts->vertex_capacity * sizeof(*parts->vertices) +
           parts->place_capacity * sizeof(*parts->places_m) + parts->corner_capacity + parts->plane_capacity * sizeof(*parts->planes) +
           (parts->closed ? parts->vertex_count : 0);
}

size_t draft_room_bytes(const struct draft *draft)
{
    size_t bytes = draft->pixel_capacity * (sizeof(*draft->depth) + sizeof(*draft->marks)) +
                   draft->vertex_capacity * sizeof(*draft->vertices) + draft->mesh_capacity * sizeof(*draft->meshes) +
                   draft->draw_capacity * sizeof(*draft->draws) + draft->found_capacity * sizeof(*draft->found);
    for (size_t i = 0; i < draft->chunk_capacity; i++)
        bytes += chunk_bytes(&draft->chunks[i]);
    for (size_t i = 0; i < draft->found_capacity; i++)
        bytes += draft->found[i].capacity * sizeof(*draft->found[i].items);
    for (size_t m = 0; m < draft->gpu_scene->model_count; m++)
        for (size_t l = 0; draft->parts[m] && l < draft->gpu_scene->models[m].level_count; l++)
            bytes += sizeof(struct draft_parts) + parts_bytes(&draft->parts[m][l]);
    return bytes;
}

size_t draft_light_bytes(const struct draft *draft)
{
    size_t bytes = 0;
    for (int i = 0; i < DRAFT_LIGHTS; i++) {
        const struct draft_light *light = &draft->lights[i];
        size_t row = light->sun_map ? (size_t)light->sun_map_px + 1 : 0, side = light->ground ? (size_t)light->ground_px : 0;
        bytes += row * row * sizeof(*light->sun_map) + side * side * sizeof(*light->ground);
        for (size_t a = 0; light->baked && a < draft->gpu_scene->scene->asset_count; a++)
            bytes += 4 * draft->gpu_scene->of_asset[a]->mesh.vertex_count;
    }
    return bytes;
}

static void drop_chunks(struct draft *draft)
{
    for (size_t i = 0; i < draft->chunk_capacity; i++) {
        mem_free(draft->chunks[i].triangles);
        mem_free(draft->chunks[i].extra);
        mem_free(draft->chunks[i].bands);
        mem_free(draft->chunks[i].sorted);
        mem_free(draft->chunks[i].starts);
    }
    mem_free(draft->chunks);
    draft->chunks = NULL;
    draft->chunk_count = draft->chunk_capacity = 0;
}

static void drop_parts(struct draft *draft)
{
    for (size_t m = 0; draft->parts && m < draft->gpu_scene->model_count; m++) {
        for (size_t l = 0; draft->parts[m] && l < draft->gpu_scene->models[m].level_count; l++)
            draft_parts_finish(&draft->parts[m][l]);
        mem_free(draft->parts[m]);
        draft->parts[m] = NULL;
    }
    for (size_t i = 0; i < draft->found_capacity; i++)
        mem_free(draft->found[i].items);
    mem_free(draft->found);
    draft->found = NULL;
    draft->found_capacity = 0;
}

static void drop_room(struct draft *draft)
{
    mem_free(draft->meshes);
    mem_free(draft->draws);
    mem_free(draft->vertices);
    mem_free(draft->depth);
    mem_free(draft->marks);
    draft->meshes = NULL;
    draft->draws = NULL;
    draft->vertices = NULL;
    draft->depth = NULL;
    draft->marks = NULL;
    draft->mesh_count = draft->draw_count = draft->vertex_count = 0;
    draft->mesh_capacity = draft->draw_capacity = draft->vertex_capacity = draft->pixel_capacity = 0;
}

void draft_rest(struct draft *draft)
{
    drop_chunks(draft);
    drop_parts(draft);
    drop_room(draft);
    for (int i = 0; i < DRAFT_LIGHTS; i++)
        draft_free_light(draft, &draft->lights[i]);
    visibility_buffers_finish(&draft->kept);
}
