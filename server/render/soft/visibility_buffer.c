/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Creates, completes and frees visibility buffers, and copies the newest field values into their vertices. */
#include "render/soft/visibility_buffer.h"

#include <math.h>
#include <string.h>

#include "base/math/search.h"
#include "base/mem.h"
#include "render/depth_grid.h"
#include "render/soft/visibility_buffer_impl.h"

enum { VERTICES_AT_ONCE = 8192 };

struct visibility_buffer *visibility_buffer_create(int width_px, int height_px, int band_rows)
{
    struct visibility_buffer *buffer = mem_new(sizeof(*buffer));
    size_t pixels = (size_t)width_px * (size_t)height_px;
    *buffer = (struct visibility_buffer){ .width_px = width_px, .height_px = height_px, .band_rows = band_rows };
    buffer->band_count = (height_px + band_rows - 1) / band_rows;
    buffer->surfaces = mem_try_array(pixels, sizeof(*buffer->surfaces));
    buffer->weights = mem_try_array(pixels, sizeof(*buffer->weights));
    buffer->rows = mem_try_array(pixels, sizeof(*buffer->rows));
    buffer->ink = mem_try_array(pixels, sizeof(*buffer->ink));
    buffer->bands = mem_array((size_t)buffer->band_count, sizeof(*buffer->bands));
    if (!buffer->surfaces || !buffer->weights || !buffer->rows || !buffer->ink)
        visibility_buffer_destroy(&buffer);
    return buffer;
}

void visibility_buffer_destroy(struct visibility_buffer **buffer_ptr)
{
    struct visibility_buffer *buffer = *buffer_ptr;
    if (!buffer)
        return;
    for (int i = 0; i < buffer->band_count; i++) {
        mem_free(buffer->bands[i].triangles);
        mem_free(buffer->bands[i].corners);
        mem_free(buffer->bands[i].places);
        mem_free(buffer->bands[i].slopes);
        mem_free(buffer->bands[i].parts);
        mem_free(buffer->bands[i].gloss);
        mem_free(buffer->bands[i].mixed);
        mem_free(buffer->bands[i].cells);
    }
    for (size_t m = 0; m < buffer->mesh_count; m++)
        pixel_field_finish(&buffer->meshes[m].pixels);
    mem_free(buffer->bands);
    mem_free(buffer->meshes);
    mem_free(buffer->surfaces);
    mem_free(buffer->weights);
    mem_free(buffer->rows);
    mem_free(buffer->gloss);
    mem_free(buffer->ink);
    mem_free(buffer->veil);
    mem_free(buffer->depth);
    mem_free(buffer->vertices);
    mem_free(buffer->carried);
    mem_free(buffer->plain);
    mem_free(buffer->flags);
    mem_free(buffer->markers);
    depth_grid_unref(&buffer->grid);
    mem_free(buffer);
    *buffer_ptr = NULL;
}

bool visibility_buffer_gloss(struct visibility_buffer *buffer, const struct soft_tones *tones)
{
    buffer->tones = tones;
    buffer->gloss = mem_try_array((size_t)buffer->width_px * (size_t)buffer->height_px, sizeof(*buffer->gloss));
    return buffer->gloss != NULL;
}

size_t visibility_buffer_bytes(const struct visibility_buffer *buffer)
{
    size_t pixels = (size_t)buffer->width_px * (size_t)buffer->height_px;
    size_t bytes = pixels * (sizeof(*buffer->surfaces) + sizeof(*buffer->weights) + 2 + (buffer->veil ? 1 : 0) +
                             (buffer->gloss ? sizeof(*buffer->gloss) : 0) + (buffer->depth ? sizeof(*buffer->depth) : 0));
    bytes +=
        buffer->vertex_count * (sizeof(*buffer->vertices) + sizeof(*buffer->carried) + sizeof(*buffer->plain) + sizeof(*buffer->flags));
    for (int i = 0; i < buffer->band_count; i++) {
        const struct visibility_band *band = &buffer->bands[i];
        bytes += band->place_capacity * sizeof(*band->places) + band->slope_capacity * sizeof(*band->slopes) +
                 band->gloss_capacity * sizeof(*band->gloss) + band->cell_capacity * sizeof(*band->cells);
        bytes += band->triangle_capacity * (sizeof(*band->triangles) + sizeof(*band->corners)) +
                 band->part_capacity * sizeof(*band->parts) + band->mixed_capacity * sizeof(*band->mixed);
    }
    return bytes;
}

