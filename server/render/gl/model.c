/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Uploads an asset file's geometry to the GPU and groups its triangles by material into submeshes. */
#include "render/gl/model.h"

#include "base/mem.h"

static bool make_mesh(struct gl_model *model, struct gl *gl)
{
    const struct asset_view *view = &model->file->view;
    struct mesh_params params = {
        .vertex_count = view->header->vertex_count,
        .index_count = view->header->index_count,
        .positions_m = view->positions_m,
        .normals = view->normals,
        .texcoords = view->texcoords,
        .second_texcoords = view->second_texcoords,
        .colors = view->colors,
        .indices = view->indices,
    };
    return mesh_init(&model->mesh, gl, model->file->path, &params);
}

/* Makes the submesh of a material: collects all primitives of a level of detail that have this material. */
static void fill_batch(struct model_submesh *submesh, const struct asset_view *view, const struct asset_level *level, uint32_t material)
{
    submesh->material = material;
    submesh->blend = view->materials[material].alpha == ASSET_ALPHA_BLEND;
    submesh->double_sided = view->materials[material].double_sided != 0;
    submesh->counts = mem_array(level->primitive_count, sizeof(*submesh->counts));
    submesh->offsets = mem_array(level->primitive_count, sizeof(*submesh->offsets));
    for (uint32_t i = 0; i < level->primitive_count; i++) {
        const struct asset_primitive *primitive = &view->primitives[level->first_primitive + i];
        if (primitive->material != material || primitive->index_count == 0)
            continue;
        submesh->counts[submesh->draws] = (GLsizei)primitive->index_count;
        submesh->offsets[submesh->draws++] = (const void *)((uintptr_t)primitive->first_index * 4);
        submesh->triangles += (int)(primitive->index_count / 3);
    }
}

static void make_level(struct model_level *level, const struct asset_view *view, const struct asset_level *from)
{
    uint32_t materials = view->header->material_count;
    level->error_m = from->error_m;
    level->vertex_count = from->vertex_count;
    level->first_primitive = from->first_primitive;
    level->primitive_count = from->primitive_count;
    level->submeshes = mem_array(materials, sizeof(*level->submeshes));
    for (int blend = 0; blend < 2; blend++)
        for (uint32_t m = 0; m < materials; m++) {
            if ((view->materials[m].alpha == ASSET_ALPHA_BLEND) != blend)
                continue;
            struct model_submesh *submesh = &level->submeshes[level->submesh_count];
            fill_batch(submesh, view, from, m);
            if (submesh->draws) {
                level->submesh_count++;
                level->triangles += submesh->triangles;
            } else {
                mem_free(submesh->counts);
                mem_free(submesh->offsets);
                *submesh = (struct model_submesh){ 0 };
            }
        }
}

/* Sets level->first_cluster, the index of the first of the level's clusters (groups of neighbouring triangles) in the asset file. */
static void find_clusters(struct model_level *level, const struct asset_view *view)
{
    uint32_t first_index = level->primitive_count ? view->primitives[level->first_primitive].first_index : 0;
    while (level->first_cluster < view->header->cluster_count && view->clusters[level->first_cluster].first_index < first_index)
        level->first_cluster++;
}

bool model_init(struct gl_model *model, struct gl *gl, const struct asset *file)
{
    const struct asset_header *header = file->view.header;
    *model = (struct gl_model){ .file = file };
    if (!make_mesh(model, gl))
        return false;
    model->levels = mem_array(header->level_count, sizeof(*model->levels));
    model->level_count = header->level_count;
    for (uint32_t i = 0; i < header->level_count; i++) {
        make_level(&model->levels[i], &file->view, &file->view.levels[i]);
        find_clusters(&model->levels[i], &file->view);
    }
    return true;
}

void model_finish(struct gl_model *model)
{
    for (size_t i = 0; i < model->level_count; i++) {
        for (size_t b = 0; b < model->levels[i].submesh_count; b++) {
            mem_free(model->levels[i].submeshes[b].counts);
            mem_free(model->levels[i].submeshes[b].offsets);
        }
        mem_free(model->levels[i].submeshes);
    }
    mem_free(model->levels);
    mesh_finish(&model->mesh);
    *model = (struct gl_model){ 0 };
}

const struct model_level *model_level(const struct gl_model *model, double error_m)
{
    size_t best = 0;
    for (size_t i = 1; i < model->level_count && model->levels[i].error_m <= error_m; i++)
        best = i;
    return &model->levels[best];
}

void model_draw_submesh(const struct model_submesh *submesh)
{
    if (submesh->draws == 1)
        glDrawElements(GL_TRIANGLES, submesh->counts[0], GL_UNSIGNED_INT, submesh->offsets[0]);
    else
        glMultiDrawElements(GL_TRIANGLES, submesh->counts, GL_UNSIGNED_INT, submesh->offsets, submesh->draws);
}

/* Appends an index range to the list of draws, or extends the last draw if the range directly follows it. Returns the new number of
   draws. */
static size_t add_draw(struct model_draws *draws, size_t count, uint32_t first_index, uint32_t index_count)
{
    const void *offset = (const void *)((uintptr_t)first_index * 4);
    if (count > 0 && (uintptr_t)draws->offsets[count - 1] + (uintptr_t)draws->counts[count - 1] * 4 == (uintptr_t)offset) {
        draws->counts[count - 1] += (GLsizei)index_count;
        return count;
    }
    mem_grow(&draws->counts, &draws->count_capacity, count + 1, sizeof(*draws->counts));
    mem_grow(&draws->offsets, &draws->offset_capacity, count + 1, sizeof(*draws->offsets));
    draws->counts[count] = (GLsizei)index_count;
    draws->offsets[count] = offset;
    return count + 1;
}

void model_draw_closed(struct model_draws *draws, const struct gl_model *model, const struct model_level *level)
{
    const struct closed_bodies *closed = asset_closed(model->file, (uint32_t)(level - model->levels));
    size_t count = 0;
    for (size_t i = 0; i < closed->run_count; i++)
        count = add_draw(draws, count, closed->runs[i].first_index, closed->runs[i].index_count);
    if (count > 0)
        glMultiDrawElements(GL_TRIANGLES, draws->counts, GL_UNSIGNED_INT, draws->offsets, (GLsizei)count);
}

void model_draws_finish(struct model_draws *draws)
{
    mem_free(draws->counts);
    mem_free(draws->offsets);
    *draws = (struct model_draws){ 0 };
}
