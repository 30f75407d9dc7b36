/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Layouts (layout.h): lists the sensors of one group on one asset, and computes the distances of vertices from them. */
#include "field/layout.h"

#include <float.h>
#include <math.h>
#include <pthread.h>
#include <string.h>

#include "base/math/vec.h"
#include "base/mem.h"
#include "field/kernels.h"
#include "plant/exact.h"
#include "protocol/asset_distance.h"

_Static_assert(KERNEL_BLOCK == ASSET_DISTANCE_BLOCK,
               "KERNEL_BLOCK must equal the block size of the file, because the kernels take one block at a time");

static bool of_group(const struct scene *scene, const struct scene_sensor *sensor, int group)
{
    return scene->plant->tags[sensor->tag].group == group;
}

/* Returns true if the group has a sensor with a known position; sensors with an assumed position are then ignored. Trial
   positions count as known. */
static bool has_known(const struct scene *scene, int asset, int group, const struct trial *trial)
{
    const struct scene_asset *from = &scene->assets[asset];
    for (size_t i = 0; i < from->sensor_count; i++)
        if (of_group(scene, &from->sensors[i], group) && !scene->plant->tags[from->sensors[i].tag].place.assumed &&
            !trial_find(trial, from->sensors[i].tag))
            return true;
    for (size_t i = 0; trial && i < trial->count; i++)
        if (trial->sensors[i].asset == asset && scene->plant->tags[trial->sensors[i].tag].group == group)
            return true;
    return false;
}

static float not_negative(double x)
{
    return x > 0 && x < 1e30 ? (float)x : 0.0f;
}

bool layout_is_touched(const struct scene *scene, int asset, int group, const struct trial *trial)
{
    for (size_t i = 0; trial && i < trial->count; i++) {
        const struct plant_tag *tag = &scene->plant->tags[trial->sensors[i].tag];
        if (tag->group == group && (trial->sensors[i].asset == asset || tag->asset == asset))
            return true;
    }
    return false;
}

static void add_sensor(struct field_layout *layout, struct layout_sensor sensor)
{
    const struct plant_tag *tag = &layout->tags[sensor.tag];
    sensor.strength = layout->assumed ? 1 : not_negative(tag->strength);
    sensor.decay = not_negative(tag->decay);
    layout->sensors[layout->sensor_count++] = sensor;
}

/* Adds to the layout a sensor whose distances are in the asset file. number: the sensor's index among the group's sensors with
   a known position. */
static void add_prepared(struct field_layout *layout, const struct scene_sensor *sensor, size_t number)
{
    const struct asset_view *view = &layout->file->view;
    const struct asset_sensor *in_file = &view->sensors[sensor->column];
    struct layout_sensor made = { .tag = sensor->tag, .column = (uint32_t)sensor->column, .vertex = in_file->nearest_vertex };
    const struct influence_entry *heat = influence_find(&layout->file->influence, layout->number, INFLUENCE_HEAT);
    if (heat && !layout->assumed && number < heat->sensor_count)
        made.heat_m = (const float *)influence_array(&layout->file->influence, heat->shares) + number * layout->vertex_count;
    memcpy(made.surface_m, in_file->surface_m, sizeof(made.surface_m));
    add_sensor(layout, made);
}

static void add_trial(struct field_layout *layout, const struct trial_sensor *sensor)
{
    struct layout_sensor made = { .tag = sensor->tag,
                                  .column = layout->file->view.header->sensor_count + sensor->number,
                                  .vertex = sensor->vertex,
                                  .tried = true,
                                  .tried_m = trial_distances(sensor) };
    memcpy(made.surface_m, sensor->surface_m, sizeof(made.surface_m));
    add_sensor(layout, made);
}

