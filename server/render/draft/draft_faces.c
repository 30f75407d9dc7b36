/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The vertices of a part into the picture, and those of its triangles that cover a pixel's middle there and look this way. */
#include "render/draft/draft_tile.h"

#define FARTHEST 1e6f /* columns: what lies so far outside the scale is outside all the same */

/* --- vertices --------------------------------------------------------------------------------------------------------------- */

/* What eight vertices are going to carry: on its way while they are placed and faces are found. */
DRAFT_INLINE void fetch_carried(const struct draft_mesh *mesh, const uint32_t vertices[LANES])
{
    for (int l = 0; l < LANES && mesh->scalars; l++)
        __builtin_prefetch(&mesh->scalars[vertices[l]]);
    for (int l = 0; l < LANES; l++)
        __builtin_prefetch(mesh->baked[vertices[l]]);
}

DRAFT_KERNEL void draft_place_part(struct draft_tile *tile, const struct draft_mesh *mesh, const struct draft_parts *parts,
                                   const struct draft_part *part)
{
    struct draft_corners *corners = &tile->corners;
    int rounded = (part->vertex_count + LANES - 1) / LANES * LANES;
    const float *places = draft_part_places(parts, part);
    const uint32_t *vertices = parts->vertices + part->first_vertex;
    lanes none = { 0 }, low = none + 1e30f, high = none;
    for (int i = 0; i < part->vertex_count; i += LANES) {
        fetch_carried(mesh, vertices + i);
        lanes x = *(const lanes *)(places + i), y = *(const lanes *)(places + rounded + i), z = *(const lanes *)(places + 2 * rounded + i);
        lanes at[4];
        for (int r = 0; r < 4; r++)
            at[r] = mesh->place[0][r] * x + mesh->place[1][r] * y + mesh->place[2][r] * z + mesh->place[3][r];
        lanes_int before = (at[3] > 0.0f) & (at[2] <= at[3]);
        lanes inverse = lanes_choose(before, 1.0f / lanes_choose(before, at[3], none + 1.0f), none);
        *(lanes *)(corners->x + i) = at[0] * inverse;
        *(lanes *)(corners->y + i) = at[1] * inverse;
        *(lanes *)(corners->depth + i) = at[2] * inverse;
        *(lanes *)(corners->inverse_w + i) = inverse;
        low = lanes_choose(inverse < low, inverse, low);
        high = lanes_choose(inverse > high, inverse, high);
    }
    float least = low[0], most = high[0];
    for (int l = 1; l < LANES; l++) {
        least = low[l] < least ? low[l] : least;
        most = high[l] > most ? high[l] : most;
    }
    corners->count = part->vertex_count;
    corners->cut = least == 0;
    corners->flat = most <= DRAFT_LITTLE * least;
}

/* As palette_column and palette_row in shaders/field.glsl. numbers: of those that carry, up to whole lanes. */
DRAFT_INLINE void carry_field(const struct draft *draft, const struct draft_mesh *mesh, const uint32_t *vertices, const uint8_t *numbers,
                              int count, struct draft_corners *corners)
{
    const float slack = 1e-5f, columns = PALETTE_PLACES / (1 + 2 * slack);
    bool log = draft->block.scale[2] > 0.5f;
    uint32_t all = 0;
    for (int i = 0; i < count; i += LANES) {
        lanes value;
        lanes_uint light;
        for (int l = 0; l < LANES; l++) {
            uint32_t number = numbers[i + l], vertex = vertices[number];
            const struct scalar *scalar = &mesh->scalars[vertex];
            uint32_t flags = draft_flags(scalar);
            value[l] = scalar->value;
            light[l] = mesh->baked[vertex][0];
            corners->flags[number] = flags;
            all |= flags;
        }
        lanes place = (value - draft->block.scale[0]) * draft->block.scale[1];
        lanes a = log ? value : lanes_clamp(place * columns + (1 + slack * columns), -FARTHEST, FARTHEST);
        lanes b = __builtin_convertvector((lanes_int)light, lanes) * (1 / 255.0f) * draft->block.shade[0] + draft->block.shade[1];
        for (int l = 0; l < LANES; l++) {
            corners->a[numbers[i + l]] = a[l];
            corners->b[numbers[i + l]] = b[l];
        }
    }
    corners->all_flags = all & DRAFT_PATTERNS;
}