uint32_t visibility_add_triangle(struct visibility_band *band, const uint32_t vertices[3])
{
    if (band->triangle_count > 0 && !memcmp(band->triangles[band->triangle_count - 1], vertices, sizeof(*band->triangles)))
        return (uint32_t)band->triangle_count - 1;
    mem_grow(&band->triangles, &band->triangle_capacity, band->triangle_count + 1, sizeof(*band->triangles));
    memcpy(band->triangles[band->triangle_count], vertices, sizeof(*band->triangles));
    return (uint32_t)band->triangle_count++;
}

void visibility_add_slopes(struct visibility_band *band, const double weights[3][3])
{
    double sum[3];
    for (int c = 0; c < 3; c++)
        sum[c] = weights[0][c] + weights[1][c] + weights[2][c];
    mem_grow(&band->slopes, &band->slope_capacity, band->triangle_count, sizeof(*band->slopes));
    band->slopes[band->triangle_count - 1] = (struct visibility_slopes){
        .w1_x = (float)weights[1][0],
        .w1_y = (float)weights[1][1],
        .w2_x = (float)weights[2][0],
        .w2_y = (float)weights[2][1],
        .sum_x = (float)sum[0],
        .sum_y = (float)sum[1],
        .sum = (float)sum[2],
    };
}

void visibility_buffer_add_mesh(struct visibility_buffer *buffer, const struct visibility_mesh *mesh)
{
    mem_grow(&buffer->meshes, &buffer->mesh_capacity, buffer->mesh_count + 1, sizeof(*buffer->meshes));
    buffer->meshes[buffer->mesh_count++] = *mesh;
}

/* --- completing the buffer --------------------------------------------------------------------------------------------------- */

struct band_settling {
    struct visibility_buffer *buffer;
    /* by index among all vertices of the frame: 0: no pixel shows the vertex; otherwise 1 + its index among the visible
       vertices, which are kept */
    uint32_t *numbers;
};

static void settle_inks(struct visibility_buffer *buffer, size_t begin, size_t end)
{
    for (size_t at = begin; at < end; at++)
        if (has_ink(buffer, at) && buffer->surfaces[at] & VISIBILITY_FIXED) {
            buffer->surfaces[at] = VISIBILITY_FIXED | inked(buffer, at, buffer->surfaces[at] & ~VISIBILITY_FIXED);
            buffer->ink[at] = 0;
            if (buffer->veil)
                buffer->veil[at] = 0;
        }
}

static void settle_bands(void *arg, size_t begin, size_t end)
{
    const struct band_settling *settling = arg;
    struct visibility_buffer *buffer = settling->buffer;
    size_t row = (size_t)buffer->width_px, rows = (size_t)buffer->band_rows, height = (size_t)buffer->height_px;
    for (size_t b = begin; b < end; b++) {
        const struct visibility_band *band = &buffer->bands[b];
        settle_inks(buffer, b * rows * row, ((b + 1) * rows < height ? (b + 1) * rows : height) * row);
        for (size_t t = 0; t < band->triangle_count; t++)
            for (int i = 0; i < 3; i++)
                __atomic_store_n(&settling->numbers[band->triangles[t][i]], 1, __ATOMIC_RELAXED);
    }
}

