/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Traces strokes (short streamlines) over a surface: finds neighbours of triangles by their corner positions, and steps from triangle to
   triangle. */
#include "render/pick/strokes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/math/vec.h"
#include "base/mem.h"
#include "render/pick/coarse_level.h"

#define STROKE_NONE UINT32_MAX
enum { MAX_CROSSINGS = 64 };          /* maximum number of triangle edges that one step of a stroke may cross */
/* step length for tracing strokes (short streamlines), as a fraction of the distance between arrows */
static const double STEP_PART = 0.35;
/* A stroke ends where its direction turns by more than 120 degrees from one step to the next: the cosine is then below this.
   Such turns are vortices too small to trace. */
static const double MIN_DOT = -0.5;

/* --- neighbours ------------------------------------------------------------------------------------------------------------- */

struct triangle_side { /* one side of a triangle */
    float low[3], high[3];
    uint32_t at; /* the triangle and its side: 3 * index of the triangle + number (0 to 2) of the corner where the side begins */
};

static int compare_sides(const void *a, const void *b)
{
    return memcmp(a, b, 6 * sizeof(float));
}

/* Finds the neighbours of each triangle by corner positions, since vertices are duplicated where normals or materials differ. A side shared
   by more than two triangles counts as a border of the surface. */
static void find_neighbours(struct stroke_set *set, const struct asset_view *view, const struct asset_level *level, size_t tri_count)
{
    struct triangle_side *sides = mem_array(3 * tri_count + 1, sizeof(*sides));
    size_t tri = 0;
    set->across = mem_array(tri_count + 1, sizeof(*set->across));
    memset(set->across, 0xff, tri_count * sizeof(*set->across));
    for (uint32_t p = 0; p < level->primitive_count; p++) {
        const struct asset_primitive *primitive = &view->primitives[level->first_primitive + p];
        const uint32_t *corners = view->indices + primitive->first_index;
        for (uint32_t i = 0; i < primitive->index_count; i += 3, tri++)
            for (uint32_t e = 0; e < 3; e++) {
                struct triangle_side *side = &sides[3 * tri + e];
                for (int c = 0; c < 3; c++) { /* adding 0.0 turns -0 into 0, so that equal positions have equal bytes */
                    side->low[c] = view->positions_m[corners[i + e]][c] + 0.0f;
                    side->high[c] = view->positions_m[corners[i + (e + 1) % 3]][c] + 0.0f;
                }
                if (memcmp(side->low, side->high, sizeof(side->low)) > 0)
                    for (int c = 0; c < 3; c++) {
                        float swapped = side->low[c];
                        side->low[c] = side->high[c];
                        side->high[c] = swapped;
                    }
                side->at = (uint32_t)(3 * tri + e);
            }
    }
    qsort(sides, 3 * tri_count, sizeof(*sides), compare_sides);
    for (size_t i = 0, end; i < 3 * tri_count; i = end) {
        for (end = i + 1; end < 3 * tri_count && compare_sides(&sides[i], &sides[end]) == 0;)
            end++;
        if (end - i != 2)
            continue;
        set->across[sides[i].at / 3][sides[i].at % 3] = sides[i + 1].at;
        set->across[sides[i + 1].at / 3][sides[i + 1].at % 3] = sides[i].at;
    }
    mem_free(sides);
}

/* --- steps ------------------------------------------------------------------------------------------------------------------ */

struct tracing {
    const struct asset_view *view;
    const struct stroke_set *set;
    const uint32_t (*tris)[3]; /* level of detail used for tracing: vertex indices of its triangles */
};

static void corners_of(const struct tracing *tracing, uint32_t tri, double out[3][3], double normal[3])
{
    for (int i = 0; i < 3; i++)
        for (int c = 0; c < 3; c++)
            out[i][c] = (double)tracing->view->positions_m[tracing->tris[tri][i]][c];
    vec_normal(out[0], out[1], out[2], normal);
}

/* Computes the change of a position's three barycentric weights in a triangle per metre of movement along the unit vector v.
   Returns false for a triangle without an area. */
