/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Surface points, eight at a time: position, normal, and visibility of the sun. Private to soft/. */
#ifndef RENDER_SOFT_SURFACE_POINTS_H
#define RENDER_SOFT_SURFACE_POINTS_H
#include <math.h>
#include <string.h>

#include "render/soft/lookups.h"
#include "render/soft/refined_impl.h"
#include "render/soft/vectors.h"

struct eight_points {    /* eight surface points */
    lanes attributes[8]; /* NORMAL_X, ... of refined_impl.h */
    lanes material[8];
    lanes x, y, depth; /* position in the frame */
    lanes weights[3];
    lanes_int back;     /* -1: the surface's front faces away from the eye; else 0 */
    lanes_int mirrored; /* -1: the surface belongs to a mesh whose placement mirrors it, which reverses the winding; else 0 */
    lanes_int cut;      /* -1: a section plane cuts the mesh, so back faces show the inner side; else 0. Set together with the material */
    vec normal;
};

/* --- where ------------------------------------------------------------------------------------------------------------------- */

/* corners of the triangles of eight surface points, relative to the points; weigh() computes the corner weights from these */
struct corners {
    /* a, b: x and y of the vector from the point to the corner, in pixels. If a corner of the triangle cannot be projected,
       both are multiplied by the corner's clip-space w */
    float a[3][LANES], b[3][LANES];
    float w[3][LANES]; /* 1 / clip w of the corner; 1 if a corner of the triangle cannot be projected */
    /* for the interpolation of depth: g: 1 or, if a corner of the triangle cannot be projected, the corner's clip-space w; z:
       the corner's depth * g */
    float z[3][LANES], g[3][LANES];
};

/* Projects the corners of the triangle of an item (surface to shade) into element i of `out`, like soft_place_part() in
   faces.c. If a corner cannot be projected (it may lie behind the eye), homogeneous coordinates are stored. */
SOFT_INLINE void see_corners(const struct refined *refined, const struct refined_item *item, int i, struct corners *out)
{
    const struct raster *raster = &refined->raster;
    const struct soft_mesh *mesh = &raster->meshes[item->triangle.mesh];
    const quad *place = (const quad *)mesh->place;
    float width = (float)raster->width_px, height = (float)raster->height_px;
    quad at[3];
    bool placed = true;
    for (int k = 0; k < 3; k++) {
        const float *p = mesh->file->positions_m[item->triangle.vertices[k]];
        at[k] = place[0] * p[0] + place[1] * p[1] + place[2] * p[2] + place[3];
        float w = at[k][3];
        placed &= w > 0 && at[k][2] <= w && at[k][0] >= w * -width && at[k][0] <= w * (2 * width) && at[k][1] >= w * -height &&
                  at[k][1] <= w * (2 * height);
    }
    for (int k = 0; k < 3; k++) {
        float w = at[k][3], inverse = placed ? 1 / w : 1;
        out->a[k][i] = placed ? at[k][0] * inverse - item->x : at[k][0] - item->x * w;
        out->b[k][i] = placed ? at[k][1] * inverse - item->y : at[k][1] - item->y * w;
        out->w[k][i] = inverse;
        out->z[k][i] = at[k][2] * inverse;
        out->g[k][i] = placed ? 1 : w;
    }
}

SOFT_INLINE lanes load(const float at[LANES])
{
    return *(const lanes *)at;
}

/* Moves points that lie outside of their triangle to the nearest point on its rim. e: by corner: twice the area of the triangle between the
   point and the opposite edge; negative: the point lies outside that edge. Clamping weights at 0 instead would move a point far along a
   thin triangle. */
SOFT_INLINE void keep_within(const struct corners *corners, lanes e[3])
{
    lanes_int outside = (e[0] < 0.0f) | (e[1] < 0.0f) | (e[2] < 0.0f);
    outside &= (load(corners->g[0]) == 1.0f) & (load(corners->g[1]) == 1.0f) & (load(corners->g[2]) == 1.0f);
    lanes least = all(INFINITY), best[3] = { all(1), all(0), all(0) };
    for (int k = 0; k < 3 && lanes_any(outside); k++) {
        int p = (k + 1) % 3, q = (k + 2) % 3;
        lanes x = load(corners->a[p]), y = load(corners->b[p]), dx = load(corners->a[q]) - x, dy = load(corners->b[q]) - y;
        lanes part = lanes_clamp(-(x * dx + y * dy) / most_of(dx * dx + dy * dy, all(1e-20f)), 0, 1);
        x += part * dx;
        y += part * dy;
        lanes_int nearer = x * x + y * y < least;
        least = lanes_choose(nearer, x * x + y * y, least);
        best[k] = lanes_choose(nearer, all(0), best[k]);
        best[p] = lanes_choose(nearer, 1.0f - part, best[p]);
        best[q] = lanes_choose(nearer, part, best[q]);
    }
    for (int k = 0; k < 3; k++)
        e[k] = lanes_choose(outside, best[k], most_of(e[k], all(0)));
}

