/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A moving picture whose camera stands still, taken apart, so that it can be coloured again (render/recolor.h). */
#include <string.h>

#include "base/mem.h"
#include "render/draft/draft_tile.h"

struct keeping {
    const struct draft *draft;
    struct recolor *recolor;
};

struct spot { /* a triangle, in the picture */
    uint32_t id;
    uint32_t number;      /* in the band */
    double weights[3][3]; /* of x, y and 1: of its corners, up to a factor */
};

/* The mesh that has this id. */
static size_t mesh_of(const struct draft *draft, uint32_t id)
{
    size_t low = 0, high = draft->mesh_count;
    while (high - low > 1) {
        size_t middle = (low + high) / 2;
        if (draft->found[middle].first_id <= id)
            low = middle;
        else
            high = middle;
    }
    return low;
}

void draft_weights(const struct draft_mesh *mesh, const uint32_t vertices[3], double weights[3][3])
{
    double at[3][3]; /* x w, y w, w */
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

static void find_spot(const struct keeping *keeping, struct recolor_band *band, uint32_t id, struct spot *spot)
{
    const struct draft *draft = keeping->draft;
    size_t m = mesh_of(draft, id);
    const struct draft_found *found = &draft->found[m];
    const struct draft_mesh *mesh = &draft->meshes[m];
    uint32_t local = id - found->first_id;
    const struct draft_part *part = &found->parts->parts[found->items[local / PART_TRIANGLES].part];
    const uint8_t *corners = found->parts->corners + part->first_corner + local % PART_TRIANGLES;
    uint32_t vertices[3], of_picture[3];
    for (int i = 0; i < 3; i++) {
        vertices[i] = found->parts->vertices[part->first_vertex + corners[i * part->rounded]];
        of_picture[i] = mesh->first_vertex + vertices[i];
    }
    spot->id = id;
    spot->number = recolor_triangle(band, of_picture);
    draft_weights(mesh, vertices, spot->weights);
}

static uint32_t weights_at(const struct spot *spot, double x, double y)
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
    if (out[0] + out[1] > 65535) /* by rounding */
        out[1] = 65535 - out[0];
    return out[0] | out[1] << 16;
}

static void keep_band(const struct keeping *keeping, int number)
{
    enum { SPOTS = 256 };
    const struct draft *draft = keeping->draft;
    struct recolor *recolor = keeping->recolor;
    struct recolor_band *band = &recolor->bands[number];
    struct spot spots[SPOTS]; /* by id: neighbours in a row, and the rows above, show the same triangles */
    for (int i = 0; i < SPOTS; i++)
        spots[i].id = UINT32_MAX;
    int end = (number + 1) * recolor->band_rows < recolor->height_px ? (number + 1) * recolor->band_rows : recolor->height_px;
    for (int y = number * recolor->band_rows; y < end; y++) {
        size_t from = (size_t)y * (size_t)draft->pitch_px, to = (size_t)y * (size_t)recolor->width_px;
        const uint32_t *out = (const uint32_t *)(const void *)(draft->out + (size_t)y * draft->out_stride_bytes);
        for (size_t x = 0; x < (size_t)recolor->width_px; x++) {
            uint32_t mark = draft->marks[from + x], id = draft->ids[from + x];
            if (!(mark & MARK_FIELD) || mark & MARK_CONTEXT) {
                recolor->surfaces[to + x] = RECOLOR_FIXED | (out[x] & 0xffffff);
                continue;
            }
            struct spot *spot = &spots[(id ^ id >> 8) % SPOTS];
            if (spot->id != id)
                find_spot(keeping, band, id, spot);
            recolor->surfaces[to + x] = spot->number;
            recolor->weights[to + x] = weights_at(spot, (double)x + 0.5, y + 0.5);
            recolor->rows[to + x] = (uint8_t)((mark & MARK_PLACE) / COLORMAP_COLUMNS);
        }
    }
}

static void keep_bands(void *arg, size_t begin, size_t end)
{
    for (size_t band = begin; band < end; band++)
        keep_band(arg, (int)band);
}

struct recolor *draft_keep(struct draft *draft)
{
    struct recolor *recolor = recolor_create(draft->width_px, draft->height_px, BAND_ROWS);
    if (!recolor)
        return NULL;
    for (size_t m = 0; m < draft->mesh_count; m++) {
        const struct draft_mesh *mesh = &draft->meshes[m];
        if (mesh->has_field)
            recolor_add_mesh(recolor, &(struct recolor_mesh){
                                          .asset = mesh->asset, .first_vertex = mesh->first_vertex, .vertex_count = mesh->vertex_count });
    }
    struct keeping keeping = { draft, recolor };
    workers_for(draft->workers, (size_t)recolor->band_count, 1, keep_bands, &keeping);
    return recolor;
}

void draft_keep_rim(const struct draft *draft, struct recolor *recolor)
{
    const uint8_t *rim = draft_rim(draft);
    for (int y = 0; y < draft->height_px; y++) {
        size_t from = (size_t)y * (size_t)draft->pitch_px, to = (size_t)y * (size_t)draft->width_px;
        for (size_t x = 0; x < (size_t)draft->width_px; x++)
            if (rim[from + x] && !draft->marks[from + x])
                recolor->ink[to + x] = rim[from + x] == RIM_DARK ? RECOLOR_RIM_DARK : RECOLOR_RIM_LIGHT;
    }
}

static void forget(void *recolor)
{
    recolor_destroy(&(struct recolor *){ recolor });
}

void draft_give(struct visibility_buffers *store, const struct frame_context *context, struct recolor *recolor, const struct frame *frame)
{
    recolor->markers = mem_array(frame->marker_count, sizeof(*recolor->markers));
    recolor->marker_count = frame->marker_count;
    if (frame->marker_count > 0)
        memcpy(recolor->markers, frame->markers, frame->marker_count * sizeof(*recolor->markers));
    visibility_buffers_give(store, context->shape, recolor, recolor_bytes(recolor), forget);
}

bool draft_recolor(struct draft *draft, struct visibility_buffers *store, const struct frame_context *context,
                   const struct isoline_points *points, struct frame *frame)
{
    struct recolor *recolor = visibility_buffers_find(store, context->shape);
    struct frame_uniforms block;
    if (!recolor || (context->colormap.lines && !recolor->lined))
        return false;
    frame_uniforms_fill(&block, context);
    draft_read_palette(draft, &context->colormap, context->view->look == LOOK_GLOSSY);
    recolor_read(recolor, context, draft->workers);
    recolor_draw(recolor, draft->colormap, &(struct recolor_lines){ block.lines[0], draft->lines }, block.scale[3], draft->workers, 0,
                 recolor->band_count, frame);
    if (context->colormap.lines)
        isolines_find(context, points, recolor->depth, (size_t)recolor->width_px, frame);
    frame->markers = mem_array(recolor->marker_count, sizeof(*frame->markers));
    frame->marker_count = recolor->marker_count;
    memcpy(frame->markers, recolor->markers, recolor->marker_count * sizeof(*recolor->markers));
    return true;
}
