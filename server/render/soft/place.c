/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Vertices into the picture, and what of light and field they carry. */
#include <math.h>
#include <string.h>

#include "render/soft/soft_impl.h"

enum { BLOCK = 2048 };
#define FARTHEST 1e6f /* columns: what lies so far outside the scale is outside all the same */

static inline void place_one(const struct soft *soft, const struct soft_mesh *mesh, const float p[3], struct soft_vertex *out)
{
    float at[4];
    for (int r = 0; r < 4; r++)
        at[r] = mesh->place[0][r] * p[0] + mesh->place[1][r] * p[1] + mesh->place[2][r] * p[2] + mesh->place[3][r];
    float width = (float)soft->width_px * at[3], height = (float)soft->height_px * at[3];
    bool before = at[3] > 0 && at[2] <= at[3] && at[0] >= -width && at[0] <= 2 * width && at[1] >= -height && at[1] <= 2 * height;
    if (mesh->cut && soft_is_cut_off(soft, at, soft->cut_count))
        before = false;
    float inverse = before ? 1 / at[3] : 0;
    out->x = at[0] * inverse;
    out->y = at[1] * inverse;
    out->depth = at[2] * inverse;
    out->inverse_w = inverse;
}

static void carry_field(const struct soft *soft, const struct soft_mesh *mesh, uint32_t v, struct soft_vertex *out)
{
    /* As colormap_column and colormap_row in shaders/field.glsl. */
    const float slack = 1e-5f, columns = COLORMAP_PLACES / (1 + 2 * slack);
    const struct scalar *scalar = &mesh->scalars[v];
    float place = (scalar->value - soft->block.scale[0]) * soft->block.scale[1];
    out->a = fminf(fmaxf(place * columns + (1 + slack * columns), -FARTHEST), FARTHEST);
    out->b = (float)mesh->baked[v][0] * (1 / 255.0f) * soft->block.shade[0] + soft->block.shade[1];
    out->flags = soft_flags(scalar);
}

static void carry_nothing(const struct soft *soft, const struct soft_mesh *mesh, uint32_t v, struct soft_vertex *out)
{
    out->a = 0;
    out->b = (float)mesh->baked[v][0] * (1 / 255.0f) * soft->block.shade[0] + soft->block.shade[1];
    out->flags = SOFT_NOTHING_KNOWN;
}

static void carry_context(const struct soft_mesh *mesh, uint32_t v, struct soft_vertex *out)
{
    out->a = mesh->baked[v][1];
    out->b = mesh->baked[v][3];
    out->flags = 0;
}

static void place_range(const struct soft *soft, const struct soft_mesh *mesh, uint32_t begin, uint32_t end)
{
    struct soft_vertex *out = soft->vertices + mesh->first_vertex;
    for (uint32_t v = begin; v < end; v++)
        place_one(soft, mesh, mesh->file->positions_m[v], &out[v]);
    for (uint32_t v = begin; v < end; v++) {
        if (mesh->scalars)
            carry_field(soft, mesh, v, &out[v]);
        else if (mesh->has_field)
            carry_nothing(soft, mesh, v, &out[v]);
        else
            carry_context(mesh, v, &out[v]);
    }
}

struct placing {
    const struct soft *soft;
    size_t first;
};

/* Vertices of all meshes, counted through. */
static void place_block(void *arg, size_t begin, size_t end)
{
    const struct placing *placing = arg;
    const struct soft *soft = placing->soft;
    begin += placing->first;
    end += placing->first;
    for (size_t m = 0; m < soft->mesh_count; m++) {
        const struct soft_mesh *mesh = &soft->meshes[m];
        size_t first = mesh->first_vertex, last = first + mesh->vertex_count;
        if (first < end && last > begin)
            place_range(soft, mesh, (uint32_t)((begin > first ? begin : first) - first), (uint32_t)((end < last ? end : last) - first));
    }
}

void soft_place(struct soft *soft, size_t begin, size_t end)
{
    struct placing placing = { soft, begin };
    workers_for(soft->workers, end - begin, BLOCK, place_block, &placing);
}
