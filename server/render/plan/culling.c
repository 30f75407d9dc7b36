/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Culls triangle clusters: tests their bounding boxes against the frustum planes, and their normal cones against the eye position. */
#include "render/plan/culling.h"

#include "render/matrix.h"

void culling_init(struct culling *culling, const struct view_constants *constants, const struct scene_asset *asset)
{
    double file_from_plant[16], eye[4];
    for (int p = 0; p < 6; p++)
        for (int c = 0; c < 4; c++) {
            double sum = c == 3 ? constants->planes[p][3] : 0;
            for (int r = 0; r < 3; r++)
                sum += constants->planes[p][r] * asset->placement[4 * c + r];
            culling->planes[p][c] = (float)sum;
        }
    matrix_invert(asset->placement, file_from_plant);
    matrix_point(file_from_plant, constants->eye_m, eye);
    for (int c = 0; c < 3; c++)
        culling->eye_m[c] = (float)eye[c];
    culling->cones = !scene_asset_mirrored(asset) && constants->pixel_per_metre <= 0;
}

static bool in_frustum(const struct culling *culling, const struct asset_cluster *cluster)
{
    for (int p = 0; p < 6; p++) {
        const float *plane = culling->planes[p];
        /* signed distance from the frustum plane to that corner of the cluster's box that is farthest on the plane's inner
           side; below 0: the whole box is outside */
        float far = plane[3];
        for (int c = 0; c < 3; c++)
            far += plane[c] * (plane[c] > 0 ? cluster->high_m[c] : cluster->low_m[c]);
        if (far < 0)
            return false;
    }
    return true;
}

bool culling_sees(const struct culling *culling, const struct asset_cluster *cluster, bool double_sided)
{
    return in_frustum(culling, cluster) && (!culling->cones || double_sided || !asset_cluster_turned_away(cluster, culling->eye_m));
}
