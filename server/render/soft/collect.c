/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which clusters of triangles a picture may show. */
#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "render/plan/culling.h"
#include "render/soft/near.h"
#include "render/matrix.h"

void soft_fill_mesh(struct soft *soft, struct soft_mesh *mesh, int index, const struct model_level *level)
{
    const struct frame_context *context = soft->context;
    const struct scene_asset *asset = &context->gpu_scene->scene->assets[index];
    double clip[16], half[2] = { 0.5 * soft->width_px, 0.5 * soft->height_px };
    *mesh = (struct soft_mesh){
        .asset = index,
        .file = &asset->file->view,
        .has_field = context->fields[index] != NULL,
        .scalars = context->fields[index] ? context->fields[index]->shown : NULL,
        .baked = (const uint8_t(*)[4])soft->light->baked[index],
        .first_vertex = (uint32_t)soft->vertex_count,
        .vertex_count = level->vertex_count,
        .mirrored = scene_asset_mirrored(asset),
        .cut = clip_touches(&context->view->visibility.clip, asset->bounds_min_m, asset->bounds_max_m),
    };
    if (mesh->cut)
        matrix_normals(asset->placement, mesh->turn);
    matrix_multiply(context->constants.clip_from_plant, asset->placement, clip);
    view_constants_bring_forward(&context->constants, asset, clip);
    for (int c = 0; c < 4; c++) {
        mesh->place[c][0] = (float)(half[0] * (clip[4 * c + 3] + clip[4 * c]) - (double)soft->shift_px[0] * clip[4 * c + 3]);
        mesh->place[c][1] = (float)(half[1] * (clip[4 * c + 3] - clip[4 * c + 1]) - (double)soft->shift_px[1] * clip[4 * c + 3]);
        mesh->place[c][2] = (float)clip[4 * c + 2];
        mesh->place[c][3] = (float)clip[4 * c + 3];
    }
    soft->vertex_count += level->vertex_count;
}

/* Triangles that are cut become more. */
static uint32_t most_triangles(const struct soft *soft)
{
    return soft->cut_count > 0 ? CHUNK_TRIANGLES / NEAR_TRIANGLES : CHUNK_TRIANGLES;
}

/* A cluster of any size, in draws that fit into chunks. */
static void add_cluster(struct soft *soft, const struct soft_draw *whole)
{
    uint32_t most = 3 * most_triangles(soft);
    for (uint32_t done = 0; done < whole->index_count; done += most) {
        struct soft_draw part = *whole;
        uint32_t left = whole->index_count - done;
        part.first_index += done;
        part.index_count = left < most ? left : most;
        mem_grow(&soft->draws, &soft->draw_capacity, soft->draw_count + 1, sizeof(*soft->draws));
        soft->draws[soft->draw_count++] = part;
    }
}

/* In metres of the plant: a placement turns and moves only. */
static float nearest(const struct culling *culling, const struct asset_cluster *cluster)
{
    float away = 0, size = 0;
    for (int c = 0; c < 3; c++) {
        float half = 0.5f * (cluster->high_m[c] - cluster->low_m[c]), by = cluster->low_m[c] + half - culling->eye_m[c];
        away += by * by;
        size += half * half;
    }
    return sqrtf(away) - sqrtf(size);
}

static bool is_cut_away(const struct soft *soft, const struct soft_mesh *mesh, const struct asset_cluster *cluster)
{
    bool cut = false;
    for (int p = 0; p < soft->cut_count && mesh->cut; p++)
        if (soft_cuts_box(soft, mesh, p, cluster->low_m, cluster->high_m, &cut))
            return true;
    return false;
}

