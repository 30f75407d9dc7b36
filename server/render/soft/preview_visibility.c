/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fills the visibility buffer of a preview whose camera stands still, so that new readings only need new colours
   (render/soft/visibility_buffer.h). */
#include <string.h>

#include "base/mem.h"
#include "render/pick/markers.h"
#include "render/soft/kernels.h"
#include "render/soft/ramps.h"
#include "render/soft/tile.h"

struct keeping {
    const struct raster *raster;
    struct visibility_buffer *buffer;
};

struct preview_triangle { /* a triangle projected into the frame; cached while the visibility buffer is filled */
    uint32_t id;
    uint32_t number; /* index of the triangle in the list of its band (group of pixel rows) */
    /* coefficients from soft_weights(): the weight of corner i at the point (x, y) is weights[i][0] x + weights[i][1] y + weights[i][2], up
       to a common factor */
    double weights[3][3];
};

void soft_weights(const struct soft_mesh *mesh, const uint32_t vertices[3], double weights[3][3])
{
    double at[3][3]; /* by corner of the triangle: its projected position as (x w, y w, w), with x and y in pixels */
    static const int rows[3] = { 0, 1, 3 };
    for (int i = 0; i < 3; i++) {
        const float *p = mesh->file->positions_m[vertices[i]];
        for (int r = 0; r < 3; r++) {
            const float(*m)[4] = mesh->place;
            at[i][r] = (double)m[0][rows[r]] * p[0] + (double)m[1][rows[r]] * p[1] + (double)m[2][rows[r]] * p[2] + m[3][rows[r]];
        }
    }
    for (int i = 0; i < 3; i++) {
        const double *q = at[(i + 1) % 3], *r = at[(i + 2) % 3];
        for (int c = 0; c < 3; c++)
            weights[i][c] = q[(c + 1) % 3] * r[(c + 2) % 3] - q[(c + 2) % 3] * r[(c + 1) % 3];
    }
}

static void find_spot(const struct keeping *keeping, struct visibility_band *band, uint32_t id, struct preview_triangle *spot)
{
    const struct raster *raster = keeping->raster;
    struct soft_triangle triangle = { 0 };
    raster_find_triangle(raster, id, &triangle);
    const struct soft_mesh *mesh = &raster->meshes[triangle.mesh];
    uint32_t of_picture[3];
    for (int i = 0; i < 3; i++)
        of_picture[i] = mesh->first_vertex + triangle.vertices[i];
    spot->id = id;
    spot->number = visibility_add_triangle(band, of_picture);
    soft_weights(mesh, triangle.vertices, spot->weights);
}

static uint32_t weights_at(const struct preview_triangle *spot, double x, double y)
{
    double w[3], sum = 0;
    for (int i = 0; i < 3; i++) {
        w[i] = spot->weights[i][0] * x + spot->weights[i][1] * y + spot->weights[i][2];
        sum += w[i];
    }
    uint32_t out[2];
    for (int i = 0; i < 2; i++) {
        double part = sum != 0 ? w[i + 1] / sum : 0;
        out[i] = part <= 0 ? 0 : part >= 1 ? 65535 : (uint32_t)(part * 65535 + 0.5);
    }
    /* rounding may make the sum of the two weights larger than 65535, which means 1: corrects one of the weights */
    if (out[0] + out[1] > 65535)
        out[1] = 65535 - out[0];
    return out[0] | out[1] << 16;
}

static void keep_band(const struct keeping *keeping, int number)
{
    enum { CACHED_TRIANGLES = 256 };
    const struct raster *raster = keeping->raster;
    struct visibility_buffer *buffer = keeping->buffer;
    struct visibility_band *band = &buffer->bands[number];
    /* cache of projected triangles by triangle id: neighbouring pixels mostly show the same triangles */
    struct preview_triangle spots[CACHED_TRIANGLES];
    for (int i = 0; i < CACHED_TRIANGLES; i++)
        spots[i].id = UINT32_MAX;
    int end = (number + 1) * buffer->band_rows < buffer->height_px ? (number + 1) * buffer->band_rows : buffer->height_px;
    for (int y = number * buffer->band_rows; y < end; y++) {
        size_t from = (size_t)y * (size_t)raster->pitch_px, to = (size_t)y * (size_t)buffer->width_px;
        const uint32_t *out = (const uint32_t *)(const void *)(raster->out + (size_t)y * raster->out_stride_bytes);
        for (size_t x = 0; x < (size_t)buffer->width_px; x++) {
            uint32_t mark = raster->marks[from + x], id = raster->ids[from + x];
            if (!(mark & MARK_FIELD) || mark & MARK_CONTEXT) {
                buffer->surfaces[to + x] = VISIBILITY_FIXED | (out[x] & 0xffffff);
                continue;
            }
            struct preview_triangle *spot = &spots[(id ^ id >> 8) % CACHED_TRIANGLES];
            if (spot->id != id)
                find_spot(keeping, band, id, spot);
            buffer->surfaces[to + x] = spot->number;
            buffer->weights[to + x] = weights_at(spot, (double)x + 0.5, y + 0.5);
            buffer->rows[to + x] = (uint8_t)((mark & MARK_PLACE) / COLORMAP_COLUMNS);
        }
    }
}

