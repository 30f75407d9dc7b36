/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One band of the picture: which triangle is nearest at each pixel, and its mark there.

   A pixel on an edge that two triangles share belongs to exactly one of them: both compute the edge from the same end in the same way,
   and one takes what is not negative, the other what is. */
#include <string.h>

#include "render/draft_impl.h"
#include "render/raster.h"

enum { AHEAD = 8, LOOK_AFTER = 384 }; /* triangles */
enum { TILE_PX = 32, MOST_TILES = VIEW_MAX_SIDE_PX / TILE_PX + 1 };

struct setup {
    float x, y; /* of the first corner: what planes start from */
    struct edge edges[3];
    struct plane depth, a, b, inverse_w;
    int left, right, top, bottom;
    uint32_t mark, flags;
    bool flat; /* no perspective to speak of */
    bool thin; /* so much so that rounding may lead out of what lies between its corners */
};

struct band {
    float *depth;
    uint32_t *marks;
    int pitch_px, top_px, bottom_px; /* last row included */
    int32_t last_row;                /* of the palette */
    float pattern_px;
    int tile_count, drawn;           /* triangles since the tiles were looked at */
    float farthest[MOST_TILES];      /* depth in each tile; what lies behind all of it is hidden */
    bool touched[MOST_TILES];
};

DRAFT_INLINE lanes least_of(lanes a, lanes b)
{
    return lanes_choose(a < b, a, b);
}

DRAFT_INLINE float farthest_in(const struct band *band, int tile)
{
    int rows = band->bottom_px - band->top_px + 1, left = tile * TILE_PX;
    int right = left + TILE_PX < band->pitch_px ? left + TILE_PX : band->pitch_px;
    lanes least = (lanes){ 0 } + 1.0f;
    float farthest = 1;
    for (int row = 0; row < rows; row++)
        for (int column = left; column < right; column += LANES)
            least = least_of(least, *(const lanes *)(band->depth + (size_t)row * (size_t)band->pitch_px + column));
    for (int i = 0; i < LANES; i++)
        farthest = least[i] < farthest ? least[i] : farthest;
    return farthest;
}

/* From time to time, where something was drawn. */
DRAFT_INLINE void look_at_tiles(struct band *band)
{
    if (++band->drawn < LOOK_AFTER)
        return;
    band->drawn = 0;
    for (int tile = 0; tile < band->tile_count; tile++)
        if (band->touched[tile]) {
            band->farthest[tile] = farthest_in(band, tile);
            band->touched[tile] = false;
        }
}

DRAFT_INLINE bool is_hidden(const struct band *band, int left, int right, float nearest)
{
    for (int tile = left / TILE_PX; tile <= right / TILE_PX; tile++)
        if (nearest >= band->farthest[tile])
            return false;
    return true;
}

/* False: none of its pixels lies in the band, or all are hidden. */
DRAFT_INLINE bool setup_init(struct setup *setup, struct band *band, int width_px, const struct draft_vertex *p,
                             const struct draft_vertex *q, const struct draft_vertex *r, uint32_t mark)
{
    const float little = 1.02f;
    float low = smallest(p->inverse_w, q->inverse_w, r->inverse_w), high = largest(p->inverse_w, q->inverse_w, r->inverse_w);
    setup->left = clip_low(smallest(p->x, q->x, r->x), 0);
    setup->right = clip_high(largest(p->x, q->x, r->x), width_px - 1);
    setup->top = clip_low(smallest(p->y, q->y, r->y), band->top_px);
    setup->bottom = clip_high(largest(p->y, q->y, r->y), band->bottom_px);
    if (setup->left > setup->right || setup->top > setup->bottom ||
        is_hidden(band, setup->left, setup->right, largest(p->depth, q->depth, r->depth)))
        return false;
    struct slopes slopes = { q->x - p->x, q->y - p->y, r->x - p->x, r->y - p->y };
    float area = slopes.x1 * slopes.y2 - slopes.x2 * slopes.y1, over = 1 / area;
    float longest = largest(slopes.x1 * slopes.x1 + slopes.y1 * slopes.y1, slopes.x2 * slopes.x2 + slopes.y2 * slopes.y2, 0);
    setup->thin = area * area < 1e-3f * longest;
    slopes = (struct slopes){ slopes.x1 * over, slopes.y1 * over, slopes.x2 * over, slopes.y2 * over };
    setup->x = p->x;
    setup->y = p->y;
    edge_init(&setup->edges[0], p, q);
    edge_init(&setup->edges[1], q, r);
    edge_init(&setup->edges[2], r, p);
    setup->depth = plane_of(&slopes, p->depth, q->depth, r->depth);
    setup->flat = high <= little * low;
    setup->mark = mark;
    setup->flags = p->flags | q->flags | r->flags;
    if (setup->flat) {
        setup->a = plane_of(&slopes, p->a, q->a, r->a);
        setup->b = plane_of(&slopes, p->b, q->b, r->b);
        setup->inverse_w = setup->depth; /* not looked at */
    } else {
        setup->a = plane_of(&slopes, p->a * p->inverse_w, q->a * q->inverse_w, r->a * r->inverse_w);
        setup->b = plane_of(&slopes, p->b * p->inverse_w, q->b * q->inverse_w, r->b * r->inverse_w);
        setup->inverse_w = plane_of(&slopes, p->inverse_w, q->inverse_w, r->inverse_w);
    }
    return true;
}