struct field_layout *layout_create(const struct scene *scene, int asset, int group, const struct trial *trial)
{
    const struct scene_asset *from = &scene->assets[asset];
    struct field_layout *layout = mem_new(sizeof(*layout));
    layout->file = from->file;
    layout->group = &scene->plant->groups[group];
    layout->number = (uint32_t)group;
    layout->tags = scene->plant->tags;
    layout->vertex_count = from->file->view.header->vertex_count;
    layout->trial = trial ? trial->id : 0;
    layout->assumed = !has_known(scene, asset, group, trial);
    layout->sensors = mem_array(from->sensor_count + (trial ? trial->count : 0), sizeof(*layout->sensors));
    for (size_t i = 0, number = 0; i < from->sensor_count; i++) {
        bool known = !scene->plant->tags[from->sensors[i].tag].place.assumed;
        if (!of_group(scene, &from->sensors[i], group))
            continue;
        if (!trial_find(trial, from->sensors[i].tag) && (layout->assumed || known))
            add_prepared(layout, &from->sensors[i], number);
        number += known;
    }
    for (size_t i = 0; trial && i < trial->count; i++)
        if (trial->sensors[i].asset == asset && scene->plant->tags[trial->sensors[i].tag].group == group)
            add_trial(layout, &trial->sensors[i]);
    if (layout->sensor_count == 0)
        layout_destroy(&layout);
    return layout;
}

void layout_remove_ineffective(struct field_layout *layout, enum interpolation interpolation)
{
    size_t kept = 0;
    for (size_t i = 0; i < layout->sensor_count; i++)
        if (interpolation != INTERPOLATION_SHEPARD || layout->sensors[i].strength > 0)
            layout->sensors[kept++] = layout->sensors[i];
    layout->sensor_count = kept;
}

void layout_destroy(struct field_layout **layout_ptr)
{
    struct field_layout *layout = *layout_ptr;
    if (!layout)
        return;
    mem_free(layout->sensors);
    mem_free(layout);
    *layout_ptr = NULL;
}

const float *layout_along(const struct layout_sensor *sensor, enum distance_mode mode)
{
    return mode == DISTANCE_EUCLIDEAN ? NULL : mode == DISTANCE_HEAT && sensor->heat_m ? sensor->heat_m : sensor->tried_m;
}

bool layout_is_exact(const struct field_layout *layout, enum interpolation interpolation, enum distance_mode mode)
{
    return !layout->assumed && plant_is_exact(interpolation, mode);
}

bool layout_is_in_file(const struct layout_sensor *sensor, enum distance_mode mode)
{
    return mode != DISTANCE_EUCLIDEAN && !sensor->tried && !layout_along(sensor, mode);
}

static float corner_distance(const struct field_layout *layout, const struct layout_sensor *sensor, const float *along_m, uint32_t corner)
{
    return along_m ? along_m[corner] : asset_distance_m(&layout->file->view, sensor->column, corner);
}

void layout_set_point(const struct asset_view *file, const struct layout_points *points, size_t point, const uint32_t corners[3],
                      const float parts[3])
{
    memcpy(points->corners[point], corners, sizeof(*points->corners));
    memcpy(points->parts[point], parts, sizeof(*points->parts));
    for (int c = 0; c < 3; c++) {
        double at = 0;
        for (int k = 0; k < 3; k++)
            at += (double)parts[k] * (double)file->positions_m[corners[k]][c];
        points->positions_m[point][c] = (float)at;
    }
    for (int k = 0; k < 3; k++)
        points->away_m[point][k] = parts[k] == 1 ? 0 : vecf_distance(points->positions_m[point], file->positions_m[corners[k]]);
}

/* Returns the distance from point p in a triangle to a virtual source s in the triangle's plane that has the given distances
   from the corners: |p - s|^2 = sum_k part_k (|corner_k - s|^2 - |corner_k - p|^2), with part_k the barycentric coordinates of
   p. If paths from two sides meet within the triangle, no such source exists; the triangle inequality then bounds the distance. */