static void collect_asset(struct soft *soft, int index)
{
    const struct frame_context *context = soft->context;
    const struct scene_asset *asset = &context->gpu_scene->scene->assets[index];
    const struct model *model = context->gpu_scene->of_asset[index];
    const struct model_level *level = frame_level(context, index);
    const struct asset_view *file = &asset->file->view;
    uint32_t ramp = soft->ramp_of_model[model - context->gpu_scene->models];
    size_t draws = soft->draw_count, vertices = soft->vertex_count;
    struct culling culling;
    mem_grow(&soft->meshes, &soft->mesh_capacity, soft->mesh_count + 1, sizeof(*soft->meshes));
    struct soft_mesh *mesh = &soft->meshes[soft->mesh_count];
    soft_fill_mesh(soft, mesh, index, level);
    culling_init(&culling, &context->constants, asset);
    const struct asset_cluster *cluster = &file->clusters[level->first_cluster];
    for (uint32_t p = 0; p < level->primitive_count; p++) {
        const struct asset_primitive *primitive = &file->primitives[level->first_primitive + p];
        const struct asset_material *material = &file->materials[primitive->material];
        uint32_t end = primitive->first_index + primitive->index_count;
        struct soft_draw draw = { .mesh = (uint32_t)soft->mesh_count, .double_sided = material->double_sided || mesh->cut };
        draw.mark = mesh->has_field ? MARK_FIELD : MARK_CONTEXT | (ramp + primitive->material) << 16;
        for (; cluster < file->clusters + file->header->cluster_count && cluster->first_index < end &&
               cluster->first_index >= primitive->first_index;
             cluster++) {
            if (!culling_sees(&culling, cluster, draw.double_sided) || is_cut_away(soft, mesh, cluster))
                continue;
            draw.near_m = nearest(&culling, cluster);
            draw.first_index = cluster->first_index;
            draw.index_count = cluster->index_count;
            add_cluster(soft, &draw);
        }
    }
    if (soft->draw_count > draws)
        soft->mesh_count++;
    else
        soft->vertex_count = vertices;
}

/* Nearest first, so that what is hidden costs little; always in the same order. */
static int by_distance(const void *a, const void *b)
{
    const struct soft_draw *x = a, *y = b;
    if (x->near_m != y->near_m)
        return x->near_m < y->near_m ? -1 : 1;
    if (x->mesh != y->mesh)
        return x->mesh < y->mesh ? -1 : 1;
    return (x->first_index > y->first_index) - (x->first_index < y->first_index);
}

static void cut_into_chunks(struct soft *soft)
{
    size_t triangles = 0;
    soft->chunk_count = 0;
    for (size_t d = 0; d < soft->draw_count; d++) {
        size_t count = soft->draws[d].index_count / 3;
        if (soft->chunk_count == 0 || triangles + count > most_triangles(soft)) {
            mem_grow(&soft->chunks, &soft->chunk_capacity, soft->chunk_count + 1, sizeof(*soft->chunks));
            struct soft_chunk *chunk = &soft->chunks[soft->chunk_count++];
            chunk->first_draw = d;
            chunk->draw_count = 0;
            triangles = 0;
        }
        soft->chunks[soft->chunk_count - 1].draw_count++;
        triangles += count;
    }
}

/* False: out of memory. */
static bool finish(struct soft *soft)
{
    if (soft->draw_count > 0)
        qsort(soft->draws, soft->draw_count, sizeof(*soft->draws), by_distance);
    cut_into_chunks(soft);
    if (soft->vertex_count <= soft->vertex_capacity)
        return true;
    mem_free(soft->vertices);
    soft->vertices = mem_try_array(soft->vertex_count + soft->vertex_count / 4, sizeof(*soft->vertices));
    soft->vertex_capacity = soft->vertices ? soft->vertex_count + soft->vertex_count / 4 : 0;
    return soft->vertices != NULL;
}

bool soft_collect(struct soft *soft)
{
    const struct frame_context *context = soft->context;
    soft->mesh_count = soft->draw_count = soft->vertex_count = 0;
    for (size_t i = 0; i < context->visible_count; i++)
        collect_asset(soft, context->visible[i]);
    return finish(soft);
}