static bool rates_of(const double at[3][3], const double normal[3], const double v[3], double rates[3])
{
    const double square = vec_dot(normal, normal);
    if (!(square > 0))
        return false;
    for (int i = 0; i < 3; i++) {
        double edge[3], across[3];
        vec_sub(at[(i + 2) % 3], at[(i + 1) % 3], edge);
        vec_cross(normal, edge, across);
        rates[i] = vec_dot(across, v) / square;
    }
    return true;
}

/* Moves a position on the surface by step_m along the unit vector `along`, continuing straight across triangle edges. Returns false where
   the surface ends. */
static bool step(const struct tracing *tracing, struct direction_place *place, const float along[3], double step_m)
{
    double weights[3], v[3], at[3][3], normal[3], rates[3];
    uint32_t tri = place->triangle;
    int from = -1; /* index of the edge crossed to enter the current triangle; -1: none */
    for (int c = 0; c < 3; c++) {
        weights[c] = (double)place->weights[c];
        v[c] = (double)along[c];
    }
    for (int crossing = 0; crossing < MAX_CROSSINGS; crossing++) {
        corners_of(tracing, tri, at, normal);
        double unit[3] = { normal[0], normal[1], normal[2] }, lifted;
        vec_normalize(unit);
        lifted = vec_dot(v, unit);
        for (int c = 0; c < 3; c++)
            v[c] -= lifted * unit[c];
        if (!(vec_normalize(v) > 0) || !rates_of(at, normal, v, rates))
            return false;
        double most_m = step_m;
        /* edge crossed to leave the triangle: from corner `edge` to the next corner; the third corner's weight is 0 on it */
        int edge = -1;
        for (int i = 0; i < 3; i++) {
            double room_m = rates[(i + 2) % 3] < 0 ? max_of(weights[(i + 2) % 3], 0) / -rates[(i + 2) % 3] : INFINITY;
            if (i != from && room_m < most_m) {
                most_m = room_m;
                edge = i;
            }
        }
        for (int i = 0; i < 3; i++)
            weights[i] = max_of(weights[i] + most_m * rates[i], 0);
        step_m -= most_m;
        if (edge < 0) {
            double sum = weights[0] + weights[1] + weights[2];
            place->triangle = tri;
            for (int i = 0; i < 3; i++) {
                place->corners[i] = tracing->tris[tri][i];
                place->weights[i] = (float)(weights[i] / sum);
                place->normal[i] = (float)unit[i];
            }
            return true;
        }
        const uint32_t next = tracing->set->across[tri][edge];
        if (next == STROKE_NONE)
            return false;
        /* Finds the crossed edge in the neighbouring triangle. Its corners are in the opposite order there, or in the same
           order if the triangles are wound inconsistently. */
        double mirror[3], there[3][3], turned[3], share = weights[(edge + 1) % 3] / max_of(weights[edge] + weights[(edge + 1) % 3], 1e-30);
        from = (int)(next % 3);
        corners_of(tracing, next / 3, there, mirror);
        bool reversed = vec_distance2(there[from], at[edge]) < vec_distance2(there[from], at[(edge + 1) % 3]);
        vec_normalize(mirror);
        for (int c = 0; c < 3; c++)
            turned[c] = reversed ? -mirror[c] : mirror[c];
        vec_turn(v, unit, turned);
        weights[from] = reversed ? 1 - share : share;
        weights[(from + 1) % 3] = 1 - weights[from];
        weights[(from + 2) % 3] = 0;
        tri = next / 3;
    }
    return false;
}

/* --- strokes ---------------------------------------------------------------------------------------------------------------- */

