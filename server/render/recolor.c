/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From readings to what the vertices of a kept picture carry. */
#include "render/recolor.h"

#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "render/recolor_impl.h"

enum { VERTICES_AT_ONCE = 8192 };

struct recolor *recolor_create(int width_px, int height_px, int band_rows)
{
    struct recolor *recolor = mem_new(sizeof(*recolor));
    size_t pixels = (size_t)width_px * (size_t)height_px;
    *recolor = (struct recolor){ .width_px = width_px, .height_px = height_px, .band_rows = band_rows };
    recolor->band_count = (height_px + band_rows - 1) / band_rows;
    recolor->surfaces = mem_try_array(pixels, sizeof(*recolor->surfaces));
    recolor->weights = mem_try_array(pixels, sizeof(*recolor->weights));
    recolor->rows = mem_try_array(pixels, sizeof(*recolor->rows));
    recolor->ink = mem_try_array(pixels, sizeof(*recolor->ink));
    recolor->bands = mem_array((size_t)recolor->band_count, sizeof(*recolor->bands));
    if (!recolor->surfaces || !recolor->weights || !recolor->rows || !recolor->ink)
        recolor_destroy(&recolor);
    return recolor;
}

void recolor_destroy(struct recolor **recolor_ptr)
{
    struct recolor *recolor = *recolor_ptr;
    if (!recolor)
        return;
    for (int i = 0; i < recolor->band_count; i++) {
        mem_free(recolor->bands[i].triangles);
        mem_free(recolor->bands[i].corners);
        mem_free(recolor->bands[i].slopes);
        mem_free(recolor->bands[i].parts);
        mem_free(recolor->bands[i].mixed);
    }
    mem_free(recolor->bands);
    mem_free(recolor->meshes);
    mem_free(recolor->surfaces);
    mem_free(recolor->weights);
    mem_free(recolor->rows);
    mem_free(recolor->ink);
    mem_free(recolor->veil);
    mem_free(recolor->depth);
    mem_free(recolor->vertices);
    mem_free(recolor->carried);
    mem_free(recolor->plain);
    mem_free(recolor->flags);
    mem_free(recolor->markers);
    mem_free(recolor);
    *recolor_ptr = NULL;
}

size_t recolor_bytes(const struct recolor *recolor)
{
    size_t pixels = (size_t)recolor->width_px * (size_t)recolor->height_px;
    size_t bytes = pixels * (sizeof(*recolor->surfaces) + sizeof(*recolor->weights) + 2 + (recolor->veil ? 1 : 0) +
                             (recolor->depth ? sizeof(*recolor->depth) : 0));
    bytes += recolor->vertex_count *
             (sizeof(*recolor->vertices) + sizeof(*recolor->carried) + sizeof(*recolor->plain) + sizeof(*recolor->flags));
    for (int i = 0; i < recolor->band_count; i++) {
        const struct recolor_band *band = &recolor->bands[i];
        bytes += band->slope_capacity * sizeof(*band->slopes);
        bytes += band->triangle_capacity * (sizeof(*band->triangles) + sizeof(*band->corners)) +
                 band->part_capacity * sizeof(*band->parts) + band->mixed_capacity * sizeof(*band->mixed);
    }
    return bytes;
}

uint32_t recolor_triangle(struct recolor_band *band, const uint32_t vertices[3])
{
    if (band->triangle_count > 0 && !memcmp(band->triangles[band->triangle_count - 1], vertices, sizeof(*band->triangles)))
        return (uint32_t)band->triangle_count - 1;
    mem_grow(&band->triangles, &band->triangle_capacity, band->triangle_count + 1, sizeof(*band->triangles));
    memcpy(band->triangles[band->triangle_count], vertices, sizeof(*band->triangles));
    return (uint32_t)band->triangle_count++;
}