DRAFT_INLINE void carry_nothing(const struct draft *draft, const struct draft_mesh *mesh, const uint32_t *vertices, const uint8_t *numbers,
                                int count, struct draft_corners *corners)
{
    for (int i = 0; i < count; i++) {
        int n = numbers[i];
        corners->a[n] = 0;
        corners->b[n] = (float)mesh->baked[vertices[n]][0] * (1 / 255.0f) * draft->block.shade[0] + draft->block.shade[1];
        corners->flags[n] = DRAFT_NOTHING_KNOWN;
    }
    corners->all_flags = DRAFT_NO_DATA;
}

DRAFT_INLINE void carry_context(const struct draft_mesh *mesh, const uint32_t *vertices, const uint8_t *numbers, int count,
                                struct draft_corners *corners)
{
    for (int i = 0; i < count; i++) {
        int n = numbers[i];
        corners->a[n] = mesh->baked[vertices[n]][1];
        corners->b[n] = mesh->baked[vertices[n]][3];
        corners->flags[n] = 0;
    }
    corners->all_flags = 0;
}

/* Up to whole lanes. */
static int list_all(const struct draft_part *part, uint8_t numbers[PART_VERTICES + LANES])
{
    for (int i = 0; i < PART_VERTICES + LANES; i++)
        numbers[i] = (uint8_t)(i < part->vertex_count ? i : part->vertex_count - 1);
    return part->vertex_count;
}

static int list_used(const struct draft_tile *tile, uint8_t numbers[PART_VERTICES + LANES])
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

DRAFT_KERNEL void draft_carry_part(struct draft_tile *tile, const struct draft_mesh *mesh, const struct draft_parts *parts,
                                   const struct draft_part *part)
{
    const uint32_t *vertices = parts->vertices + part->first_vertex;
    uint8_t numbers[PART_VERTICES + LANES];
    int count = tile->corners.cut ? list_all(part, numbers) : list_used(tile, numbers);
    if (mesh->scalars)
        carry_field(tile->draft, mesh, vertices, numbers, count, &tile->corners);
    else if (mesh->has_field)
        carry_nothing(tile->draft, mesh, vertices, numbers, count, &tile->corners);
    else
        carry_context(mesh, vertices, numbers, count, &tile->corners);
}

/* --- faces ------------------------------------------------------------------------------------------------------------------ */

DRAFT_INLINE lanes look_up(const float *table, const uint8_t *at)
{
    lanes out;
    for (int l = 0; l < LANES; l++)
        out[l] = table[at[l]];
    return out;
}

DRAFT_INLINE lanes least_of(lanes a, lanes b, lanes c)
{
    lanes least = lanes_choose(a < b, a, b);
    return lanes_choose(least < c, least, c);
}

DRAFT_INLINE lanes most_of(lanes a, lanes b, lanes c)
{
    lanes most = lanes_choose(a > b, a, b);
    return lanes_choose(most > c, most, c);
}

/* The first pixel whose middle may be covered, and the last one, kept to the tile. */
DRAFT_INLINE lanes_int first_pixel(lanes x, int low)
{
    return lanes_whole(lanes_clamp(x + 0.4999f, (float)low, 1e5f));
}

DRAFT_INLINE lanes_int last_pixel(lanes x, int high)
{
    return lanes_whole(lanes_clamp(x + 0.5f, 0, (float)high + 1)) - 1;
}

