/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rasterizes the faces of a part (group of neighbouring triangles, parts.h) into a tile. Writes the nearest face's depth at
   each pixel and its mark (content of a pixel, soft_impl.h). Small faces are set up eight at a time. A pixel on an edge that
   two triangles share belongs to exactly one of the two. Both compute the edge function from the same end in the same way; one
   takes non-negative values, the other negative ones. */
#include "render/soft/kernels.h"
#include "render/soft/section_colors.h"
#include "render/soft/sixteen.h"

/* Stores the triangle's id at the pixels that show it (mask `seen`), if ids are wanted. */
SOFT_INLINE void keep_id(const struct soft_tile *tile, const struct soft_sample *sample, const struct soft_face *face, size_t at,
                         lanes_int seen)
{
    if (!sample->ids)
        return;
    lanes_int *ids = (lanes_int *)(sample->ids + at);
    *ids = lanes_choose_int(seen, (lanes_int){ 0 } + (int32_t)soft_id(tile, face), *ids);
}

/* --- any face --------------------------------------------------------------------------------------------------------------- */

struct setup {
    float x, y; /* position of the face's first corner in pixels; the linear functions below (struct plane) are relative to it */
    struct raster_edge edges[3];
    struct plane depth, a, b, inverse_w;
    /* strength at a pixel, 0..1, of the patterns that mark no data, uncertain values and missing limits, as a linear function
       of the position; set only if the face has flags */
    struct plane no_data, uncertain, no_limits;
    uint32_t mark, flags;
    bool flat; /* perspective is negligible */
    bool thin; /* true: the face is so thin that rounding errors may carry interpolated values beyond the values at its corners */
};

SOFT_INLINE struct soft_vertex vertex_of(const struct soft_corners *corners, int i)
{
    return (struct soft_vertex){ corners->x[i], corners->y[i], corners->depth[i], corners->inverse_w[i],
                                 corners->a[i], corners->b[i], corners->flags[i] };
}

/* Returns the linear function of the pixel position that has the value part[i] at corner i of the face. */
SOFT_INLINE struct plane part_plane(const struct slopes *slopes, const struct soft_vertex v[3], const float part[3], bool flat)
{
    float at[3];
    for (int i = 0; i < 3; i++)
        at[i] = flat ? part[i] : part[i] * v[i].inverse_w;
    return plane_of(slopes, at[0], at[1], at[2]);
}

SOFT_INLINE struct near_patterns patterns_of(const struct soft_corners *corners, int i)
{
    return i < corners->placed ? near_patterns_of(corners->flags[i]) : corners->cut_patterns[i - corners->placed];
}

SOFT_INLINE void setup_patterns(struct setup *setup, const struct slopes *slopes, const struct soft_vertex v[3],
                                const struct near_patterns at[3])
{
    setup->no_data = part_plane(slopes, v, (float[3]){ at[0].no_data, at[1].no_data, at[2].no_data }, setup->flat);
    setup->uncertain = part_plane(slopes, v, (float[3]){ at[0].uncertain, at[1].uncertain, at[2].uncertain }, setup->flat);
    setup->no_limits = part_plane(slopes, v, (float[3]){ at[0].no_limits, at[1].no_limits, at[2].no_limits }, setup->flat);
}

SOFT_INLINE void setup_init(struct setup *setup, const struct soft_vertex v[3], const struct near_patterns patterns[3], uint32_t mark)
{
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
    setup->flat = high <= SOFT_LITTLE * low;
    setup->mark = mark;
    setup->flags = (v[0].flags | v[1].flags | v[2].flags) & SOFT_PATTERNS;
    if (setup->flat) {
        setup->a = plane_of(&slopes, v[0].a, v[1].a, v[2].a);
        setup->b = plane_of(&slopes, v[0].b, v[1].b, v[2].b);
        setup->inverse_w = setup->depth; /* unused */
    } else {
        setup->a = plane_of(&slopes, v[0].a * v[0].inverse_w, v[1].a * v[1].inverse_w, v[2].a * v[2].inverse_w);
        setup->b = plane_of(&slopes, v[0].b * v[0].inverse_w, v[1].b * v[1].inverse_w, v[2].b * v[2].inverse_w);
        setup->inverse_w = plane_of(&slopes, v[0].inverse_w, v[1].inverse_w, v[2].inverse_w);
    }
    setup->no_data = setup->uncertain = setup->no_limits = setup->depth; /* unused */
    if (setup->flags)
        setup_patterns(setup, &slopes, v, patterns);
}

/* Returns the marks (colour codes, soft_impl.h) of eight pixels that show the field. a, b: column and row of the colour map. w:
   reciprocal of the interpolated inverse_w at the pixels; used only if the face needs perspective correction. */
SOFT_INLINE lanes_int field_marks(const struct setup *setup, const struct mark_ink *ink, lanes a, lanes b, lanes w)
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

