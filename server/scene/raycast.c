/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Intersects rays with the boxes of assets (in plant coordinates), and with the boxes of clusters and the triangles (in the
   coordinates of the asset's file). Computes in double precision. */
#include "scene/raycast.h"

#include <math.h>
#include <string.h>

#include "base/math/vec.h"
#include "plant/models/transform.h"
#include "scene/coincident.h"

/* enlarges each triangle by this barycentric weight, so that no ray slips through between two triangles */
static const double MIN_WEIGHT = 1e-9;

void ray_init(struct ray *ray, const struct camera *camera, double aspect, double x, double y)
{
    double right[3], up[3], forward[3];
    camera_basis(camera, right, up, forward);
    bool parallel = camera->height_m > 0;
    double half = parallel ? camera->height_m / 2 : tan(camera->fov_deg * M_PI / 360);
    for (int i = 0; i < 3; i++) {
        double aside = half * (x * aspect * right[i] + y * up[i]);
        ray->origin[i] = camera->eye_m[i] + (parallel ? aside : 0);
        ray->direction[i] = forward[i] + (parallel ? 0 : aside);
    }
    ray->low = parallel ? -INFINITY : 0;
    ray->high = INFINITY;
    ray->parallel_m = camera_parallel_m(camera);
}

/* Limits the range low..high of the ray's parameter to the part within the box. Returns false if no part is within. */
static bool cross_box(const double origin[3], const double direction[3], const double min[3], const double max[3], double *low,
                      double *high)
{
    for (int i = 0; i < 3; i++) {
        if (direction[i] == 0) {
            if (origin[i] < min[i] || origin[i] > max[i])
                return false;
            continue;
        }
        double a = (min[i] - origin[i]) / direction[i], b = (max[i] - origin[i]) / direction[i];
        *low = fmax(*low, fmin(a, b));
        *high = fmin(*high, fmax(a, b));
    }
    return *low <= *high;
}

struct raycast_search { /* state of a search for the first hit in one asset */
    const struct asset_view *view;
    /* ray in coordinates of the asset file: origin + t direction; low: smallest t at which a hit counts */
    double origin[3], direction[3], low;
    bool cut;
    double limit; /* largest t (the ray's parameter) at which a hit counts */
    struct raycast_hit *hit;
    int asset;
};

struct surface_crossing {
    double t, u, v;
    bool back; /* true: the triangle's back is hit, so the ray leaves a body */
};

/* Intersects the ray with one triangle: Moeller and Trumbore, "Fast, minimum storage ray/triangle intersection", 1997. The determinant is
   negative for back faces. */
static bool cross_triangle(const struct raycast_search *search, const uint32_t corners[3], struct surface_crossing *out)
{
    const float *a = search->view->positions_m[corners[0]], *b = search->view->positions_m[corners[1]],
                *c = search->view->positions_m[corners[2]];
    double ab[3], ac[3], p[3], q[3], s[3];
    for (int i = 0; i < 3; i++) {
        ab[i] = (double)b[i] - (double)a[i];
        ac[i] = (double)c[i] - (double)a[i];
        s[i] = search->origin[i] - (double)a[i];
    }
    vec_cross(search->direction, ac, p);
    double determinant = vec_dot(ab, p);
    if (determinant == 0)
        return false;
    double u = vec_dot(s, p) / determinant;
    if (u < -MIN_WEIGHT || u > 1 + MIN_WEIGHT)
        return false;
    vec_cross(s, ab, q);
    double v = vec_dot(search->direction, q) / determinant;
    if (v < -MIN_WEIGHT || u + v > 1 + MIN_WEIGHT)
        return false;
    *out = (struct surface_crossing){ vec_dot(ac, q) / determinant, u, v, determinant < 0 };
    return true;
}

static void try_triangle(struct raycast_search *search, const uint32_t corners[3], bool one_sided)
{
    struct surface_crossing at;
    if (!cross_triangle(search, corners, &at) || (one_sided && at.back) || at.t < search->low || at.t >= search->limit)
        return;
    memcpy(search->hit->corners, corners, sizeof(search->hit->corners));
    memcpy(search->hit->weights, (double[3]){ 1 - at.u - at.v, at.u, at.v }, sizeof(search->hit->weights));
    search->hit->asset = search->asset;
    search->hit->t = search->limit = at.t;
    search->hit->inside = search->cut && at.back;
}

static bool cluster_crossed(const struct raycast_search *search, const struct asset_cluster *cluster)
{
    double min[3], max[3], low = search->low, high = search->limit;
    for (int i = 0; i < 3; i++) {
        min[i] = (double)cluster->low_m[i];
        max[i] = (double)cluster->high_m[i];
    }
    return cross_box(search->origin, search->direction, min, max, &low, &high);
}

/* Searches the finest level of detail for the first hit. Its primitives and their clusters come first in the asset file. */
static void search_asset(struct raycast_search *search)
{
    const struct asset_view *view = search->view;
    const struct asset_primitive *primitive = &view->primitives[view->levels[0].first_primitive];
    const struct asset_primitive *end = primitive + view->levels[0].primitive_count;
    for (uint32_t i = 0; i < view->header->cluster_count && primitive < end; i++) {
        const struct asset_cluster *cluster = &view->clusters[i];
        while (primitive < end && cluster->first_index >= primitive->first_index + primitive->index_count)
            primitive++;
        if (primitive == end || cluster->first_index < primitive->first_index || !cluster_crossed(search, cluster))
            continue;
        bool one_sided = !search->cut && !view->materials[primitive->material].double_sided;
        for (uint32_t k = 0; k < cluster->index_count; k += 3)
            try_triangle(search, &view->indices[cluster->first_index + k], one_sided);
    }
}

static void find_normal(const struct scene *scene, const struct ray *ray, struct raycast_hit *hit)
{
    const struct scene_asset *asset = &scene->assets[hit->asset];
    double at[3][3], ab[3], ac[3];
    for (int k = 0; k < 3; k++) {
        const float *place = asset->file->view.positions_m[hit->corners[k]];
        transform_point(asset->placement, (double[3]){ (double)place[0], (double)place[1], (double)place[2] }, at[k]);
    }
    for (int i = 0; i < 3; i++) {
        ab[i] = at[1][i] - at[0][i];
        ac[i] = at[2][i] - at[0][i];
    }
    vec_cross(ab, ac, hit->normal);
    double length = sqrt(vec_dot(hit->normal, hit->normal)), turn = vec_dot(hit->normal, ray->direction) > 0 ? -1 : 1;
    for (int i = 0; i < 3; i++)
        hit->normal[i] *= turn / length;
}

/* The asset is drawn shifted towards the viewer (coincident_forward). Converts t of a hit on the asset at its true position to
   t on the asset as drawn. t: parameter of the ray, origin + t direction. brought_back() is the inverse. */
static double brought_forward(const struct ray *ray, const struct scene_asset *asset, double t)
{
    double forward = coincident_forward(asset);
    return ray->parallel_m > 0 ? t - forward * ray->parallel_m : t / (1 + forward);
}

static double brought_back(const struct ray *ray, const struct scene_asset *asset, double t)
{
    double forward = coincident_forward(asset);
    return ray->parallel_m > 0 ? t + forward * ray->parallel_m : t * (1 + forward);
}

/* Prepares `search` for one asset: transforms the ray from plant coordinates to the coordinates of the asset's file. low,
   limit: range of the ray's parameter t in which hits count. Returns false if the ray misses the asset's bounding box in this
   range, or if the placement cannot be inverted. */
static bool aim_at(struct raycast_search *search, const struct scene_asset *asset, const struct ray *ray, double low, double limit)
{
    double file_from_plant[16], ahead[3], enter = low, leave = limit;
    if (!cross_box(ray->origin, ray->direction, asset->bounds_min_m, asset->bounds_max_m, &enter, &leave) ||
        !transform_invert(asset->placement, file_from_plant))
        return false;
    search->view = &asset->file->view;
    search->low = low;
    search->limit = limit;
    for (int c = 0; c < 3; c++)
        ahead[c] = ray->origin[c] + ray->direction[c];
    transform_point(file_from_plant, ray->origin, search->origin);
    transform_point(file_from_plant, ahead, search->direction);
    for (int c = 0; c < 3; c++)
        search->direction[c] -= search->origin[c];
    return true;
}

/* Returns how many of the asset's closed bodies contain the ray's point at t = search->low. Counts crossings beyond that point:
   1 for each crossing out of a body, -1 for each crossing into one. */
static int count_bodies(const struct raycast_search *search, const struct asset *file)
{
    const struct closed_bodies *closed = asset_closed(file, 0);
    struct surface_crossing at;
    int count = 0;
    for (size_t r = 0; r < closed->run_count; r++)
        for (uint32_t i = 0; i < closed->runs[r].index_count; i += 3)
            if (cross_triangle(search, search->view->indices + closed->runs[r].first_index + i, &at) && at.t >= search->low)
                count += at.back ? 1 : -1;
    return count;
}

/* Returns whether the ray meets a section cap (render/gl/section_caps.h): whether it passes the section plane at a point inside
   a closed body. */
static bool hits_cap(const struct scene *scene, const struct visibility *visibility, const struct ray *ray, double low, double high,
                     struct raycast_hit *hit)
{
    int bodies = 0;
    /* meets no cap, because the ray starts in the space that section planes keep, and so enters through no section plane */
    if (!(low > ray->low))
        return false;
    for (size_t i = 0; i < scene->asset_count; i++) {
        const struct scene_asset *asset = &scene->assets[i];
        struct raycast_search search = { 0 };
        if (visibility_of(visibility, (int)i) != ASSET_SHOWN ||
            !clip_touches(&visibility->clip, asset->bounds_min_m, asset->bounds_max_m) || !aim_at(&search, asset, ray, low, high))
            continue;
        int own = count_bodies(&search, asset->file);
        bodies += own;
        if (own > 0)
            hit->asset = (int)i;
    }
    if (bodies <= 0)
        return false;
    hit->t = low;
    hit->inside = true;
    return true;
}

/* Sets the hit's normal to the normal of the section plane that the ray meets. */
static void find_cap_normal(const struct clip *clip, const struct ray *ray, struct raycast_hit *hit)
{
    double least = INFINITY;
    for (int p = 0; p < clip->plane_count; p++) {
        double plane[4], height;
        clip_plane(clip, p, plane);
        height = plane[3] + vec_dot(plane, ray->origin) + hit->t * vec_dot(plane, ray->direction);
        if (fabs(height) >= least)
            continue;
        least = fabs(height);
        for (int i = 0; i < 3; i++)
            hit->normal[i] = -plane[i];
    }
}

void raycast(const struct scene *scene, const struct visibility *visibility, const struct ray *ray, struct raycast_hit *hit)
{
    double low = ray->low, high = ray->high;
    *hit = (struct raycast_hit){ .asset = -1 };
    if (!clip_ray(&visibility->clip, ray->origin, ray->direction, &low, &high))
        return;
    if (hits_cap(scene, visibility, ray, low, high, hit)) {
        find_cap_normal(&visibility->clip, ray, hit);
        return;
    }
    hit->asset = -1;
    double nearest = INFINITY;
    for (size_t i = 0; i < scene->asset_count; i++) {
        const struct scene_asset *asset = &scene->assets[i];
        struct raycast_search search = { .hit = hit, .asset = (int)i };
        if (visibility_of(visibility, (int)i) != ASSET_SHOWN ||
            !aim_at(&search, asset, ray, low, fmin(high, brought_back(ray, asset, nearest))))
            continue;
        search.cut = clip_touches(&visibility->clip, asset->bounds_min_m, asset->bounds_max_m);
        search_asset(&search);
        if (hit->asset == (int)i)
            nearest = brought_forward(ray, asset, hit->t);
    }
    if (hit->asset >= 0)
        find_normal(scene, ray, hit);
}