static void keep_bands(void *arg, size_t begin, size_t end)
{
    for (size_t band = begin; band < end; band++)
        keep_band(arg, (int)band);
}

struct visibility_buffer *raster_keep(struct raster *raster)
{
    struct visibility_buffer *buffer = visibility_buffer_create(raster->width_px, raster->height_px, BAND_ROWS);
    if (!buffer)
        return NULL;
    for (size_t m = 0; m < raster->mesh_count; m++) {
        const struct soft_mesh *mesh = &raster->meshes[m];
        if (mesh->has_field)
            visibility_buffer_add_mesh(buffer, &(struct visibility_mesh){ .asset = mesh->asset,
                                                                          .file = mesh->file,
                                                                          .first_vertex = mesh->first_vertex,
                                                                          .vertex_count = mesh->vertex_count });
    }
    struct keeping keeping = { raster, buffer };
    workers_for(raster->soft->workers, (size_t)buffer->band_count, 1, keep_bands, &keeping);
    return buffer;
}

void raster_keep_rim(const struct raster *raster, struct visibility_buffer *buffer)
{
    const uint8_t *rim = raster_rim(raster);
    for (int y = 0; y < raster->height_px; y++) {
        size_t from = (size_t)y * (size_t)raster->pitch_px, to = (size_t)y * (size_t)raster->width_px;
        for (size_t x = 0; x < (size_t)raster->width_px; x++)
            if (rim[from + x] && !raster->marks[from + x])
                buffer->ink[to + x] = rim[from + x] == RIM_DARK ? VISIBILITY_RIM_DARK : VISIBILITY_RIM_LIGHT;
    }
}

static void forget(void *buffer)
{
    visibility_buffer_destroy(&(struct visibility_buffer *){ buffer });
}

void soft_keep(struct soft *soft, const struct frame_context *context, struct visibility_buffer *buffer, const struct frame *frame)
{
    buffer->markers = mem_array(frame->marker_count, sizeof(*buffer->markers));
    buffer->marker_count = frame->marker_count;
    buffer->grid = depth_grid_ref(frame->depth[0]);
    if (frame->marker_count > 0)
        memcpy(buffer->markers, frame->markers, frame->marker_count * sizeof(*buffer->markers));
    visibility_store_give(&soft->kept[context->view->tier], context->shape, buffer, visibility_buffer_bytes(buffer), forget);
}

/* Fills the colour map of the glossy look. For each colour in the middle row of the plain colour map, a column holds that
   colour from dark to bright, one row per brightness step, like GLOSSY in shaders/preview.frag. */
static void make_glossy(struct soft *soft, const struct shaded_colormap *colormap)
{
    if (soft->glossy_version == colormap->version)
        return;
    if (!soft->glossy)
        soft->glossy = mem_array(COLORMAP_ROWS * COLORMAP_COLUMNS, sizeof(*soft->glossy));
    for (int column = 0; column < COLORMAP_COLUMNS; column++)
        ramp_fill_glossy(colormap->texels[COLORMAP_ROWS / 2][column], COLORMAP_ROWS, soft->glossy + column, COLORMAP_COLUMNS);
    soft->glossy_version = colormap->version;
}

const uint32_t *soft_colormap(struct soft *soft, const struct shaded_colormap *colormap, bool glossy)
{
    if (glossy)
        make_glossy(soft, colormap);
    return glossy ? soft->glossy : colormap->texels[0];
}

bool soft_resolve_again(struct soft *soft, const struct frame_context *context, const struct isoline_points *points, struct frame *frame)
{
    struct visibility_buffer *buffer = visibility_store_find(&soft->kept[context->view->tier], context->shape);
    struct frame_uniforms block;
    if (!buffer || (context->colormap.lines && !buffer->lined) || (points->count > 0 && !buffer->depth) ||
        (context->gives_depth && !buffer->grid))
        return false;
    frame_uniforms_fill(&block, context);
    const struct resolve_paint paint = { soft_colormap(soft, &context->colormap, context->view->look == LOOK_GLOSSY && !buffer->gloss),
                                         block.scale[3], block.lines[0], context->colormap.nearest };
    resolve_read(buffer, context, soft->workers);
    struct resolve_job coloring = { buffer, paint, 0, frame };
    workers_for(soft->workers, (size_t)buffer->band_count, 2, soft->kernels->color_bands, &coloring);
    if (points->count > 0)
        isolines_find(context, points, buffer->depth, (size_t)buffer->width_px, frame);
    frame->depth[0] = depth_grid_ref(buffer->grid);
    frame->markers = mem_array(buffer->marker_count, sizeof(*frame->markers));
    frame->marker_count = buffer->marker_count;
    memcpy(frame->markers, buffer->markers, buffer->marker_count * sizeof(*buffer->markers));
    /* recomputes the distances that markers show: the user may have chosen another sensor since the visibility buffer was stored */
    markers_measure(context, frame);
    return true;
}
