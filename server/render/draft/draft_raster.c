/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The faces of a part into a tile: which is nearest at each pixel, and its mark there. Small ones are set up eight at a time.

   A pixel on an edge that two triangles share belongs to exactly one of them: both compute the edge from the same end in the same way,
   and one takes what is not negative, the other what is. */
#include "render/draft/draft_marks.h"
#include "render/draft/draft_tile.h"
#include "render/raster.h"

enum { SMALL_PX = 4 * LANES };

/* Which triangle a pixel shows, where that is asked for. */
DRAFT_INLINE void keep_id(const struct draft_tile *tile, const struct draft_face *face, size_t at, lanes_int seen)
{
    if (!tile->draft->ids)
        return;
    lanes_int *ids = (lanes_int *)(tile->draft->ids + at);
    *ids = lanes_choose_int(seen, (lanes_int){ 0 } + (int32_t)(tile->first_id + face->triangle), *ids);
}

/* --- any face --------------------------------------------------------------------------------------------------------------- */

struct setup {
    float x, y; /* of the first corner: what planes start from */
    struct edge edges[3];
    struct plane depth, a, b, inverse_w;
    struct plane no_data, uncertain, no_limits; /* where flags are set: as draft_lacking, draft_uncertain; 1 there */
    uint32_t mark, flags;
    bool flat; /* no perspective to speak of */
    bool thin; /* so much so that rounding may lead out of what lies between its corners */
};

DRAFT_INLINE struct draft_vertex vertex_of(const struct draft_corners *corners, int i)
{
    return (struct draft_vertex){ corners->x[i], corners->y[i], corners->depth[i], corners->inverse_w[i],
                                  corners->a[i], corners->b[i], corners->flags[i], 0 };
}

/* part: of each corner, 0..1. */
DRAFT_INLINE struct plane part_plane(const struct slopes *slopes, const struct draft_vertex v[3], const float part[3], bool flat)
{
    float at[3];
    for (int i = 0; i < 3; i++)
        at[i] = flat ? part[i] : part[i] * v[i].inverse_w;
    return plane_of(slopes, at[0], at[1], at[2]);
}

DRAFT_INLINE void setup_init(struct setup *setup, const struct draft_vertex v[3], uint32_t mark)
{
    const float little = 1.02f;
    float low = smallest(v[0].inverse_w, v[1].inverse_w, v[2].inverse_w), high = largest(v[0].inverse_w, v[1].inverse_w, v[2].inverse_w);
    struct slopes slopes = { v[1].x - v[0].x, v[1].y - v[0].y, v[2].x - v[0].x, v[2].y - v[0].y };
    float area = slopes.x1 * slopes.y2 - slopes.x2 * slopes.y1, over = 1 / area;
    float longest = largest(slopes.x1 * slopes.x1 + slopes.y1 * slopes.y1, slopes.x2 * slopes.x2 + slopes.y2 * slopes.y2, 0);
    setup->thin = area * area < 1e-3f * longest;
    slopes = (struct slopes){ slopes.x1 * over, slopes.y1 * over, slopes.x2 * over, slopes.y2 * over };
    setup->x = v[0].x;
    setup->y = v[0].y;
    for (int e = 0; e < 3; e++)
        edge_init(&setup->edges[e], &v[e], &v[(e + 1) % 3]);
    setup->depth = plane_of(&slopes, v[0].depth, v[1].depth, v[2].depth);
    setup->flat = high <= little * low;
    setup->mark = mark;
    setup->flags = (v[0].flags | v[1].flags | v[2].flags) & DRAFT_PATTERNS;
    if (setup->flat) {
        setup->a = plane_of(&slopes, v[0].a, v[1].a, v[2].a);
        setup->b = plane_of(&slopes, v[0].b, v[1].b, v[2].b);
        setup->inverse_w = setup->depth; /* not looked at */
    } else {
        setup->a = plane_of(&slopes, v[0].a * v[0].inverse_w, v[1].a * v[1].inverse_w, v[2].a * v[2].inverse_w);
        setup->b = plane_of(&slopes, v[0].b * v[0].inverse_w, v[1].b * v[1].inverse_w, v[2].b * v[2].inverse_w);
        setup->inverse_w = plane_of(&slopes, v[0].inverse_w, v[1].inverse_w, v[2].inverse_w);
    }
    setup->no_data = setup->uncertain = setup->no_limits = setup->depth; /* not looked at */
    if (setup->flags) {
        float lacking[3], uncertain[3], no_limits[3];
        for (int i = 0; i < 3; i++) {
            lacking[i] = draft_lacking(v[i].flags);
            uncertain[i] = draft_uncertain(v[i].flags);
            no_limits[i] = v[i].flags & DRAFT_NO_LIMITS ? 1 : 0;
        }
        setup->no_data = part_plane(&slopes, v, lacking, setup->flat);
        setup->uncertain = part_plane(&slopes, v, uncertain, setup->flat);
        setup->no_limits = part_plane(&slopes, v, no_limits, setup->flat);
    }
}

