/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Projects the vertices of a part (group of neighbouring triangles, parts.h) and lists its front-facing triangles that cover a pixel
   centre. */
#include <string.h>

#include "render/soft/kernels.h"

/* columns of the colour map are clamped to plus or minus this value; only field values far outside the scale get there */
#define FARTHEST 1e6f

/* --- vertices --------------------------------------------------------------------------------------------------------------- */

/* Prefetches the field values and light of eight vertices into the CPU cache; carry_part() needs the data later. */
SOFT_INLINE void fetch_carried(const struct soft_mesh *mesh, const uint32_t vertices[LANES])
{
    for (int l = 0; l < LANES && mesh->scalars && mesh->pixels < 0; l++)
        __builtin_prefetch(&mesh->scalars[vertices[l]]);
    for (int l = 0; l < LANES; l++)
        __builtin_prefetch(mesh->baked[vertices[l]]);
}

void soft_place_part(struct soft_tile *tile, const struct soft_mesh *mesh, const struct soft_parts *parts, const struct soft_part *part)
{
    struct soft_corners *corners = &tile->corners;
    int rounded = (part->vertex_count + LANES - 1) / LANES * LANES;
    const float *places = soft_part_places(parts, part);
    const uint32_t *vertices = parts->vertices + part->first_vertex;
    lanes none = { 0 }, low = none + 1e30f, high = none;
    float width = (float)tile->raster->width_px, height = (float)tile->raster->height_px;
    for (int i = 0; i < part->vertex_count; i += LANES) {
        fetch_carried(mesh, vertices + i);
        lanes x = *(const lanes *)(places + i), y = *(const lanes *)(places + rounded + i), z = *(const lanes *)(places + 2 * rounded + i);
        lanes at[4];
        for (int r = 0; r < 4; r++)
            at[r] = mesh->place[0][r] * x + mesh->place[1][r] * y + mesh->place[2][r] * z + mesh->place[3][r];
        lanes right = at[3] * (2 * width), below = at[3] * (2 * height), left = at[3] * -width, above = at[3] * -height;
        lanes_int before = (at[3] > 0.0f) & (at[2] <= at[3]);
        before &= (at[0] >= left) & (at[0] <= right) & (at[1] >= above) & (at[1] <= below);
        lanes inverse = lanes_choose(before, 1.0f / lanes_choose(before, at[3], none + 1.0f), none);
        *(lanes *)(corners->x + i) = at[0] * inverse;
        *(lanes *)(corners->y + i) = at[1] * inverse;
        *(lanes *)(corners->depth + i) = at[2] * inverse;
        *(lanes *)(corners->inverse_w + i) = inverse;
        low = lanes_least(inverse, low);
        high = lanes_most(inverse, high);
    }
    float least = low[0], most = high[0];
    for (int l = 1; l < LANES; l++) {
        least = low[l] < least ? low[l] : least;
        most = high[l] > most ? high[l] : most;
    }
    corners->count = corners->placed = part->vertex_count;
    corners->cut = least == 0;
    corners->flat = most <= SOFT_LITTLE * least;
}

/* Computes a and b (struct soft_vertex) of vertices with a field: column and row of the colour map, like colormap_column() and
   colormap_row() in shaders/field.glsl. numbers: indices of the vertices, padded to a multiple of LANES. */
SOFT_INLINE void carry_field(const struct raster *raster, const struct soft_mesh *mesh, const uint32_t *vertices, const uint8_t *numbers,
                             int count, struct soft_corners *corners)
{
    const float slack = 1e-5f, columns = COLORMAP_PLACES / (1 + 2 * slack);
    bool log = raster->block.scale[2] > 0.5f;
    uint32_t all = 0;
    for (int i = 0; i < count; i += LANES) {
        lanes value;
        lanes_uint light;
        for (int l = 0; l < LANES; l++) {
            uint32_t number = numbers[i + l], vertex = vertices[number];
            const struct scalar *scalar = &mesh->scalars[vertex];
            uint32_t flags = soft_flags(scalar);
            value[l] = scalar->value;
            light[l] = mesh->baked[vertex][0];
            corners->flags[number] = flags;
            all |= flags;
        }
        lanes place = (value - raster->block.scale[0]) * raster->block.scale[1];
        lanes a = log ? value : lanes_clamp(place * columns + (1 + slack * columns), -FARTHEST, FARTHEST);
        lanes b = __builtin_convertvector((lanes_int)light, lanes) * (1 / 255.0f) * raster->block.shade[0] + raster->block.shade[1];
        for (int l = 0; l < LANES; l++) {
            corners->a[numbers[i + l]] = a[l];
            corners->b[numbers[i + l]] = b[l];
        }
    }
    corners->all_flags = all & SOFT_PATTERNS;
}

