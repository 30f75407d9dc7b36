/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes how well sensors cover an asset's surface, from each vertex's distance to its nearest sensor and the area that the
   vertex represents. */
#include "placing/sensor_coverage.h"

#include <math.h>

#include "base/math/vec.h"
#include "base/mem.h"
#include "field/kernels.h"
#include "plant/models/transform.h"

double *sensor_coverage_areas(const struct asset_view *view)
{
    double *areas = mem_array(view->header->vertex_count, sizeof(*areas));
    const struct asset_level *finest = &view->levels[0];
    for (uint32_t p = 0; p < finest->primitive_count; p++) {
        const struct asset_primitive *primitive = &view->primitives[finest->first_primitive + p];
        for (uint32_t i = 0; i + 2 < primitive->index_count; i += 3) {
            const uint32_t *corner = &view->indices[primitive->first_index + i];
            double u[3], v[3], n[3];
            for (int c = 0; c < 3; c++) {
                u[c] = (double)(view->positions_m[corner[1]][c] - view->positions_m[corner[0]][c]);
                v[c] = (double)(view->positions_m[corner[2]][c] - view->positions_m[corner[0]][c]);
            }
            vec_cross(u, v, n);
            for (int k = 0; k < 3; k++)
                areas[corner[k]] += vec_length(n) / 6;
        }
    }
    return areas;
}

static double size_of(const struct scene_asset *asset)
{
    double square = 0;
    for (int c = 0; c < 3; c++)
        square += pow(asset->bounds_max_m[c] - asset->bounds_min_m[c], 2);
    return sqrt(square);
}

static void to_plant(const struct scene_asset *asset, const float file_m[3], double out[3])
{
    for (int c = 0; c < 3; c++)
        out[c] = (double)file_m[c];
    transform_point(asset->placement, out, out);
}

static void find_next(const struct field_layout *layout, enum distance_mode mode, struct sensor_coverage *out)
{
    for (size_t i = 0; i < layout->sensor_count; i++) {
        double least_m = INFINITY;
        size_t next = i;
        for (size_t j = 0; j < layout->sensor_count; j++) {
            float scratch[1];
            double m = j == i ? (double)INFINITY : (double)*layout_distances(layout, mode, i, layout->sensors[j].vertex, 1, scratch);
            if (m < least_m) {
                least_m = m;
                next = j;
            }
        }
        if (next == i || least_m < out->next_m)
            continue;
        out->next_m = least_m;
        out->next_tags[0] = layout->sensors[i].tag;
        out->next_tags[1] = layout->sensors[next].tag;
    }
}

/* A block of surface vertices. By vertex: distance in metres to the vertex's nearest sensor, and whether that sensor's reading is
   usable. */
struct nearest_block {
    float m[KERNEL_BLOCK];
    bool good[KERNEL_BLOCK];
};

static void find_nearest(const struct sensor_coverage_query *order, const struct field_layout *layout, size_t at, size_t count,
                         struct nearest_block *out)
{
    float scratch[KERNEL_BLOCK];
    for (size_t v = 0; v < count; v++)
        out->m[v] = INFINITY;
    for (size_t i = 0; i < layout->sensor_count; i++) {
        const float *m = layout_distances(layout, order->mode, i, at, count, scratch);
        bool good = order->good[layout->sensors[i].tag];
        for (size_t v = 0; v < count; v++)
            if (m[v] < out->m[v] || (m[v] == out->m[v] && good)) {
                out->m[v] = m[v];
                out->good[v] = good;
            }
    }
}

bool sensor_coverage_find(const struct sensor_coverage_query *order, struct sensor_coverage *out)
{
    const struct scene_asset *asset = &order->scene->assets[order->asset];
    struct field_layout *layout = layout_create(order->scene, order->asset, order->group, order->trial);
    *out = (struct sensor_coverage){ .next_tags = { -1, -1 } };
    if (!layout)
        return false;
    double *areas = sensor_coverage_areas(&asset->file->view), all = 0, far = 0, lost = 0;
    double usual_m = isfinite(order->reach_m) ? order->reach_m / 2 : size_of(asset) / 5;
    struct nearest_block *nearest = mem_new(sizeof(*nearest));
    size_t farthest = 0;
    out->sensors = layout->sensor_count;
    out->far_m = order->far_m > 0 ? order->far_m : usual_m;
    for (size_t at = 0, count; at < layout->vertex_count; at += count) {
        count = layout->vertex_count - at < KERNEL_BLOCK ? layout->vertex_count - at : KERNEL_BLOCK;
        find_nearest(order, layout, at, count, nearest);
        for (size_t v = 0; v < count; v++) {
            double m = (double)nearest->m[v], area = areas[at + v];
            all += area;
            far += m > out->far_m ? area : 0;
            lost += m == (double)INFINITY || m > order->reach_m || !nearest->good[v] ? area : 0;
            if (m < 1e30 && m > out->farthest_m) {
                out->farthest_m = m;
                farthest = at + v;
            }
        }
    }
    out->far_share = all > 0 ? far / all : 0;
    out->lost_share = all > 0 ? lost / all : 0;
    to_plant(asset, asset->file->view.positions_m[farthest], out->farthest_at_m);
    find_next(layout, order->mode, out);
    mem_free(nearest);
    mem_free(areas);
    layout_destroy(&layout);
    return true;
}