/* Computes the perspective-correct weights of the triangle's corners at each point, and clamps them to the triangle. Moves the
   point to the position given by the weights. */
SOFT_INLINE void weigh(struct eight_points *spot, const struct corners *corners)
{
    lanes e[3], sum, depth = all(0), over = all(0), x = all(0), y = all(0);
    for (int k = 0; k < 3; k++) {
        int p = (k + 1) % 3, q = (k + 2) % 3;
        e[k] = load(corners->a[p]) * load(corners->b[q]) - load(corners->a[q]) * load(corners->b[p]);
    }
    lanes sign = lanes_choose(e[0] + e[1] + e[2] < 0.0f, all(-1), all(1));
    spot->back = (e[0] * load(corners->g[0]) + e[1] * load(corners->g[1]) + e[2] * load(corners->g[2]) > 0.0f) ^ spot->mirrored;
    for (int k = 0; k < 3; k++)
        e[k] *= sign;
    keep_within(corners, e);
    for (int k = 0; k < 3; k++) {
        depth += e[k] * load(corners->z[k]);
        over += e[k] * load(corners->g[k]);
        x += e[k] * load(corners->a[k]);
        y += e[k] * load(corners->b[k]);
        spot->weights[k] = e[k] * load(corners->w[k]);
    }
    sum = spot->weights[0] + spot->weights[1] + spot->weights[2];
    lanes_int flat = ~((sum > 0.0f) & (over > 0.0f));
    sum = lanes_choose(flat, all(1), 1.0f / sum);
    for (int k = 0; k < 3; k++)
        spot->weights[k] = lanes_choose(flat, all(k == 0), spot->weights[k] * sum);
    over = lanes_choose(flat, all(1), 1.0f / over);
    spot->depth = lanes_choose(flat, load(corners->z[0]) / load(corners->g[0]), depth * over);
    spot->x += lanes_choose(flat, all(0), x * over);
    spot->y += lanes_choose(flat, all(0), y * over);
}

SOFT_INLINE void turn(float rows[LANES][8], lanes columns[8])
{
    for (int c = 0; c < 8; c++)
        for (int i = 0; i < LANES; i++)
            columns[c][i] = rows[i][c];
}

SOFT_INLINE quad quad_of_bytes(const uint8_t bytes[4])
{
    lanes_bytes eight = { bytes[0], bytes[1], bytes[2], bytes[3] };
    lanes all_of = __builtin_convertvector(eight, lanes);
    return __builtin_shufflevector(all_of, all_of, 0, 1, 2, 3);
}

/* Interpolates the vertex attributes NORMAL_X to TINT (refined_impl.h) at a point of the triangle. */
SOFT_INLINE void attributes_at(const struct refined *refined, const struct soft_triangle *triangle, const float weights[3], bool with_tint,
                               float out[8])
{
    const struct soft_mesh *mesh = &refined->raster.meshes[triangle->mesh];
    const float *turn = refined->normals[triangle->mesh];
    float n[3] = { 0, 0, 0 };
    quad baked = { 0, 0, 0, 0 }, tint = { 255, 255, 255, 255 };
    for (int k = 0; k < 3; k++) {
        const float *of_file = mesh->file->normals[triangle->vertices[k]];
        for (int r = 0; r < 3; r++)
            n[r] += of_file[r] * weights[k];
        baked += quad_of_bytes(mesh->baked[triangle->vertices[k]]) * weights[k];
    }
    if (with_tint && mesh->file->colors) {
        tint = (quad){ 0, 0, 0, 0 };
        for (int k = 0; k < 3; k++)
            tint += quad_of_bytes(mesh->file->colors[triangle->vertices[k]]) * weights[k];
    }
    for (int r = 0; r < 3; r++) {
        out[NORMAL_X + r] = turn[r] * n[0] + turn[3 + r] * n[1] + turn[6 + r] * n[2];
        out[TINT + r] = tint[r] * (1 / 255.0f);
    }
    out[AMBIENT] = baked[1] * (1 / 255.0f);
    out[OPEN] = baked[2] * (1 / 255.0f);
}