/* w: 1 over inverse_w there; looked at if there is perspective. */
DRAFT_INLINE lanes_int field_marks(const struct setup *setup, const struct ink *ink, lanes a, lanes b, lanes w)
{
    lanes none = { 0 }, x = none + setup->a.dx, y = none + setup->a.dy;
    if (!ink->rich)
        return field_mark(a, b, ink->last_row);
    if (!setup->flat) {
        x = (x - a * setup->inverse_w.dx) * w;
        y = (y - a * setup->inverse_w.dy) * w;
    }
    return rich_mark(a, x, y, b, ink);
}

DRAFT_INLINE lanes_int marks_at(const struct setup *setup, const struct ink *ink, lanes x, float y)
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
    lanes_int marks = field_marks(setup, ink, a, b, w);
    if (!setup->flags)
        return marks;
    lanes none = plane_at(&setup->no_data, from_x, from_y, setup->thin), little = plane_at(&setup->uncertain, from_x, from_y, setup->thin);
    lanes free = plane_at(&setup->no_limits, from_x, from_y, setup->thin);
    if (!setup->flat) {
        none *= w;
        little *= w;
        free *= w;
    }
    return pattern_marks(marks, none > 0.5f, little > 0.5f, (free > 0.5f) & -(int32_t)ink->rich, b, x, y, ink);
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

DRAFT_INLINE void draw_face(const struct draft_tile *tile, const struct draft_face *face, const struct setup *setup, const struct ink *ink)
{
    bool wide = face->right - face->left >= 2 * LANES;
    int last = tile->rect.right + 1 - LANES; /* beyond the tile another thread draws */
    for (int row = face->top; row <= face->bottom; row++) {
        size_t start = (size_t)row * (size_t)tile->draft->pitch_px;
        float y = (float)row + 0.5f, from_y = y - setup->y, sides[3];
        int left = face->left, right = face->right;
        if (wide)
            narrow(setup, y, &left, &right);
        for (int e = 0; e < 3; e++)
            sides[e] = edge_row(&setup->edges[e], y);
        for (int column = left; column <= right; column += LANES) {
            column = column < last ? column : last;
            lanes x = LANES_IOTA + ((float)column + 0.5f), from_x = x - setup->x;
            lanes_int side = edge_side(&setup->edges[0], sides[0], x) | edge_side(&setup->edges[1], sides[1], x) |
                             edge_side(&setup->edges[2], sides[2], x);
            lanes *depth = (lanes *)(tile->draft->depth + start + column);
            lanes here = plane_at(&setup->depth, from_x, from_y, setup->thin);
            lanes_int seen = (side >= 0) & (here >= *depth);
            if (!lanes_any(seen))
                continue;
            lanes_int *marks = (lanes_int *)(tile->draft->marks + start + column), mark = marks_at(setup, ink, x, y);
            *depth = lanes_choose(seen, here, *depth);
            *marks = lanes_choose_int(seen, mark, *marks);
            keep_id(tile, face, start + (size_t)column, seen);
        }
    }
}

/* --- small ones: flat, without flags, and a few blocks of lanes wide and high --------------------------------------------- */