DRAFT_INLINE bool is_hidden(const struct draft_tile *tile, const struct draft_face *face)
{
    const float *depth = tile->corners.depth;
    float p = depth[face->corners[0]], q = depth[face->corners[1]], r = depth[face->corners[2]];
    float nearest = p > q ? p : q;
    nearest = nearest > r ? nearest : r;
    unsigned top = (unsigned)(face->top - tile->rect.top) / BLOCK_PX, bottom = (unsigned)(face->bottom - tile->rect.top) / BLOCK_PX;
    unsigned left = (unsigned)(face->left - tile->rect.left) / BLOCK_PX, right = (unsigned)(face->right - tile->rect.left) / BLOCK_PX;
    if (top == bottom && left == right)
        return nearest < tile->farthest[top][left];
    for (unsigned row = top; row <= bottom; row++)
        for (unsigned column = left; column <= right; column++)
            if (nearest >= tile->farthest[row][column])
                return false;
    return true;
}

/* Which of eight triangles may look this way: less than 0 is behind. Rounding does not lose one. */
DRAFT_INLINE lanes_int may_face(const float *planes, int rounded, const float eye_m[3])
{
    float slack_m = 1e-5f * (1 + __builtin_fabsf(eye_m[0]) + __builtin_fabsf(eye_m[1]) + __builtin_fabsf(eye_m[2]));
    lanes x = *(const lanes *)planes, y = *(const lanes *)(planes + rounded), z = *(const lanes *)(planes + 2 * rounded);
    return x * eye_m[0] + y * eye_m[1] + z * eye_m[2] + slack_m >= *(const lanes *)(planes + 3 * rounded);
}

DRAFT_KERNEL void draft_find_faces(struct draft_tile *tile, const struct draft_mesh *mesh, const struct draft_found *found,
                                   const struct draft_part *part)
{
    const struct draft_corners *corners = &tile->corners;
    const struct draft_parts *parts = found->parts;
    const float *planes = draft_part_planes(parts, part);
    bool both_sides = found->both_sides, one_side = !both_sides && !part->double_sided && !mesh->mirrored;
    const uint8_t *first = parts->corners + part->first_corner, *second = first + part->rounded, *third = second + part->rounded;
    lanes_int any_side = (lanes_int){ 0 } - (int)(both_sides || part->double_sided), mirrored = (lanes_int){ 0 } - (int)mesh->mirrored;
    tile->face_count = 0;
    for (int i = 0; i < part->triangle_count; i += LANES) {
        if (one_side && !lanes_any(may_face(planes + i, part->rounded, found->eye_m)))
            continue;
        lanes x0 = look_up(corners->x, first + i), x1 = look_up(corners->x, second + i), x2 = look_up(corners->x, third + i);
        lanes y0 = look_up(corners->y, first + i), y1 = look_up(corners->y, second + i), y2 = look_up(corners->y, third + i);
        lanes area = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0); /* rows go down: what faces us is negative */
        lanes_int turned = area > 0.0f;
        lanes_int left = first_pixel(least_of(x0, x1, x2), tile->rect.left), right = last_pixel(most_of(x0, x1, x2), tile->rect.right);
        lanes_int top = first_pixel(least_of(y0, y1, y2), tile->rect.top), bottom = last_pixel(most_of(y0, y1, y2), tile->rect.bottom);
        lanes_int kept = (area != 0.0f) & (any_side | ~(turned ^ mirrored)) & (left <= right) & (top <= bottom);
        for (uint32_t bits = lanes_bits(kept); bits; bits &= bits - 1) {
            int l = __builtin_ctz(bits);
            struct draft_face *face = &tile->faces[tile->face_count];
            uint8_t q = second[i + l], r = third[i + l];
            *face = (struct draft_face){ { first[i + l], turned[l] ? q : r, turned[l] ? r : q }, (uint16_t)(i + l),
                                         (int16_t)left[l], (int16_t)right[l], (int16_t)top[l], (int16_t)bottom[l] };
            tile->face_count += !is_hidden(tile, face);
        }
    }
}
