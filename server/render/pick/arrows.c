/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Spreads positions of direction arrows evenly over an asset's triangles, and computes the direction of the field at each position. */
#include "render/pick/arrows.h"

#include <math.h>

#include "base/math/vec.h"
#include "base/mem.h"
#include "render/pick/coarse_level.h"

enum { MAX_POSITIONS = 400, MAX_CANDIDATES = 20000, MAX_CUTS = 64 };

size_t arrows_vertex_count(const struct scene_asset *asset)
{
    return coarse_level(asset)->vertex_count;
}

/* --- places ----------------------------------------------------------------------------------------------------------------- */

struct arrow_candidates {
    const struct asset_view *view;
    struct direction_place *at;
    size_t count, capacity;
    double spacing_m;
};

static void corners_of(const struct asset_view *view, const uint32_t corners[3], double out[3][3])
{
    for (int i = 0; i < 3; i++)
        for (int c = 0; c < 3; c++)
            out[i][c] = (double)view->positions_m[corners[i]][c];
}

static void point_of(const struct asset_view *view, const struct direction_place *place, double out[3])
{
    for (int c = 0; c < 3; c++) {
        out[c] = 0;
        for (int i = 0; i < 3; i++)
            out[c] += (double)(place->weights[i] * view->positions_m[place->corners[i]][c]);
    }
}

/* Divides a triangle into equal parts, each about half an arrow spacing long, and adds their centres as possible arrow positions. */
static void add_triangle(struct arrow_candidates *candidates, const uint32_t corners[3], uint32_t triangle)
{
    double at[3][3], normal[3];
    corners_of(candidates->view, corners, at);
    vec_normal(at[0], at[1], at[2], normal);
    double longest_m = max_of(vec_distance(at[0], at[1]), max_of(vec_distance(at[1], at[2]), vec_distance(at[2], at[0])));
    if (!(vec_normalize(normal) > 0))
        return;
    int cuts = (int)min_of(ceil(2 * longest_m / candidates->spacing_m), MAX_CUTS);
    for (int i = 0; i < cuts; i++)
        /* the triangle is divided into `cuts` rows of small triangles; every second triangle of a row (odd j) points the other way */
        for (int j = 0; j < 2 * (cuts - i) - 1; j++) {
            double third = j % 2 ? 2.0 / 3 : 1.0 / 3, a = (i + third) / cuts, b = (j / 2 + third) / cuts;
            mem_grow(&candidates->at, &candidates->capacity, candidates->count + 1, sizeof(*candidates->at));
            candidates->at[candidates->count++] =
                (struct direction_place){ .corners = { corners[0], corners[1], corners[2] },
                                          .weights = { (float)(1 - a - b), (float)a, (float)b },
                                          .normal = { (float)normal[0], (float)normal[1], (float)normal[2] },
                                          .triangle = triangle };
        }
}

static bool is_apart(const struct arrow_set *set, const struct asset_view *view, const struct direction_place *place, double least_m)
{
    double here[3], there[3];
    point_of(view, place, here);
    for (size_t i = 0; i < set->count; i++) {
        const float *a = set->places[i].normal, *b = place->normal;
        point_of(view, &set->places[i], there);
        /* the normals at the two positions point in opposite directions: they are on the two sides of a thin wall, so their
           arrows may be close to each other */
        if (a[0] * b[0] + a[1] * b[1] + a[2] * b[2] > 0 && vec_distance(here, there) < least_m)
            return false;
    }
    return true;
}

/* Chooses arrow positions in rounds; each round halves the minimum distance between positions. The first n positions of the
   list are thus evenly spread, for any n. */
static void select_spread(struct arrow_set *set, const struct arrow_candidates *candidates)
{
    set->places = mem_array(MAX_POSITIONS, sizeof(*set->places));
    size_t step = candidates->count / MAX_CANDIDATES + 1;
    for (double least_m = 4 * candidates->spacing_m; least_m >= candidates->spacing_m; least_m /= 2)
        for (size_t i = 0; i < candidates->count && set->count < MAX_POSITIONS; i += step)
            if (is_apart(set, candidates->view, &candidates->at[i], least_m))
                set->places[set->count++] = candidates->at[i];
    set->found = mem_array(set->count, sizeof(*set->found));
}