/* --- marks ------------------------------------------------------------------------------------------------------------------ */

DRAFT_INLINE lanes_int whole_within(lanes x, int32_t high)
{
    lanes_int whole = lanes_whole(x), highs = (lanes_int){ 0 } + high;
    whole = lanes_choose_int(whole > 0, whole, (lanes_int){ 0 });
    return lanes_choose_int(whole < highs, whole, highs);
}

DRAFT_INLINE lanes_int field_mark(lanes column, lanes row, int32_t last_row)
{
    return (whole_within(row, last_row) * PALETTE_COLUMNS + whole_within(column, PALETTE_PLACES + 1)) | (int32_t)MARK_FIELD;
}

DRAFT_INLINE lanes_int context_mark(lanes ambient, lanes sun, uint32_t mark)
{
    lanes_int a = lanes_whole(ambient + 0.5f), s = lanes_whole(sun + 0.5f);
    return a << 8 | s | (int32_t)mark;
}

/* Diagonal stripes, as hatch in shaders/field.glsl: -1 on the dark ones. */
DRAFT_INLINE lanes_int hatch(lanes x, float y, float pattern_px)
{
    lanes at = (x + y) * (1 / (pattern_px * 1.4142f));
    lanes phase = at - __builtin_convertvector(lanes_whole(at), lanes) - 0.5f;
    return (phase < -0.25f) | (phase > 0.25f);
}

/* Dots in rows, every second one moved by half, as stipple there. */
DRAFT_INLINE lanes_int stipple(lanes x, float y, float pattern_px)
{
    float row = y * (1 / pattern_px);
    float down = row - (float)(int)row - 0.5f, moved = (int)row % 2 ? 0.5f : 0;
    lanes cell = x * (1 / pattern_px) + moved;
    lanes across = cell - __builtin_convertvector(lanes_whole(cell), lanes) - 0.5f;
    return across * across + down * down < 0.26f * 0.26f;
}

/* Corners differ in their flags, or say that there is no data or that it is uncertain. */
DRAFT_INLINE lanes_int pattern_marks(lanes_int marks, lanes_int no_data, lanes_int uncertain, lanes row, lanes x, float y,
                                      const struct band *band)
{
    lanes_int r = whole_within(row, band->last_row) * PALETTE_COLUMNS + (int32_t)MARK_FIELD + PALETTE_PATTERNS;
    lanes_int dark = hatch(x, y, band->pattern_px), dots = stipple(x, y, band->pattern_px);
    marks = lanes_choose_int(uncertain & dots, r + PATTERN_STIPPLE, marks);
    return lanes_choose_int(no_data, lanes_choose_int(dark, r + PATTERN_HATCH_DARK, r + PATTERN_HATCH_LIGHT), marks);
}

/* --- pixels ----------------------------------------------------------------------------------------------------------------- */