struct small { /* eight of them: a row of lanes is one number of each */
    lanes x, y;
    lanes edge_y[3], edge_dx[3], edge_dy[3], edge_row[3]; /* as struct edge; edge_row: of dy x */
    lanes_int negative[3];
    lanes at[3], dx[3], dy[3], low[3], high[3]; /* planes of depth, a, b */
    lanes_int thin;
};

DRAFT_INLINE lanes corner_values(const float *table, const struct draft_face *const faces[LANES], int corner)
{
    lanes out;
    for (int l = 0; l < LANES; l++)
        out[l] = table[faces[l]->corners[corner]];
    return out;
}

DRAFT_INLINE void small_init(struct small *small, const struct draft_corners *corners, const struct draft_face *const faces[LANES])
{
    lanes x[3], y[3];
    for (int i = 0; i < 3; i++) {
        x[i] = corner_values(corners->x, faces, i);
        y[i] = corner_values(corners->y, faces, i);
    }
    for (int e = 0; e < 3; e++) {
        lanes px = x[e], py = y[e], qx = x[(e + 1) % 3], qy = y[(e + 1) % 3];
        lanes_int swap = (qy < py) | ((qy == py) & (qx < px));
        lanes upper_x = lanes_choose(swap, qx, px), upper_y = lanes_choose(swap, qy, py);
        small->edge_y[e] = upper_y;
        small->edge_dx[e] = lanes_choose(swap, px, qx) - upper_x;
        small->edge_dy[e] = lanes_choose(swap, py, qy) - upper_y;
        small->edge_row[e] = small->edge_dy[e] * upper_x;
        small->negative[e] = swap;
    }
    lanes x1 = x[1] - x[0], y1 = y[1] - y[0], x2 = x[2] - x[0], y2 = y[2] - y[0];
    lanes area = x1 * y2 - x2 * y1, over = 1.0f / area, one = x1 * x1 + y1 * y1, two = x2 * x2 + y2 * y2;
    small->thin = area * area < 1e-3f * lanes_choose(one > two, one, two);
    small->x = x[0];
    small->y = y[0];
    const float *tables[3] = { corners->depth, corners->a, corners->b };
    for (int p = 0; p < 3; p++) {
        lanes v0 = corner_values(tables[p], faces, 0), v1 = corner_values(tables[p], faces, 1), v2 = corner_values(tables[p], faces, 2);
        lanes d1 = v1 - v0, d2 = v2 - v0, low = lanes_choose(v1 < v0, v1, v0), high = lanes_choose(v1 > v0, v1, v0);
        small->at[p] = v0;
        small->low[p] = lanes_choose(v2 < low, v2, low);
        small->high[p] = lanes_choose(v2 > high, v2, high);
        small->dx[p] = (d1 * y2 - d2 * y1) * over;
        small->dy[p] = (d2 * x1 - d1 * x2) * over;
    }
}

struct small_row { /* where edges and planes are at its middle */
    float edges[3], starts[3];
};

DRAFT_INLINE struct small_row row_of(const struct small *small, int l, float y)
{
    struct small_row row;
    for (int i = 0; i < 3; i++) {
        row.edges[i] = small->edge_dx[i][l] * (y - small->edge_y[i][l]) + small->edge_row[i][l];
        row.starts[i] = small->at[i][l] + small->dy[i][l] * (y - small->y[l]);
    }
    return row;
}