SOFT_INLINE void carry_nothing(const struct raster *raster, const struct soft_mesh *mesh, const uint32_t *vertices, const uint8_t *numbers,
                               int count, struct soft_corners *corners)
{
    for (int i = 0; i < count; i++) {
        int n = numbers[i];
        corners->a[n] = 0;
        corners->b[n] = (float)mesh->baked[vertices[n]][0] * (1 / 255.0f) * raster->block.shade[0] + raster->block.shade[1];
        corners->flags[n] = SOFT_NOTHING_KNOWN;
    }
    corners->all_flags = SOFT_NO_DATA;
}

/* Sets a and b (struct soft_vertex) of vertices whose field is evaluated at pixels, so that pixels of their triangles get a MARK_PIXELS
   mark (soft_impl.h). a: bits 0 to 7 of the field's index in raster->pixels; b: row of the colour map, plus raster->row_bias. */
SOFT_INLINE void carry_pixels(const struct raster *raster, const struct soft_mesh *mesh, const uint32_t *vertices, const uint8_t *numbers,
                              int count, struct soft_corners *corners)
{
    const float bias = (float)raster->row_bias - 0.5f, most = 254.4f;
    for (int i = 0; i < count; i++) {
        int n = numbers[i];
        float row = (float)mesh->baked[vertices[n]][0] * (1 / 255.0f) * raster->block.shade[0] + raster->block.shade[1] + bias;
        corners->a[n] = (float)(mesh->pixels & 0xff);
        corners->b[n] = row < most ? row : most;
        corners->flags[n] = 0;
    }
    corners->all_flags = 0;
}

SOFT_INLINE void carry_context(const struct soft_mesh *mesh, const uint32_t *vertices, const uint8_t *numbers, int count,
                               struct soft_corners *corners)
{
    for (int i = 0; i < count; i++) {
        int n = numbers[i];
        corners->a[n] = mesh->baked[vertices[n]][1];
        corners->b[n] = mesh->baked[vertices[n]][3];
        corners->flags[n] = 0;
    }
    corners->all_flags = 0;
}

/* Fills `numbers` with the indices of all vertices of the part, padded to a multiple of LANES. Returns the padded length. */
static int list_all(const struct soft_part *part, uint8_t numbers[PART_VERTICES + LANES])
{
    for (int i = 0; i < PART_VERTICES + LANES; i++)
        numbers[i] = (uint8_t)(i < part->vertex_count ? i : part->vertex_count - 1);
    return part->vertex_count;
}

static int list_used(const struct soft_tile *tile, uint8_t numbers[PART_VERTICES + LANES])
{
    uint8_t used[PART_VERTICES] = { 0 };
    int count = 0;
    for (int i = 0; i < tile->face_count; i++)
        for (int c = 0; c < 3; c++) {
            uint16_t number = tile->faces[i].corners[c];
            numbers[count] = (uint8_t)number;
            count += !used[number];
            used[number] = 1;
        }
    for (int l = 0; l < LANES && count > 0; l++)
        numbers[count + l] = numbers[count - 1];
    return count;
}

void soft_carry_part(struct soft_tile *tile, const struct soft_mesh *mesh, const struct soft_parts *parts, const struct soft_part *part)
{
    const uint32_t *vertices = parts->vertices + part->first_vertex;
    uint8_t numbers[PART_VERTICES + LANES];
    int count = tile->corners.cut ? list_all(part, numbers) : list_used(tile, numbers);
    if (mesh->pixels >= 0)
        carry_pixels(tile->raster, mesh, vertices, numbers, count, &tile->corners);
    else if (mesh->scalars)
        carry_field(tile->raster, mesh, vertices, numbers, count, &tile->corners);
    else if (mesh->has_field)
        carry_nothing(tile->raster, mesh, vertices, numbers, count, &tile->corners);
    else
        carry_context(mesh, vertices, numbers, count, &tile->corners);
}

/* --- faces ------------------------------------------------------------------------------------------------------------------ */

SOFT_INLINE lanes least_of(lanes a, lanes b, lanes c)
{
    return lanes_least(lanes_least(a, b), c);
}

SOFT_INLINE lanes most_of(lanes a, lanes b, lanes c)
{
    return lanes_most(lanes_most(a, b), c);
}

/* first_pixel() returns the first pixel whose centre is at or after x; last_pixel() the last one whose centre is at or before
   x. Both are clamped to the tile. Rows use these functions in the same way, with y. */