/* Computes the surface points (struct eight_points) of up to eight items (surfaces to shade); unused lanes repeat the last item. */
SOFT_INLINE void look(const struct refined *refined, const struct refined_item *items, size_t count, bool with_material,
                      struct eight_points *spot)
{
    struct corners corners;
    float rows[LANES][8], materials[LANES][8];
    for (int i = 0; i < LANES; i++) {
        const struct refined_item *item = &items[(size_t)i < count ? (size_t)i : count - 1];
        const struct soft_mesh *mesh = &refined->raster.meshes[item->triangle.mesh];
        see_corners(refined, item, i, &corners);
        spot->x[i] = item->x;
        spot->y[i] = item->y;
        spot->mirrored[i] = mesh->mirrored ? -1 : 0;
        if (with_material) {
            memcpy(materials[i], &refined->raster.soft->shading[item->triangle.material], sizeof(lanes));
            spot->cut[i] = mesh->cut ? -1 : 0;
        }
    }
    weigh(spot, &corners);
    for (int i = 0; i < LANES; i++) {
        const struct refined_item *item = &items[(size_t)i < count ? (size_t)i : count - 1];
        float weights[3] = { spot->weights[0][i], spot->weights[1][i], spot->weights[2][i] };
        attributes_at(refined, &item->triangle, weights, with_material, rows[i]);
    }
    turn(rows, spot->attributes);
    if (with_material)
        turn(materials, spot->material);
    spot->normal = unit((vec){ spot->attributes[NORMAL_X], spot->attributes[NORMAL_Y], spot->attributes[NORMAL_Z] });
}

SOFT_INLINE vec view_of(const struct refined *refined, const struct eight_points *spot)
{
    const float(*m)[3] = refined->raster.ray_from_pixel;
    lanes ray[3];
    for (int r = 0; r < 3; r++)
        ray[r] = -(spot->x * m[0][r] + spot->y * m[1][r] + m[2][r]);
    return unit((vec){ ray[0], ray[1], ray[2] });
}

/* Returns -1 for points whose normal must be reversed: two-sided surfaces seen from behind, and normals that point away from the viewer;
   else 0. */
SOFT_INLINE lanes_int is_turned(const struct eight_points *spot, vec view)
{
    lanes towards = dot(spot->normal, view);
    return (spot->back & (towards < 0.0f)) | (towards < (float)MOST_AWAY);
}

SOFT_INLINE vec facing(const struct eight_points *spot, vec view)
{
    return times(spot->normal, lanes_choose(is_turned(spot, view), all(-1), all(1)));
}

/* --- the sun ----------------------------------------------------------------------------------------------------------------- */

/* Returns the visible part of the sun, 0..1: the mean of four shadow lookups on a rotated square. s, t, depth: position on the map and
   depth, 0..1, lifted off the surface. Points outside the map are lit. */
SOFT_INLINE lanes sun_visible(const struct soft_light *light, lanes s, lanes t, lanes depth)
{
    static const float turn[2] = { SUN_TURN };
    const float spread = (float)SUN_SPREAD / (float)light->sun_map_px, u = turn[0] * spread, v = turn[1] * spread;
    lanes sum = sun_tap(light, s + u, t + v, depth) + sun_tap(light, s - u, t - v, depth);
    sum += sun_tap(light, s - v, t + u, depth) + sun_tap(light, s + v, t - u, depth);
    return lanes_choose((s > 0.0f) & (s < 1.0f) & (t > 0.0f) & (t < 1.0f), 0.25f * sum, all(1));
}

SOFT_INLINE lanes sun_at(const struct refined *refined, const struct eight_points *spot, vec n)
{
    const float(*m)[4] = refined->sun_from_pixel;
    const float(*step)[3] = refined->sun_from_normal;
    lanes at[4], place[3];
    for (int r = 0; r < 4; r++)
        at[r] = spot->x * m[0][r] + spot->y * m[1][r] + spot->depth * m[2][r] + m[3][r];
    lanes over = 1.0f / at[3];
    for (int r = 0; r < 3; r++)
        place[r] = at[r] * over + n.x * step[0][r] + n.y * step[1][r] + n.z * step[2][r];
    return sun_visible(refined->raster.light, place[0], place[1], place[2]);
}

SOFT_INLINE vec towards_sun(const struct refined *refined)
{
    const float *sun = refined->raster.block.sun;
    return (vec){ all(sun[0]), all(sun[1]), all(sun[2]) };
}

#endif
