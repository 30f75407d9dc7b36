/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Computes bounding boxes and normal cones (ranges of the directions of triangles) of an asset's clusters. */
#include <float.h>
#include <math.h>

#include "protocol/asset_format_impl.h"

/* minimum cosine of the half angle of a normal cone. The triangles of wider cones hardly ever all face away from the eye, so such cones are
   stored as "normals in all directions" */
#define MIN_CONE_COSINE 0.1

double asset_length(const float v[3])
{
    return sqrt((double)v[0] * (double)v[0] + (double)v[1] * (double)v[1] + (double)v[2] * (double)v[2]);
}

/* Computes the unit normal of a triangle. Returns false for a triangle without area, because it is invisible from all sides. */
static bool face_normal(const float (*positions_m)[3], const uint32_t v[3], double n[3])
{
    double u[3], w[3];
    for (int i = 0; i < 3; i++) {
        u[i] = (double)positions_m[v[1]][i] - (double)positions_m[v[0]][i];
        w[i] = (double)positions_m[v[2]][i] - (double)positions_m[v[0]][i];
    }
    for (int i = 0; i < 3; i++)
        n[i] = u[(i + 1) % 3] * w[(i + 2) % 3] - u[(i + 2) % 3] * w[(i + 1) % 3];
    double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int i = 0; i < 3 && length > 0; i++)
        n[i] /= length;
    return length > 0;
}

double asset_cluster_least_dot(const struct asset_cluster *cluster, const float (*positions_m)[3], const uint32_t *indices,
                               const float axis[3])
{
    double least = 1, n[3];
    for (uint32_t i = cluster->first_index; i < cluster->first_index + cluster->index_count; i += 3)
        if (face_normal(positions_m, indices + i, n))
            least = fmin(least, n[0] * (double)axis[0] + n[1] * (double)axis[1] + n[2] * (double)axis[2]);
    return least;
}

static void measure_cone(struct asset_cluster *cluster, const float (*positions_m)[3], const uint32_t *indices)
{
    double sum[3] = { 0 }, n[3];
    for (uint32_t i = cluster->first_index; i < cluster->first_index + cluster->index_count; i += 3)
        if (face_normal(positions_m, indices + i, n))
            for (int axis = 0; axis < 3; axis++)
                sum[axis] += n[axis];
    double length = sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
    for (int axis = 0; axis < 3; axis++)
        cluster->cone_axis[axis] = length > 0 ? (float)(sum[axis] / length) : 0;
    double least = length > 0 ? asset_cluster_least_dot(cluster, positions_m, indices, cluster->cone_axis) : 0;
    if (least > MIN_CONE_COSINE)
        cluster->cone_cutoff = (float)sqrt(fmax(0, 1 - least * least));
    else
        *cluster = (struct asset_cluster){ .first_index = cluster->first_index, .index_count = cluster->index_count, .cone_cutoff = 1 };
}

void asset_cluster_measure(struct asset_cluster *cluster, const float (*positions_m)[3], const uint32_t *indices)
{
    measure_cone(cluster, positions_m, indices);
    for (int axis = 0; axis < 3; axis++) {
        cluster->low_m[axis] = FLT_MAX;
        cluster->high_m[axis] = -FLT_MAX;
    }
    for (uint32_t i = cluster->first_index; i < cluster->first_index + cluster->index_count; i++)
        for (int axis = 0; axis < 3; axis++) {
            float x = positions_m[indices[i]][axis];
            cluster->low_m[axis] = x < cluster->low_m[axis] ? x : cluster->low_m[axis];
            cluster->high_m[axis] = x > cluster->high_m[axis] ? x : cluster->high_m[axis];
        }
}

bool asset_cluster_turned_away(const struct asset_cluster *cluster, const float eye_m[3])
{
    float dot = 0, length2 = 0, radius2 = 0;
    for (int axis = 0; axis < 3; axis++) {
        float half = (cluster->high_m[axis] - cluster->low_m[axis]) / 2, to = cluster->low_m[axis] + half - eye_m[axis];
        dot += to * cluster->cone_axis[axis];
        length2 += to * to;
        radius2 += half * half;
    }
    return cluster->cone_cutoff < 1 && dot >= cluster->cone_cutoff * sqrtf(length2) + sqrtf(radius2);
}