SOFT_INLINE lanes_int first_pixel(lanes x, int low)
{
    return lanes_whole(lanes_clamp(x + 0.4999f, (float)low, 1e5f));
}

SOFT_INLINE lanes_int last_pixel(lanes x, int high)
{
    return lanes_whole(lanes_clamp(x + 0.5f, 0, (float)high + 1)) - 1;
}

/* Returns whether surfaces drawn earlier hide the face: in every 8 x 8 pixel block that it touches, its nearest depth is behind
   the block's farthest. */
SOFT_INLINE bool is_hidden(const struct soft_tile *tile, const struct soft_face *face, float nearest)
{
    unsigned top = (unsigned)(face->top - tile->rect.top) / BLOCK_PX, bottom = (unsigned)(face->bottom - tile->rect.top) / BLOCK_PX;
    unsigned left = (unsigned)(face->left - tile->rect.left) / BLOCK_PX, right = (unsigned)(face->right - tile->rect.left) / BLOCK_PX;
    for (unsigned row = top; row <= bottom; row++)
        for (unsigned column = left; column <= right; column++)
            if (nearest >= tile->farthest[row][column])
                return false;
    return true;
}

struct eight { /* eight triangles */
    lanes_int corners[3];
    lanes_int left, right, top, bottom;
    /* Masks of triangles, -1 for true. kept: the triangle will be drawn. doubtful: it is hidden in the depth blocks (8 x 8
       pixels) at the four corners of its bounding rectangle, but the rectangle has more blocks, which are not tested yet. */
    lanes_int kept, doubtful;
    lanes nearest;
};

/* Drops triangles that nearer surfaces hide in all depth blocks (8 x 8 pixels) of their bounding rectangle. Tests only the blocks at the
   four corners of the rectangle; if it has more blocks, marks the triangle as doubtful instead. */
SOFT_INLINE void hide(const struct soft_tile *tile, struct eight *eight)
{
    const float *farthest = &tile->farthest[0][0], *depth = tile->corners.depth;
    lanes_int top = (eight->top - tile->rect.top) & eight->kept, bottom = (eight->bottom - tile->rect.top) & eight->kept;
    lanes_int left = (eight->left - tile->rect.left) & eight->kept, right = (eight->right - tile->rect.left) & eight->kept;
    top = (top >> BLOCK_SHIFT) * BLOCK_COLUMNS; /* not negative */
    bottom = (bottom >> BLOCK_SHIFT) * BLOCK_COLUMNS;
    left >>= BLOCK_SHIFT;
    right >>= BLOCK_SHIFT;
    lanes far = lanes_least(lanes_least(lanes_look_up(farthest, top + left), lanes_look_up(farthest, top + right)),
                            lanes_least(lanes_look_up(farthest, bottom + left), lanes_look_up(farthest, bottom + right)));
    eight->nearest =
        most_of(lanes_look_up(depth, eight->corners[0]), lanes_look_up(depth, eight->corners[1]), lanes_look_up(depth, eight->corners[2]));
    lanes_int hidden = eight->nearest < far, wide = (bottom - top > BLOCK_COLUMNS) | (right - left > 1);
    eight->kept &= ~hidden | wide;
    eight->doubtful = hidden & wide;
}

/* Returns a mask of eight triangles: set for those that may face the eye, because eye_m is on the outer side of their plane. A
   tolerance prevents rounding errors from dropping a front face. */
SOFT_INLINE lanes_int may_face(const float *planes, int rounded, const float eye_m[3])
{
    float slack_m = 1e-5f * (1 + __builtin_fabsf(eye_m[0]) + __builtin_fabsf(eye_m[1]) + __builtin_fabsf(eye_m[2]));
    lanes x = *(const lanes *)planes, y = *(const lanes *)(planes + rounded), z = *(const lanes *)(planes + 2 * rounded);
    return x * eye_m[0] + y * eye_m[1] + z * eye_m[2] + slack_m >= *(const lanes *)(planes + 3 * rounded);
}

/* Appends the triangles marked in eight->kept to the tile's list of faces. first: index, within the part, of the first of the
   eight triangles. back: FACE_BACK for triangles that face away from the eye, else 0. */
