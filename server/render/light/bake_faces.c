/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the large triangles of an asset. Light is sampled inside them, too, not only at their vertices. */
#include "render/light/bake_faces.h"

#include "base/mem.h"

static double square_m(const float a[3], const float b[3])
{
    double sum = 0;
    for (int c = 0; c < 3; c++)
        sum += ((double)a[c] - (double)b[c]) * ((double)a[c] - (double)b[c]);
    return sum;
}

static bool is_large(const struct asset_view *view, const uint32_t *corner, double least_m)
{
    for (int i = 0; i < 3; i++)
        if (square_m(view->positions_m[corner[i]], view->positions_m[corner[(i + 1) % 3]]) >= least_m * least_m)
            return true;
    return false;
}

bool bake_faces_init(struct bake_faces *faces, const struct gpu_scene *gpu_scene, size_t asset, double least_m)
{
    const struct asset_view *view = &gpu_scene->scene->assets[asset].file->view;
    const struct asset_level *level = &view->levels[0];
    uint32_t(*corners)[3] = NULL;
    size_t capacity = 0;
    *faces = (struct bake_faces){ 0 };
    for (uint32_t p = 0; p < level->primitive_count; p++) {
        const struct asset_primitive *primitive = &view->primitives[level->first_primitive + p];
        for (uint32_t i = 0; i < primitive->index_count; i += 3) {
            const uint32_t *corner = &view->indices[primitive->first_index + i];
            if (!is_large(view, corner, least_m))
                continue;
            mem_grow(&corners, &capacity, faces->count + 1, sizeof(*corners));
            for (int c = 0; c < 3; c++)
                corners[faces->count][c] = corner[c];
            faces->count++;
        }
    }
    if (faces->count == 0)
        return true;
    const char *id = gpu_scene->scene->assets[asset].plant->id;
    faces->corners = mesh_buffer(gpu_scene->gl->log, id, faces->count * sizeof(*corners), corners, 0);
    faces->sums = mesh_buffer(gpu_scene->gl->log, id, view->header->vertex_count * sizeof(uint32_t[3]), NULL, 0);
    mem_free(corners);
    if (!faces->corners || !faces->sums) {
        bake_faces_finish(faces);
        return false;
    }
    glClearNamedBufferData(faces->sums, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, NULL);
    return true;
}

void bake_faces_finish(struct bake_faces *faces)
{
    glDeleteBuffers(1, &faces->corners);
    glDeleteBuffers(1, &faces->sums);
    *faces = (struct bake_faces){ 0 };
}