static void find_positions(struct arrow_set *set, const struct scene_asset *asset)
{
    struct arrow_candidates candidates = { .view = &asset->file->view };
    const struct asset_level *level = coarse_level(asset);
    /* pass 0 measures the asset's area, which determines the distance between arrows; pass 1 adds arrow positions at this distance */
    for (int pass = 0; pass < 2; pass++) {
        double area_m2 = 0;
        uint32_t triangle = 0;
        for (uint32_t p = 0; p < level->primitive_count; p++) {
            const struct asset_primitive *primitive = &candidates.view->primitives[level->first_primitive + p];
            const uint32_t *corners = candidates.view->indices + primitive->first_index;
            for (uint32_t i = 0; i < primitive->index_count; i += 3, triangle++) {
                double at[3][3], normal[3];
                corners_of(candidates.view, corners + i, at);
                vec_normal(at[0], at[1], at[2], normal);
                area_m2 += 0.5 * vec_length(normal);
                if (pass == 1)
                    add_triangle(&candidates, corners + i, triangle);
            }
        }
        candidates.spacing_m = sqrt(area_m2 / MAX_POSITIONS);
        if (!(candidates.spacing_m > 0))
            break;
    }
    set->spacing_m = candidates.spacing_m;
    set->error_m = level->error_m;
    set->sought = true;
    if (candidates.count > 0)
        select_spread(set, &candidates);
    mem_free(candidates.at);
}

/* --- directions ------------------------------------------------------------------------------------------------------------- */

void arrows_update(struct arrow_set *set, const struct scene *scene, int asset, const struct fields_entry *field)
{
    if (!set->sought)
        find_positions(set, &scene->assets[asset]);
    if (set->content == field->directions_content)
        return;
    set->content = field->directions_content;
    const struct direction_sources sources = { scene, asset, &field->params, field->directions, field->direction_count };
    directions_find(&sources, set->places, set->count, set->found);
}

double arrows_value(const struct arrow_set *set, size_t place, const struct asset_view *file, const struct fields_entry *field)
{
    return arrows_value_at(&set->places[place], file, field);
}

static double evaluated_at(const struct direction_place *at, const struct asset_view *file, const struct pixel_field *pixels)
{
    double place_m[3];
    struct pixel_value value;
    point_of(file, at, place_m);
    pixel_field_at(pixels, (const float[3]){ (float)place_m[0], (float)place_m[1], (float)place_m[2] }, &value);
    return value.no_data ? (double)NAN : (double)value.value;
}

double arrows_value_at(const struct direction_place *at, const struct asset_view *file, const struct fields_entry *field)
{
    double value = 0;
    if (field->pixels.count > 0)
        return evaluated_at(at, file, &field->pixels);
    for (int i = 0; i < 3; i++) {
        const struct scalar *scalar = &field->shown[at->corners[i]];
        if (scalar->no_data)
            return (double)NAN;
        value += (double)(at->weights[i] * scalar->value);
    }
    return value;
}

void arrows_place(const struct arrow_set *set, size_t place, const struct scene_asset *asset, double place_m[3], double along[3])
{
    arrows_place_at(&set->places[place], &set->found[place], asset, place_m, along);
}

void arrows_place_at(const struct direction_place *at, const struct direction *to, const struct scene_asset *asset, double place_m[3],
                     double along[3])
{
    const double *m = asset->placement;
    double file_m[3];
    point_of(&asset->file->view, at, file_m);
    for (int c = 0; c < 3; c++) {
        place_m[c] = m[c] * file_m[0] + m[4 + c] * file_m[1] + m[8 + c] * file_m[2] + m[12 + c];
        along[c] = m[c] * (double)to->along[0] + m[4 + c] * (double)to->along[1] + m[8 + c] * (double)to->along[2];
    }
}

void arrows_finish(struct arrow_set *set)
{
    mem_free(set->places);
    mem_free(set->found);
}