void recolor_add_slopes(struct recolor_band *band, const double weights[3][3])
{
    double sum[3];
    for (int c = 0; c < 3; c++)
        sum[c] = weights[0][c] + weights[1][c] + weights[2][c];
    mem_grow(&band->slopes, &band->slope_capacity, band->triangle_count, sizeof(*band->slopes));
    band->slopes[band->triangle_count - 1] = (struct recolor_slopes){
        .w1_x = (float)weights[1][0],
        .w1_y = (float)weights[1][1],
        .w2_x = (float)weights[2][0],
        .w2_y = (float)weights[2][1],
        .sum_x = (float)sum[0],
        .sum_y = (float)sum[1],
        .sum = (float)sum[2],
    };
}

void recolor_add_mesh(struct recolor *recolor, const struct recolor_mesh *mesh)
{
    mem_grow(&recolor->meshes, &recolor->mesh_capacity, recolor->mesh_count + 1, sizeof(*recolor->meshes));
    recolor->meshes[recolor->mesh_count++] = *mesh;
}

/* --- once its pixels are known ---------------------------------------------------------------------------------------------------- */

struct settling {
    struct recolor *recolor;
    uint32_t *numbers; /* by vertex of the picture: 0: of no triangle that is seen; then one more than its number here */
};

static void settle_inks(struct recolor *recolor, size_t begin, size_t end)
{
    for (size_t at = begin; at < end; at++)
        if (has_ink(recolor, at) && recolor->surfaces[at] & RECOLOR_FIXED) {
            recolor->surfaces[at] = RECOLOR_FIXED | inked(recolor, at, recolor->surfaces[at] & ~RECOLOR_FIXED);
            recolor->ink[at] = 0;
            if (recolor->veil)
                recolor->veil[at] = 0;
        }
}

static void settle_bands(void *arg, size_t begin, size_t end)
{
    const struct settling *settling = arg;
    struct recolor *recolor = settling->recolor;
    size_t row = (size_t)recolor->width_px, rows = (size_t)recolor->band_rows, height = (size_t)recolor->height_px;
    for (size_t b = begin; b < end; b++) {
        const struct recolor_band *band = &recolor->bands[b];
        settle_inks(recolor, b * rows * row, ((b + 1) * rows < height ? (b + 1) * rows : height) * row);
        for (size_t t = 0; t < band->triangle_count; t++)
            for (int i = 0; i < 3; i++)
                __atomic_store_n(&settling->numbers[band->triangles[t][i]], 1, __ATOMIC_RELAXED);
    }
}

static void number_bands(void *arg, size_t begin, size_t end)
{
    const struct settling *settling = arg;
    for (size_t b = begin; b < end; b++) {
        struct recolor_band *band = &settling->recolor->bands[b];
        for (size_t t = 0; t < band->triangle_count; t++)
            for (int i = 0; i < 3; i++)
                band->triangles[t][i] = settling->numbers[band->triangles[t][i]] - 1;
    }
}

/* Of those that are seen, mesh by mesh. */
static void number_vertices(struct recolor *recolor, uint32_t *numbers)
{
    uint32_t count = 0;
    for (size_t m = 0; m < recolor->mesh_count; m++) {
        struct recolor_mesh *mesh = &recolor->meshes[m];
        uint32_t *of_mesh = numbers + mesh->first_vertex, first = count;
        for (uint32_t v = 0; v < mesh->vertex_count; v++)
            if (of_mesh[v]) {
                recolor->vertices[count++] = v;
                of_mesh[v] = count;
            }
        mesh->first_vertex = first;
        mesh->vertex_count = count - first;
    }
}

static size_t count_seen(const uint32_t *numbers, size_t all)
{
    size_t count = 0;
    for (size_t v = 0; v < all; v++)
        count += numbers[v];
    return count;
}