SOFT_INLINE lanes_int marks_at(const struct setup *setup, const struct mark_ink *ink, lanes x, float y)
{
    lanes from_x = x - setup->x;
    float from_y = y - setup->y;
    if (setup->mark >= MARK_SECTION)
        return (lanes_int){ 0 } + (int32_t)setup->mark;
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
    struct eight_patterns patterns = { none > 0.5f, little > 0.5f, (free > 0.5f) & -(int32_t)ink->rich };
    return pattern_marks(marks, &patterns, b, x, y, ink);
}

/* Narrows the range left..right of columns in a row of pixels to those inside the face, plus one column at each end. */
SOFT_INLINE void narrow(const struct setup *setup, float y, int *left, int *right)
{
    for (int e = 0; e < 3; e++) {
        const struct raster_edge *edge = &setup->edges[e];
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

/* Removes pixels from the mask `seen` where the face's texture has a hole. Returns the new mask. */
SOFT_INLINE lanes_int leave_out_holes(const struct soft_cutout *cutout, lanes x, float y, lanes_int seen)
{
    for (uint32_t bits = lanes_bits(seen); bits; bits &= bits - 1) {
        int i = __builtin_ctz(bits);
        seen[i] = soft_is_hole(cutout, x[i], y) ? 0 : -1;
    }
    return seen;
}

/* Draws one face in stamps (blocks of eight pixels that are drawn together). cutout: alpha mask of the face; NULL: the face has no
   holes. */
SOFT_INLINE void draw_face(const struct soft_tile *tile, const struct soft_sample *sample, const struct soft_face *face,
                           const struct setup *setup, const struct soft_cutout *cutout, const struct mark_ink *ink)
{
    bool wide = face->right - face->left >= 2 * LANES;
    /* last column at which a stamp (block of pixels drawn as a unit) may begin: a later one would write pixels of another tile
       and thread */
    int last = tile->rect.right + 1 - LANES;
    for (int row = face->top; row <= face->bottom; row++) {
        size_t start = place_in(tile, tile->rect.left, row);
        float y = (float)row + 0.5f + sample->y, from_y = y - setup->y, sides[3];
        int left = face->left, right = face->right;
        if (wide)
            narrow(setup, y, &left, &right);
        for (int e = 0; e < 3; e++)
            sides[e] = edge_row(&setup->edges[e], y);
        for (int wanted = left; wanted <= right; wanted += LANES) {
            int column = wanted < last ? wanted : last;
            lanes x = LANES_IOTA + ((float)column + 0.5f + sample->x), from_x = x - setup->x;
            lanes_int side = edge_side(&setup->edges[0], sides[0], x) | edge_side(&setup->edges[1], sides[1], x) |
                             edge_side(&setup->edges[2], sides[2], x);
            size_t place = start + (size_t)(column - tile->rect.left);
            lanes *depth = (lanes *)(sample->depth + place);
            lanes here = plane_at(&setup->depth, from_x, from_y, setup->thin);
            lanes_int seen = (side >= 0) & (here >= *depth);
            if (cutout)
                seen = leave_out_holes(cutout, x, y, seen);
            if (!lanes_any(seen))
                continue;
            if (tile->draws == DRAW_BLENDED) {
                for (uint32_t bits = lanes_bits(seen) >> (wanted - column) << (wanted - column); bits; bits &= bits - 1) {
                    int i = __builtin_ctz(bits);
                    soft_add_fragment(tile, (int)(sample - tile->samples), face, column + i, row, here[i]);
                }
                continue;
            }
            if (sample->marks) {
                lanes_int *marks = (lanes_int *)(sample->marks + place), mark = marks_at(setup, ink, x, y);
                *marks = lanes_choose_int(seen, mark, *marks);
            }
            *depth = lanes_choose(seen, here, *depth);
            keep_id(tile, sample, face, place, seen);
        }
    }
}

/* --- small ones ------------------------------------------------------------------------------------------------------------- */

/* Draws a face of at most 4 x 2 pixels in one stamp (a block of eight pixels that is drawn as a unit). */
SOFT_INLINE void draw_by_one(const struct small_pen *pen, const struct soft_face *face, int l, int top)
{
    int last_left = pen->tile->rect.right + 1 - LANES / 2, last_top = pen->tile->rect.bottom - 1;
    int left = face->left < last_left ? face->left : last_left;
    draw_stamp(pen, face, l, left, top < last_top ? top : last_top, true, true);
}

/* Draws up to eight faces grouped by size class, so that the CPU predicts branches well. The order must be the same on every
   machine: of two faces at equal depth, the one drawn last is visible. */
SOFT_INLINE void draw_kinds(const struct small_pen *pen, const struct soft_face *const faces[LANES], const struct kinds *kinds,
                            uint32_t rows)
{
    for (uint32_t bits = kinds->one; bits; bits &= bits - 1)
        draw_by_one(pen, faces[__builtin_ctz(bits)], __builtin_ctz(bits), faces[__builtin_ctz(bits)]->top);
    if (can_draw_sixteen(pen->tile, pen->ink)) {
        draw_sixteen(pen, faces, kinds, rows);
        return;
    }
    for (uint32_t bits = kinds->four; bits; bits &= bits - 1)
        for (int half = 0; half < 4; half += 2)
            draw_by_one(pen, faces[__builtin_ctz(bits)], __builtin_ctz(bits), faces[__builtin_ctz(bits)]->top + half);
    for (uint32_t bits = kinds->two; bits; bits &= bits - 1)
        draw_small(pen, faces[__builtin_ctz(bits)], __builtin_ctz(bits), true);
    uint32_t row[] = { kinds->low, rows };
    for (int i = 0; i < 2; i++)
        for (uint32_t bits = row[i]; bits; bits &= bits - 1)
            draw_small(pen, faces[__builtin_ctz(bits)], __builtin_ctz(bits), false);
}

SOFT_INLINE void draw_eight(const struct soft_tile *tile, const struct soft_face *const faces[LANES], int count, uint32_t mark,
                            const struct mark_ink *ink)
{
    struct small small;
    struct eight_faces eight = read_faces(faces);
    struct kinds kinds = kinds_of(tile, &eight, count);
    uint32_t rows = ((1u << count) - 1) & ~(kinds.one | kinds.four | kinds.two | kinds.low);
    small_init(&small, &tile->corners, eight.corners, tile->samples[0].marks != NULL);
    for (int s = 0; s < tile->sample_count; s++) {
        struct small_pen pen = { .tile = tile, .sample = &tile->samples[s], .small = &small, .ink = ink, .mark = mark };
        draw_kinds(&pen, faces, &kinds, rows);
    }
}

/* --- all -------------------------------------------------------------------------------------------------------------------- */

static void draw_any(const struct soft_tile *tile, const struct soft_face *face, uint32_t mark, const struct mark_ink *ink)
{
    struct soft_vertex v[3];
    struct near_patterns patterns[3];
    struct setup setup;
    struct soft_cutout cutout;
    bool has_holes = tile->material->cut_out;
    for (int i = 0; i < 3; i++) {
        v[i] = vertex_of(&tile->corners, face->corners[i]);
        patterns[i] = patterns_of(&tile->corners, face->corners[i]);
    }
    setup_init(&setup, v, patterns, mark);
    if (has_holes)
        soft_cutout_init(&cutout, tile, face);
    for (int s = 0; s < tile->sample_count; s++)
        draw_face(tile, &tile->samples[s], face, &setup, has_holes ? &cutout : NULL, ink);
}

/* Returns the mark (content of a pixel) of the inner side of a mesh that a section plane cuts. */
static uint32_t mark_of_back(const struct soft_tile *tile, const struct soft_face *face)
{
    const float *planes = soft_part_planes(tile->parts, tile->part) + (face->triangle & FACE_TRIANGLE), *turn = tile->mesh->turn;
    const float x = planes[0], y = planes[tile->part->rounded], z = planes[2 * tile->part->rounded];
    return inside_mark((float[3]){ turn[0] * x + turn[3] * y + turn[6] * z, turn[1] * x + turn[4] * y + turn[7] * z,
                                   turn[2] * x + turn[5] * y + turn[8] * z });
}

void soft_raster_faces(const struct soft_tile *tile, uint32_t mark)
{
    struct mark_ink ink = ink_of(tile->raster);
    bool one_by_one = tile->material->cut_out || tile->draws == DRAW_BLENDED;
    const struct soft_face *waiting[LANES];
    int count = 0;
    for (int i = 0; i < tile->face_count; i++) {
        const struct soft_face *face = &tile->faces[i];
        if (face->triangle & FACE_BACK) {
            draw_any(tile, face, mark_of_back(tile, face), &ink);
            continue;
        }
        if (one_by_one || !is_small(face) || !is_plain(&tile->corners, face)) {
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

/* --- bodies ----------------------------------------------------------------------------------------------------------------- */

static void count_face(const struct soft_tile *tile, const struct soft_face *face)
{
    struct raster_edge edges[3];
    struct soft_vertex v[3];
    int32_t by = face->triangle & FACE_BACK ? 1 : -1;
    for (int i = 0; i < 3; i++)
        v[i] = vertex_of(&tile->corners, face->corners[i]);
    for (int e = 0; e < 3; e++)
        edge_init(&edges[e], &v[e], &v[(e + 1) % 3]);
    for (int row = face->top; row <= face->bottom; row++) {
        uint32_t *counts = tile->raster->marks + (size_t)row * (size_t)tile->raster->pitch_px;
        float sides[3];
        for (int e = 0; e < 3; e++)
            sides[e] = edge_row(&edges[e], (float)row + 0.5f);
        /* processes blocks of LANES pixels that begin at multiples of LANES: blocks do not overlap, so no pixel is counted
           twice */
        for (int column = face->left / LANES * LANES; column <= face->right; column += LANES) {
            lanes x = LANES_IOTA + ((float)column + 0.5f);
            lanes_int side = edge_side(&edges[0], sides[0], x) | edge_side(&edges[1], sides[1], x) | edge_side(&edges[2], sides[2], x);
            *(lanes_int *)(counts + column) += (side >= 0) & by;
        }
    }
}

void soft_count_faces(const struct soft_tile *tile)
{
    for (int i = 0; i < tile->face_count; i++)
        count_face(tile, &tile->faces[i]);
}