static float along_at(const struct field_layout *layout, const struct layout_sensor *sensor, const float *along_m, size_t point)
{
    const float *part = layout->points->parts[point], *away_m = layout->points->away_m[point];
    float square_m2 = 0, least_m = 0, most_m = FLT_MAX;
    for (int k = 0; k < 3; k++) {
        float far_m = part[k] != 0 ? corner_distance(layout, sensor, along_m, layout->points->corners[point][k]) : 0;
        if (part[k] == 0)
            continue;
        square_m2 += part[k] * (far_m - away_m[k]) * (far_m + away_m[k]);
        least_m = far_m - away_m[k] > least_m ? far_m - away_m[k] : least_m;
        most_m = far_m + away_m[k] < most_m ? far_m + away_m[k] : most_m;
    }
    if (!(square_m2 <= FLT_MAX))
        return INFINITY;
    float distance_m = square_m2 > 0 ? sqrtf(square_m2) : 0;
    distance_m = distance_m > least_m ? distance_m : least_m;
    return distance_m < most_m ? distance_m : most_m;
}

static const float *point_distances(const struct field_layout *layout, enum distance_mode mode, const struct layout_sensor *sensor,
                                    size_t begin, size_t count, float *scratch)
{
    const float *along_m = layout_along(sensor, mode);
    bool along = along_m || layout_is_in_file(sensor, mode);
    if (!along)
        kernel_euclidean(layout->points->positions_m + begin, count, sensor->surface_m, scratch);
    for (size_t j = 0; along && j < count; j++)
        scratch[j] = along_at(layout, sensor, along_m, begin + j);
    return scratch;
}

const float *layout_distances(const struct field_layout *layout, enum distance_mode mode, size_t sensor, size_t begin, size_t count,
                              float *scratch)
{
    const struct layout_sensor *from = &layout->sensors[sensor];
    const float *along_m = layout_along(from, mode);
    if (layout->points)
        return point_distances(layout, mode, from, begin, count, scratch);
    if (along_m)
        return along_m + begin;
    if (layout_is_in_file(from, mode)) {
        kernel_distances(asset_distance_codes(&layout->file->view, from->column, begin) + begin % KERNEL_BLOCK, count, scratch);
        return scratch;
    }
    kernel_euclidean(layout->file->view.positions_m + begin, count, from->surface_m, scratch);
    return scratch;
}

void layout_point_init(struct layout_point *point, const struct field_layout *layout, const uint32_t corners[3], const float parts[3])
{
    *point = (struct layout_point){ .points = { point->position_m, point->corners, point->parts, point->away_m }, .layout = *layout };
    point->layout.points = &point->points;
    point->layout.vertex_count = 1;
    layout_set_point(&layout->file->view, &point->points, 0, corners, parts);
}

struct lost_vertex_search {
    const struct field_layout *layout;
    enum distance_mode mode;
    pthread_mutex_t lock;
    /* --- below: under lock */
    float most_m;
};

static void search_blocks(void *arg, size_t begin, size_t end)
{
    struct lost_vertex_search *search = arg;
    const struct field_layout *layout = search->layout;
    float scratch[KERNEL_BLOCK], most_m = 0;
    for (size_t at = begin * KERNEL_BLOCK; at < end * KERNEL_BLOCK && at < layout->vertex_count; at += KERNEL_BLOCK) {
        size_t left = layout->vertex_count - at, count = left < KERNEL_BLOCK ? left : KERNEL_BLOCK;
        for (size_t i = 0; i < layout->sensor_count; i++)
            most_m = kernel_largest(layout_distances(layout, search->mode, i, at, count, scratch), count, most_m);
    }
    pthread_mutex_lock(&search->lock);
    search->most_m = fmaxf(search->most_m, most_m);
    pthread_mutex_unlock(&search->lock);
}

float layout_largest(struct field_layout *layout, enum distance_mode mode, struct workers *workers)
{
    if (layout->largest_m[mode] == 0) {
        struct lost_vertex_search search = { .layout = layout, .mode = mode };
        pthread_mutex_init(&search.lock, NULL);
        workers_for(workers, (layout->vertex_count + KERNEL_BLOCK - 1) / KERNEL_BLOCK, 16, search_blocks, &search);
        pthread_mutex_destroy(&search.lock);
        layout->largest_m[mode] = search.most_m > 0 ? search.most_m : 1.0f;
    }
    return layout->largest_m[mode];
}