SOFT_INLINE void keep_faces(struct soft_tile *tile, const struct eight *eight, int first, lanes_int back)
{
    /* eight elements of struct soft_face, transposed: 32-bit word i of face l is words[i][l] */
    uint32_t words[sizeof(struct soft_face) / sizeof(uint32_t)][LANES];
    float nearest[LANES];
    *(lanes_int *)words[0] = eight->corners[0] | eight->corners[1] << 16;
    *(lanes_int *)words[1] = eight->corners[2] | ((lanes_int){ 0, 1, 2, 3, 4, 5, 6, 7 } + first + back) << 16;
    *(lanes_int *)words[2] = eight->left | eight->right << 16;
    *(lanes_int *)words[3] = eight->top | eight->bottom << 16;
    *(lanes *)nearest = eight->nearest;
    uint32_t doubtful = lanes_bits(eight->doubtful);
    for (uint32_t bits = lanes_bits(eight->kept); bits; bits &= bits - 1) {
        int l = __builtin_ctz(bits);
        struct soft_face *face = &tile->faces[tile->face_count];
        uint32_t row[] = { words[0][l], words[1][l], words[2][l], words[3][l] };
        memcpy(face, row, sizeof(row));
        tile->face_count += !(doubtful >> l & 1) || !is_hidden(tile, face, nearest[l]);
    }
}

void soft_find_faces(struct soft_tile *tile, const struct soft_mesh *mesh, const struct soft_found *found, const struct soft_part *part)
{
    const struct soft_corners *corners = &tile->corners;
    const struct soft_parts *parts = found->parts;
    const float *planes = soft_part_planes(parts, part), reach = tile->reach_px;
    bool both_sides = found->both_sides, one_side = !both_sides && !part->double_sided && !mesh->mirrored;
    const uint8_t *first = parts->corners + part->first_corner, *second = first + part->rounded, *third = second + part->rounded;
    lanes_int any_side = (lanes_int){ 0 } - (int)(both_sides || part->double_sided), mirrored = (lanes_int){ 0 } - (int)mesh->mirrored;
    lanes_int back = (lanes_int){ 0 } + (mesh->cut ? FACE_BACK : 0);
    tile->face_count = 0;
    for (int i = 0; i < part->triangle_count; i += LANES) {
        if (one_side && !lanes_any(may_face(planes + i, part->rounded, found->eye_m)))
            continue;
        lanes_int p = lanes_from_bytes(first + i), q = lanes_from_bytes(second + i), r = lanes_from_bytes(third + i);
        lanes x0 = lanes_look_up(corners->x, p), x1 = lanes_look_up(corners->x, q), x2 = lanes_look_up(corners->x, r);
        lanes y0 = lanes_look_up(corners->y, p), y1 = lanes_look_up(corners->y, q), y2 = lanes_look_up(corners->y, r);
        lanes area = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0); /* y of the frame points down, so front faces have a negative area */
        lanes_int turned = area > 0.0f;
        struct eight eight = {
            .corners = { p, lanes_choose_int(turned, q, r), lanes_choose_int(turned, r, q) },
            .left = first_pixel(least_of(x0, x1, x2) - reach, tile->rect.left),
            .right = last_pixel(most_of(x0, x1, x2) + reach, tile->rect.right),
            .top = first_pixel(least_of(y0, y1, y2) - reach, tile->rect.top),
            .bottom = last_pixel(most_of(y0, y1, y2) + reach, tile->rect.bottom),
        };
        eight.kept = (area != 0.0f) & (any_side | ~(turned ^ mirrored)) & (eight.left <= eight.right) & (eight.top <= eight.bottom);
        if (!lanes_any(eight.kept))
            continue;
        hide(tile, &eight);
        keep_faces(tile, &eight, i, (turned ^ mirrored) & back);
    }
}

/* --- occlusion: farthest depth in each block of 8 x 8 pixels ------------------------------------------------------------ */

/* Returns the farthest depth in a block of 8 x 8 pixels. left, top: the block's position in the tile. */
SOFT_INLINE float farthest_in(const struct soft_tile *tile, int left, int top)
{
    int bottom = top + BLOCK_PX - 1 < tile->rect.bottom - tile->rect.top ? top + BLOCK_PX - 1 : tile->rect.bottom - tile->rect.top;
    lanes least = (lanes){ 0 } + 1.0f;
    for (int s = 0; s < tile->sample_count; s++)
        for (int row = top; row <= bottom; row++) {
            lanes here = *(const lanes *)(tile->samples[s].depth + (size_t)row * (size_t)tile->pitch_px + left);
            least = lanes_least(here, least);
        }
    float farthest = least[0];
    for (int i = 1; i < LANES; i++)
        farthest = least[i] < farthest ? least[i] : farthest;
    return farthest;
}

void soft_look_again(struct soft_tile *tile, const struct soft_rect *blocks)
{
    for (int row = blocks->top; row <= blocks->bottom; row++)
        for (int column = blocks->left; column <= blocks->right; column++)
            tile->farthest[row][column] = farthest_in(tile, column * BLOCK_PX, row * BLOCK_PX);
}