struct flag_planes { /* of triangles with flags; 1 where set */
    struct plane no_data, uncertain;
};

/* Most triangles: of a field, with all flags alike, small and not thin. */
DRAFT_INLINE bool is_plain(const struct setup *setup)
{
    return setup->mark == MARK_FIELD && setup->flat && !setup->thin && !setup->flags;
}

DRAFT_INLINE lanes_int plain_marks_at(const struct setup *setup, const struct band *band, lanes from_x, float from_y)
{
    return field_mark(plane_at(&setup->a, from_x, from_y, false), plane_at(&setup->b, from_x, from_y, false), band->last_row);
}

DRAFT_INLINE lanes_int marks_at(const struct setup *setup, const struct flag_planes *flags, const struct band *band, lanes x, float y)
{
    lanes from_x = x - setup->x;
    float from_y = y - setup->y;
    lanes a = plane_at(&setup->a, from_x, from_y, setup->thin), b = plane_at(&setup->b, from_x, from_y, setup->thin), w = { 0 };
    if (!setup->flat) {
        w = 1.0f / plane_at(&setup->inverse_w, from_x, from_y, setup->thin);
        a *= w;
        b *= w;
    }
    if (setup->mark != MARK_FIELD)
        return context_mark(a, b, setup->mark);
    lanes_int marks = field_mark(a, b, band->last_row);
    if (!setup->flags)
        return marks;
    lanes none = plane_at(&flags->no_data, from_x, from_y, setup->thin), little = plane_at(&flags->uncertain, from_x, from_y, setup->thin);
    if (!setup->flat) {
        none *= w;
        little *= w;
    }
    return pattern_marks(marks, none > 0.5f, little > 0.5f, b, x, y, band);
}

/* Narrows the row to where edges let pixels be; one too many at each end. */
DRAFT_INLINE void narrow(const struct setup *setup, float y, int *left, int *right)
{
    for (int e = 0; e < 3; e++) {
        const struct edge *edge = &setup->edges[e];
        if (edge->dy < 1e-3f)
            continue;
        float x = edge->x + edge->dx * ((y - edge->y) / edge->dy);
        x = x < -2 ? -2 : x > 1e5f ? 1e5f : x;
        if (edge->negative && (int)x - 1 > *left)
            *left = (int)x - 1;
        if (!edge->negative && (int)x + 1 < *right)
            *right = (int)x + 1;
    }
}

/* plain: as is_plain says; a constant. */
DRAFT_INLINE void draw_triangle(const struct setup *setup, const struct flag_planes *flags, const struct band *band, bool plain)
{
    bool wide = setup->right - setup->left >= 2 * LANES, thin = !plain && setup->thin;
    int last = band->pitch_px - LANES;
    for (int row = setup->top; row <= setup->bottom; row++) {
        size_t start = (size_t)(row - band->top_px) * (size_t)band->pitch_px;
        float y = (float)row + 0.5f, from_y = y - setup->y, sides[3];
        int left = setup->left, right = setup->right;
        if (wide)
            narrow(setup, y, &left, &right);
        for (int e = 0; e < 3; e++)
            sides[e] = edge_row(&setup->edges[e], y);
        for (int column = left; column <= right; column += LANES) {
            column = column < last ? column : last; /* nothing is written beyond the row */
            lanes x = LANES_IOTA + ((float)column + 0.5f), from_x = x - setup->x;
            lanes_int side = edge_side(&setup->edges[0], sides[0], x) | edge_side(&setup->edges[1], sides[1], x) |
                             edge_side(&setup->edges[2], sides[2], x);
            lanes *depth = (lanes *)(band->depth + start + column);
            lanes here = plane_at(&setup->depth, from_x, from_y, thin);
            lanes_int seen = (side >= 0) & (here >= *depth);
            if (!lanes_any(seen))
                continue;
            lanes_int *marks = (lanes_int *)(band->marks + start + column);
            lanes_int mark = plain ? plain_marks_at(setup, band, from_x, from_y) : marks_at(setup, flags, band, x, y);
            *depth = lanes_choose(seen, here, *depth);
            *marks = lanes_choose_int(seen, mark, *marks);
        }
    }
}