bool recolor_settle(struct recolor *recolor, struct workers *workers)
{
    size_t all = 0, count = 0;
    for (size_t m = 0; m < recolor->mesh_count; m++)
        all = (size_t)recolor->meshes[m].first_vertex + recolor->meshes[m].vertex_count;
    struct settling settling = { recolor, mem_try_array(all, sizeof(*settling.numbers)) };
    if (settling.numbers) {
        workers_for(workers, (size_t)recolor->band_count, 4, settle_bands, &settling);
        count = count_seen(settling.numbers, all);
        recolor->vertices = mem_try_array(count, sizeof(*recolor->vertices));
        recolor->carried = mem_try_array(count, sizeof(*recolor->carried));
        recolor->plain = mem_try_array(count, sizeof(*recolor->plain));
        recolor->flags = mem_try_array(count, sizeof(*recolor->flags));
    }
    bool good = settling.numbers && recolor->vertices && recolor->carried && recolor->plain && recolor->flags;
    if (good) {
        recolor->vertex_count = count;
        number_vertices(recolor, settling.numbers);
        workers_for(workers, (size_t)recolor->band_count, 4, number_bands, &settling);
    }
    mem_free(settling.numbers);
    return good;
}

/* --- readings ---------------------------------------------------------------------------------------------------------------- */

static float carried_of(const struct scalar *scalar, const float *scale)
{
    return is_log(scale) ? scalar->value : column_of(scalar->value, scale);
}

struct reading_job {
    struct recolor *recolor;
    const struct scalar *scalars; /* NULL: no data anywhere */
    const float *scale;
    uint32_t first_vertex;
};

static void read_vertices(void *arg, size_t begin, size_t end)
{
    const struct reading_job *job = arg;
    struct recolor *recolor = job->recolor;
    static const struct scalar nothing = { .lacking = 255 };
    for (size_t at = job->first_vertex + begin; at < job->first_vertex + end; at++) {
        const struct scalar *scalar = job->scalars ? &job->scalars[recolor->vertices[at]] : &nothing;
        float carried = job->scalars ? carried_of(scalar, job->scale) : 0;
        uint32_t flags = draft_flags(scalar);
        bool patterned = (flags & DRAFT_PATTERNS) != 0;
        recolor->flags[at] = flags;
        recolor->plain[at] = carried;
        recolor->carried[at] = patterned ? NAN : carried;
    }
}

static void read_corners(void *arg, size_t begin, size_t end)
{
    struct recolor *recolor = arg;
    for (size_t b = begin; b < end; b++) {
        struct recolor_band *band = &recolor->bands[b];
        mem_grow(&band->corners, &band->corner_capacity, band->triangle_count, sizeof(*band->corners));
        for (size_t t = 0; t < band->triangle_count; t++) {
            const uint32_t *v = band->triangles[t];
            float first = recolor->carried[v[0]];
            memcpy(band->corners[t], (float[4]){ first, recolor->carried[v[1]] - first, recolor->carried[v[2]] - first, 0 },
                   sizeof(*band->corners));
        }
    }
}

void recolor_read(struct recolor *recolor, const struct frame_context *context, struct workers *workers)
{
    struct frame_uniforms block;
    frame_uniforms_fill(&block, context);
    bool same_scale = !memcmp(recolor->scale, block.scale, sizeof(recolor->scale)), changed = false;
    memcpy(recolor->scale, block.scale, sizeof(recolor->scale));
    for (size_t m = 0; m < recolor->mesh_count; m++) {
        struct recolor_mesh *mesh = &recolor->meshes[m];
        const struct fields_entry *field = context->fields[mesh->asset];
        struct reading_job job = { recolor, field->shown, block.scale, mesh->first_vertex };
        if (mesh->read && same_scale && mesh->content == field->content && field->shown)
            continue;
        workers_for(workers, mesh->vertex_count, VERTICES_AT_ONCE, read_vertices, &job);
        mesh->read = true;
        mesh->content = field->content;
        changed = true;
    }
    if (changed)
        workers_for(workers, (size_t)recolor->band_count, 4, read_corners, recolor);
}