/* A row of lanes. thin: a constant. */
DRAFT_INLINE void draw_lanes(const struct draft_tile *tile, const struct draft_face *face, const struct small *small, int l,
                             const struct small_row *row, size_t place, lanes x, uint32_t mark, const struct ink *ink, bool thin)
{
    lanes *depth = (lanes *)(tile->draft->depth + place), from_x = x - small->x[l];
    lanes_int side = ((lanes_int)(row->edges[0] - small->edge_dy[0][l] * x) ^ small->negative[0][l]) |
                     ((lanes_int)(row->edges[1] - small->edge_dy[1][l] * x) ^ small->negative[1][l]) |
                     ((lanes_int)(row->edges[2] - small->edge_dy[2][l] * x) ^ small->negative[2][l]);
#define VALUE(i) (thin ? lanes_clamp(row->starts[i] + small->dx[i][l] * from_x, small->low[i][l], small->high[i][l]) \
                       : row->starts[i] + small->dx[i][l] * from_x)
    lanes here = VALUE(0);
    lanes_int seen = (side >= 0) & (here >= *depth);
    if (!lanes_any(seen))
        return;
    lanes_int *marks = (lanes_int *)(tile->draft->marks + place);
    lanes a = VALUE(1), b = VALUE(2), none = { 0 };
#undef VALUE
    lanes_int new_marks;
    if (mark != MARK_FIELD)
        new_marks = context_mark(a, b, mark);
    else if (ink->rich)
        new_marks = rich_mark(a, none + small->dx[1][l], none + small->dy[1][l], b, ink);
    else
        new_marks = field_mark(a, b, ink->last_row);
    *marks = lanes_choose_int(seen, new_marks, *marks);
    *depth = lanes_choose(seen, here, *depth);
    keep_id(tile, face, place, seen);
}

DRAFT_INLINE void draw_small(const struct draft_tile *tile, const struct draft_face *face, const struct small *small, int l,
                             uint32_t mark, const struct ink *ink)
{
    int last = tile->rect.right + 1 - LANES; /* beyond the tile another thread draws */
    for (int y = face->top; y <= face->bottom; y++) {
        struct small_row row = row_of(small, l, (float)y + 0.5f);
        size_t start = (size_t)y * (size_t)tile->draft->pitch_px;
        for (int left = face->left; left <= face->right; left += LANES) {
            left = left < last ? left : last;
            lanes x = LANES_IOTA + ((float)left + 0.5f);
            if (small->thin[l])
                draw_lanes(tile, face, small, l, &row, start + (size_t)left, x, mark, ink, true);
            else
                draw_lanes(tile, face, small, l, &row, start + (size_t)left, x, mark, ink, false);
        }
    }
}

/* --- all -------------------------------------------------------------------------------------------------------------------- */

/* Low ones may be as wide as they like: there is little beside them. */
DRAFT_INLINE bool is_small(const struct draft_face *face)
{
    return face->bottom - face->top < SMALL_PX && (face->right - face->left < SMALL_PX || face->bottom - face->top < 2);
}

DRAFT_KERNEL static void draw_any(const struct draft_tile *tile, const struct draft_face *face, uint32_t mark, const struct ink *ink)
{
    struct draft_vertex v[3];
    struct setup setup;
    for (int i = 0; i < 3; i++)
        v[i] = vertex_of(&tile->corners, face->corners[i]);
    setup_init(&setup, v, mark);
    draw_face(tile, face, &setup, ink);
}

DRAFT_INLINE void draw_eight(const struct draft_tile *tile, const struct draft_face *const faces[LANES], int count, uint32_t mark,
                             const struct ink *ink)
{
    struct small small;
    small_init(&small, &tile->corners, faces);
    for (int l = 0; l < count; l++)
        draw_small(tile, faces[l], &small, l, mark, ink);
}

DRAFT_KERNEL void draft_raster_faces(const struct draft_tile *tile, uint32_t mark)
{
    struct ink ink = ink_of(tile->draft);
    bool may_be_small = tile->corners.flat && !tile->corners.all_flags;
    const struct draft_face *waiting[LANES];
    int count = 0;
    for (int i = 0; i < tile->face_count; i++) {
        const struct draft_face *face = &tile->faces[i];
        if (!may_be_small || !is_small(face)) {
            draw_any(tile, face, mark, &ink);
            continue;
        }
        waiting[count++] = face;
        if (count == LANES) {
            draw_eight(tile, waiting, LANES, mark, &ink);
            count = 0;
        }
    }
    for (int l = count; l < LANES && count > 0; l++)
        waiting[l] = waiting[0];
    if (count > 0)
        draw_eight(tile, waiting, count, mark, &ink);
}
