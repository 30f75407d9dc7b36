/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Clips the triangles of a part (up to 256 neighbouring triangles, parts.h) that may cross a clipping plane: the near plane,
   the guard band (a border around the frame) or a section plane. */
#include <math.h>

#include "render/soft/clip.h"
#include "render/soft/tile.h"

static uint32_t flags_of(const struct near_patterns *patterns)
{
    return (patterns->no_data > 0.5f ? SOFT_NO_DATA : 0) | (patterns->uncertain > 0.5f ? SOFT_UNCERTAIN : 0) |
           (patterns->no_limits > 0.5f ? SOFT_NO_LIMITS : 0);
}

static int add_corner(struct soft_corners *corners, const struct near_corner *corner)
{
    float inverse = 1 / fmaxf(corner->at[3], 1e-30f);
    int number = corners->count++;
    corners->x[number] = corner->at[0] * inverse;
    corners->y[number] = corner->at[1] * inverse;
    corners->depth[number] = corner->at[2] * inverse;
    corners->inverse_w[number] = inverse;
    corners->a[number] = corner->a;
    corners->b[number] = corner->b;
    corners->flags[number] = flags_of(&corner->patterns);
    corners->cut_patterns[number - corners->placed] = corner->patterns;
    return number;
}

static int cut(struct soft_tile *tile, const int numbers[3], int out[NEAR_CORNERS])
{
    struct soft_corners *corners = &tile->corners;
    const uint32_t *vertices = tile->parts->vertices + tile->part->first_vertex;
    struct near_corner at[3], left[NEAR_CORNERS];
    for (int i = 0; i < 3; i++) {
        int n = numbers[i];
        at[i] = near_corner_of(tile->mesh, vertices[n], corners->a[n], corners->b[n], corners->flags[n]);
    }
    int count = near_cut(tile->raster, tile->mesh->cut ? tile->cuts : 0, at, left);
    for (int i = 0; i < count; i++)
        out[i] = add_corner(corners, &left[i]);
    return count;
}

void soft_cut_corners(struct soft_tile *tile)
{
    struct soft_corners *corners = &tile->corners;
    for (int i = 0; i < tile->part->vertex_count; i++) {
        float at[4] = { corners->x[i], corners->y[i], corners->depth[i], 1 };
        if (corners->inverse_w[i] > 0 && raster_is_cut_off(tile->raster, at, tile->cuts))
            corners->inverse_w[i] = 0;
    }
    corners->cut = true;
}

static int first_pixel(float x, int low)
{
    return (int)fminf(fmaxf(x + 0.4999f, (float)low), 1e5f);
}

static int last_pixel(float x, int high)
{
    return (int)fminf(fmaxf(x + 0.5f, 0), (float)high + 1) - 1;
}

static void add_face(struct soft_tile *tile, int triangle, bool any_side, int i, int j, int k)
{
    const float *x = tile->corners.x, *y = tile->corners.y;
    float area = (x[j] - x[i]) * (y[k] - y[i]) - (x[k] - x[i]) * (y[j] - y[i]), reach = tile->reach_px;
    bool turned = area > 0, back = turned != tile->mesh->mirrored;
    int left = first_pixel(fminf(fminf(x[i], x[j]), x[k]) - reach, tile->rect.left);
    int right = last_pixel(fmaxf(fmaxf(x[i], x[j]), x[k]) + reach, tile->rect.right);
    int top = first_pixel(fminf(fminf(y[i], y[j]), y[k]) - reach, tile->rect.top);
    int bottom = last_pixel(fmaxf(fmaxf(y[i], y[j]), y[k]) + reach, tile->rect.bottom);
    if (area == 0 || (!any_side && back) || left > right || top > bottom)
        return;
    tile->faces[tile->face_count++] = (struct soft_face){
        { (uint16_t)i, (uint16_t)(turned ? j : k), (uint16_t)(turned ? k : j) },
        (uint16_t)(triangle | (tile->mesh->cut && back ? FACE_BACK : 0)),
        (int16_t)left,
        (int16_t)right,
        (int16_t)top,
        (int16_t)bottom,
    };
}

void soft_cut_faces(struct soft_tile *tile, bool both_sides)
{
    const struct soft_corners *corners = &tile->corners;
    const struct soft_part *part = tile->part;
    const uint8_t *of_part = tile->parts->corners + part->first_corner;
    bool any_side = both_sides || part->double_sided;
    tile->face_count = 0;
    for (int i = 0; i < part->triangle_count; i++) {
        int at[3] = { of_part[i], of_part[part->rounded + i], of_part[2 * part->rounded + i] }, out[NEAR_CORNERS];
        if (corners->inverse_w[at[0]] > 0 && corners->inverse_w[at[1]] > 0 && corners->inverse_w[at[2]] > 0) {
            add_face(tile, i, any_side, at[0], at[1], at[2]);
            continue;
        }
        int count = cut(tile, at, out);
        for (int c = 2; c < count; c++)
            add_face(tile, i, any_side, out[0], out[c - 1], out[c]);
    }
}