DRAFT_INLINE void flag_planes_init(struct flag_planes *flags, const struct setup *setup, const struct draft_vertex *p,
                                   const struct draft_vertex *q, const struct draft_vertex *r)
{
    float area = (q->x - p->x) * (r->y - p->y) - (r->x - p->x) * (q->y - p->y);
    struct slopes slopes = { (q->x - p->x) / area, (q->y - p->y) / area, (r->x - p->x) / area, (r->y - p->y) / area };
    float w[3] = { setup->flat ? 1 : p->inverse_w, setup->flat ? 1 : q->inverse_w, setup->flat ? 1 : r->inverse_w };
#define FLAG(vertex, flag, i) ((vertex)->flags & (flag) ? w[i] : 0)
    flags->no_data = plane_of(&slopes, FLAG(p, DRAFT_NO_DATA, 0), FLAG(q, DRAFT_NO_DATA, 1), FLAG(r, DRAFT_NO_DATA, 2));
    flags->uncertain = plane_of(&slopes, FLAG(p, DRAFT_UNCERTAIN, 0), FLAG(q, DRAFT_UNCERTAIN, 1), FLAG(r, DRAFT_UNCERTAIN, 2));
#undef FLAG
}

DRAFT_INLINE const struct draft_vertex *vertex_of(const struct draft *draft, const struct draft_chunk *chunk, uint32_t v)
{
    return v & EXTRA_VERTEX ? &chunk->extra[v & ~EXTRA_VERTEX] : &draft->vertices[v];
}

/* Vertices lie all over memory. */
DRAFT_INLINE void fetch_ahead(const struct draft *draft, const struct draft_chunk *chunk, size_t triangle)
{
    for (int i = 0; i < 3; i++)
        __builtin_prefetch(vertex_of(draft, chunk, chunk->triangles[triangle].vertices[i]));
}

DRAFT_KERNEL void draft_raster_band(const struct draft *draft, int number)
{
    size_t start = (size_t)number * BAND_ROWS * (size_t)draft->pitch_px;
    int bottom = (number + 1) * BAND_ROWS - 1;
    struct band band = {
        .depth = draft->depth + start,
        .marks = draft->marks + start,
        .pitch_px = draft->pitch_px,
        .top_px = number * BAND_ROWS,
        .bottom_px = bottom < draft->height_px - 1 ? bottom : draft->height_px - 1,
        .last_row = (int32_t)draft->block.shade[2],
        .pattern_px = draft->block.scale[3],
        .tile_count = (draft->pitch_px + TILE_PX - 1) / TILE_PX,
    };
    struct flag_planes flags = { 0 };
    size_t pixels = (size_t)(band.bottom_px - band.top_px + 1) * (size_t)draft->pitch_px;
    memset(band.depth, 0, pixels * sizeof(*band.depth));
    memset(band.marks, 0, pixels * sizeof(*band.marks));
    for (size_t c = 0; c < draft->chunk_count; c++) {
        const struct draft_chunk *chunk = &draft->chunks[c];
        for (uint32_t i = chunk->starts[number]; i < chunk->starts[number + 1]; i++) {
            const struct draft_triangle *triangle = &chunk->triangles[chunk->sorted[i]];
            const struct draft_vertex *p = vertex_of(draft, chunk, triangle->vertices[0]);
            const struct draft_vertex *q = vertex_of(draft, chunk, triangle->vertices[1]);
            const struct draft_vertex *r = vertex_of(draft, chunk, triangle->vertices[2]);
            struct setup setup;
            if (i + AHEAD < chunk->starts[number + 1])
                fetch_ahead(draft, chunk, chunk->sorted[i + AHEAD]);
            if (!setup_init(&setup, &band, draft->width_px, p, q, r, triangle->mark))
                continue;
            if (setup.flags)
                flag_planes_init(&flags, &setup, p, q, r);
            if (is_plain(&setup))
                draw_triangle(&setup, &flags, &band, true);
            else
                draw_triangle(&setup, &flags, &band, false);
            for (int tile = setup.left / TILE_PX; tile <= setup.right / TILE_PX; tile++)
                band.touched[tile] = true;
            look_at_tiles(&band);
        }
    }
}