static void number_bands(void *arg, size_t begin, size_t end)
{
    const struct band_settling *settling = arg;
    for (size_t b = begin; b < end; b++) {
        struct visibility_band *band = &settling->buffer->bands[b];
        for (size_t t = 0; t < band->triangle_count; t++)
            for (int i = 0; i < 3; i++)
                band->triangles[t][i] = settling->numbers[band->triangles[t][i]] - 1;
    }
}

/* Renumbers the vertices that are visible at any pixel, mesh by mesh and consecutively, and drops all others. */
static void number_vertices(struct visibility_buffer *buffer, uint32_t *numbers)
{
    uint32_t count = 0;
    for (size_t m = 0; m < buffer->mesh_count; m++) {
        struct visibility_mesh *mesh = &buffer->meshes[m];
        uint32_t *of_mesh = numbers + mesh->first_vertex, first = count;
        for (uint32_t v = 0; v < mesh->vertex_count; v++)
            if (of_mesh[v]) {
                buffer->vertices[count++] = v;
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

bool visibility_buffer_settle(struct visibility_buffer *buffer, struct workers *workers)
{
    size_t all = 0, count = 0;
    for (size_t m = 0; m < buffer->mesh_count; m++)
        all = (size_t)buffer->meshes[m].first_vertex + buffer->meshes[m].vertex_count;
    struct band_settling settling = { buffer, mem_try_array(all, sizeof(*settling.numbers)) };
    if (settling.numbers) {
        workers_for(workers, (size_t)buffer->band_count, 4, settle_bands, &settling);
        count = count_seen(settling.numbers, all);
        buffer->vertices = mem_try_array(count, sizeof(*buffer->vertices));
        buffer->carried = mem_try_array(count, sizeof(*buffer->carried));
        buffer->plain = mem_try_array(count, sizeof(*buffer->plain));
        buffer->flags = mem_try_array(count, sizeof(*buffer->flags));
    }
    bool good = settling.numbers && buffer->vertices && buffer->carried && buffer->plain && buffer->flags;
    if (good) {
        buffer->vertex_count = count;
        number_vertices(buffer, settling.numbers);
        workers_for(workers, (size_t)buffer->band_count, 4, number_bands, &settling);
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
    struct visibility_buffer *buffer;
    /* values of the field at the asset's vertices, to be copied to the visible ones; NULL: the whole asset has no data */
    const struct scalar *scalars;
    const float *scale;
    uint32_t first_vertex;
};

static void read_vertices(void *arg, size_t begin, size_t end)
{
    const struct reading_job *job = arg;
    struct visibility_buffer *buffer = job->buffer;
    static const struct scalar nothing = { .lacking = 255 };
    for (size_t at = job->first_vertex + begin; at < job->first_vertex + end; at++) {
        const struct scalar *scalar = job->scalars ? &job->scalars[buffer->vertices[at]] : &nothing;
        float carried = job->scalars ? carried_of(scalar, job->scale) : 0;
        uint32_t flags = soft_flags(scalar);
        bool patterned = (flags & SOFT_PATTERNS) != 0;
        buffer->flags[at] = flags;
        buffer->plain[at] = carried;
        buffer->carried[at] = patterned ? NAN : carried;
    }
}

/* Returns the mesh of a vertex, given by its index among all vertices. likely: mesh to try first. */
static size_t mesh_of_vertex(const struct visibility_buffer *buffer, uint32_t vertex, size_t likely)
{
    const struct visibility_mesh *meshes = buffer->meshes;
    size_t after;
    if (vertex >= meshes[likely].first_vertex && vertex - meshes[likely].first_vertex < meshes[likely].vertex_count)
        return likely;
    /* meshes without vertices have the same first vertex as the next mesh. The binary search ends at the last mesh with this
       first vertex, which has vertices */
    search_sorted(after, buffer->mesh_count, meshes[after].first_vertex <= vertex);
    return after - 1;
}

static void place_triangle(const struct visibility_buffer *buffer, const struct asset_view *file, const uint32_t vertices[3],
                           struct visibility_place *out)
{
    const float *at[3];
    for (int i = 0; i < 3; i++)
        at[i] = file->positions_m[buffer->vertices[vertices[i]]];
    for (int c = 0; c < 3; c++) {
        out->first[c] = at[0][c];
        out->second[c] = at[1][c] - at[0][c];
        out->third[c] = at[2][c] - at[0][c];
    }
}

static void place_triangles(const struct visibility_buffer *buffer, struct visibility_band *band)
{
    mem_grow(&band->places, &band->place_capacity, band->triangle_count, sizeof(*band->places));
    for (size_t t = band->place_count, mesh = 0; t < band->triangle_count; t++) {
        mesh = mesh_of_vertex(buffer, band->triangles[t][0], mesh);
        place_triangle(buffer, buffer->meshes[mesh].file, band->triangles[t], &band->places[t]);
    }
    band->place_count = band->triangle_count;
}

static void mark_evaluated(const struct visibility_buffer *buffer, struct visibility_band *band)
{
    for (size_t t = 0, mesh = 0; t < band->triangle_count; t++) {
        mesh = mesh_of_vertex(buffer, band->triangles[t][0], mesh);
        if (buffer->meshes[mesh].pixels.count > 0)
            memcpy(band->corners[t], (float[4]){ 0, 0, 0, (float)(mesh + 1) }, sizeof(*band->corners));
    }
}

static void read_corners(void *arg, size_t begin, size_t end)
{
    struct visibility_buffer *buffer = arg;
    for (size_t b = begin; b < end; b++) {
        struct visibility_band *band = &buffer->bands[b];
        mem_grow(&band->corners, &band->corner_capacity, band->triangle_count, sizeof(*band->corners));
        for (size_t t = 0; t < band->triangle_count; t++) {
            const uint32_t *v = band->triangles[t];
            float first = buffer->carried[v[0]];
            memcpy(band->corners[t], (float[4]){ first, buffer->carried[v[1]] - first, buffer->carried[v[2]] - first, 0 },
                   sizeof(*band->corners));
        }
        if (!buffer->evaluates)
            continue;
        place_triangles(buffer, band);
        mark_evaluated(buffer, band);
        if (buffer->finds_cells)
            visibility_find_cells(buffer, (int)b);
    }
}

void resolve_read(struct visibility_buffer *buffer, const struct frame_context *context, struct workers *workers)
{
    struct frame_uniforms block;
    frame_uniforms_fill(&block, context);
    bool same_scale = !memcmp(buffer->scale, block.scale, sizeof(buffer->scale)), changed = false;
    memcpy(buffer->scale, block.scale, sizeof(buffer->scale));
    for (size_t m = 0; m < buffer->mesh_count; m++) {
        struct visibility_mesh *mesh = &buffer->meshes[m];
        const struct fields_entry *field = context->fields[mesh->asset];
        struct reading_job job = { buffer, field->shown, block.scale, mesh->first_vertex };
        if (mesh->read && same_scale && mesh->content == field->content && field->shown)
            continue;
        buffer->finds_cells |= (field->pixels.count > PIXEL_FEW) != (mesh->pixels.count > PIXEL_FEW);
        pixel_field_copy(&mesh->pixels, &field->pixels);
        mesh->every = pixel_list_of_all(&field->pixels);
        if (field->pixels.count == 0)
            workers_for(workers, mesh->vertex_count, VERTICES_AT_ONCE, read_vertices, &job);
        mesh->read = true;
        mesh->content = field->content;
        changed = true;
    }
    buffer->evaluates = false;
    for (size_t m = 0; m < buffer->mesh_count; m++)
        buffer->evaluates |= buffer->meshes[m].pixels.count > 0;
    if (changed)
        workers_for(workers, (size_t)buffer->band_count, 4, read_corners, buffer);
    buffer->finds_cells = false;
}