static double dot(const float a[3], const float b[3])
{
    return (double)(a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
}

/* Returns the direction of the field half a step ahead, turned back into the plane of the step's start (midpoint rule). With this rule,
   strokes around a centre stay on circles. */
static struct direction midway(const struct stroke_point *last, const struct direction_place *half, const struct direction *there)
{
    double v[3], from[3], to[3];
    struct direction out = *there;
    for (int c = 0; c < 3; c++) {
        v[c] = (double)there->along[c];
        from[c] = (double)half->normal[c];
        to[c] = (double)last->place.normal[c];
    }
    /* opposite normals mean that the triangles are wound inconsistently, not that the surface turns round: the direction is
       then not turned */
    if (vec_dot(from, to) > 0)
        vec_turn(v, from, to);
    for (int c = 0; c < 3; c++)
        out.along[c] = (float)v[c];
    return out;
}

/* Traces all strokes (short streamlines) of the asset together, one step of each at a time: computing directions for many
   positions in one call is faster. */
static void trace(struct stroke_set *set, const struct tracing *tracing, const struct arrow_set *arrows, const struct scene *scene,
                  int asset, const struct fields_entry *field)
{
    struct direction_place *places = mem_array(set->count + 1, sizeof(*places));
    struct direction *found = mem_array(set->count + 1, sizeof(*found));
    size_t *of = mem_array(set->count + 1, sizeof(*of)), going = 0;
    for (size_t i = 0; i < set->count; i++) {
        set->points[i][0] = (struct stroke_point){ arrows->places[i], arrows->found[i] };
        set->lengths[i] = arrows->found[i].known;
    }
    const double step_m = STEP_PART * arrows->spacing_m;
    const struct direction_sources sources = { scene, asset, &field->params, field->directions, field->direction_count };
    for (int n = 1; n < STROKE_POINTS; n++, going = 0) {
        for (size_t i = 0; i < set->count; i++) {
            const struct stroke_point *last = &set->points[i][n - 1];
            places[going] = last->place;
            if (set->lengths[i] == n && step(tracing, &places[going], last->to.along, step_m / 2))
                of[going++] = i;
        }
        directions_find(&sources, places, going, found);
        size_t halfway = going;
        going = 0;
        for (size_t k = 0; k < halfway; k++) {
            const struct stroke_point *last = &set->points[of[k]][n - 1];
            const struct direction to = midway(last, &places[k], &found[k]);
            places[going] = last->place;
            if (to.known && step(tracing, &places[going], to.along, step_m))
                of[going++] = of[k];
        }
        directions_find(&sources, places, going, found);
        for (size_t k = 0; k < going; k++) {
            const struct stroke_point *last = &set->points[of[k]][n - 1];
            if (!found[k].known || dot(found[k].along, last->to.along) < MIN_DOT)
                continue;
            set->points[of[k]][n] = (struct stroke_point){ places[k], found[k] };
            set->lengths[of[k]]++;
        }
    }
    mem_free(places);
    mem_free(found);
    mem_free(of);
}

void strokes_update(struct stroke_set *set, const struct arrow_set *arrows, const struct scene *scene, int asset,
                    const struct fields_entry *field)
{
    const struct asset_view *view = &scene->assets[asset].file->view;
    const struct asset_level *level = coarse_level(&scene->assets[asset]);
    size_t tri_count = 0, tri = 0;
    if (set->sought && set->content == arrows->content)
        return;
    for (uint32_t p = 0; p < level->primitive_count; p++)
        tri_count += view->primitives[level->first_primitive + p].index_count / 3;
    if (!set->sought) {
        set->count = arrows->count < STROKES_MOST ? arrows->count : STROKES_MOST;
        set->points = mem_array(set->count + 1, sizeof(*set->points));
        set->lengths = mem_array(set->count + 1, sizeof(*set->lengths));
        find_neighbours(set, view, level, tri_count);
        set->sought = true;
    }
    uint32_t(*tris)[3] = mem_array(tri_count + 1, sizeof(*tris));
    for (uint32_t p = 0; p < level->primitive_count; p++) {
        const struct asset_primitive *primitive = &view->primitives[level->first_primitive + p];
        memcpy(tris[tri], view->indices + primitive->first_index, primitive->index_count * sizeof(uint32_t));
        tri += primitive->index_count / 3;
    }
    trace(set, &(struct tracing){ view, set, (const uint32_t(*)[3])tris }, arrows, scene, asset, field);
    mem_free(tris);
    set->content = arrows->content;
}

void strokes_finish(struct stroke_set *set)
{
    mem_free(set->across);
    mem_free(set->points);
    mem_free(set->lengths);
}
