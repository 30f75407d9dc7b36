/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Ray casting: the first hit of random rays is compared with that of a loop over all triangles of the plant. */
#include "scene/raycast.h"

#include "tests/support/test.h"

#include "tests/support/synthetic.h"
#include "tests/support/toy.h"

static struct toy *toy;
static uint64_t seed = 5;

static double between(double low, double high)
{
    return low + (high - low) * synthetic_random_unit(&seed);
}

static void corner(const struct scene_asset *asset, uint32_t vertex, double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = (double)asset->file->view.positions_m[vertex][i] + asset->placement[12 + i];
}

/* Reference for one triangle: solves origin + t direction = a + u (b - a) + v (c - a) by Cramer's rule. Returns whether the ray
   hits, with the distance *t and *facing, whose sign tells which side it hits. */
static bool slow_triangle(const struct ray *ray, const double a[3], const double b[3], const double c[3], double *t, double *facing)
{
    double m[3][4], ab[3], ac[3];
    for (int i = 0; i < 3; i++) {
        ab[i] = b[i] - a[i];
        ac[i] = c[i] - a[i];
        memcpy(m[i], (double[4]){ ab[i], ac[i], -ray->direction[i], ray->origin[i] - a[i] }, sizeof(m[i]));
    }
    double normal[3] = { ab[1] * ac[2] - ab[2] * ac[1], ab[2] * ac[0] - ab[0] * ac[2], ab[0] * ac[1] - ab[1] * ac[0] };
    *facing = -(normal[0] * ray->direction[0] + normal[1] * ray->direction[1] + normal[2] * ray->direction[2]);
#define DETERMINANT(x, y, z)                                                                                                               \
    (m[0][x] * (m[1][y] * m[2][z] - m[1][z] * m[2][y]) - m[0][y] * (m[1][x] * m[2][z] - m[1][z] * m[2][x]) +                               \
     m[0][z] * (m[1][x] * m[2][y] - m[1][y] * m[2][x]))
    double all = DETERMINANT(0, 1, 2), u = DETERMINANT(3, 1, 2) / all, v = DETERMINANT(0, 3, 2) / all;
    *t = DETERMINANT(0, 1, 3) / all;
    return all != 0 && u >= 0 && v >= 0 && u + v <= 1;
}

static double slow_raycast(const struct visibility *visibility, const struct ray *ray, int *asset)
{
    double best = INFINITY;
    *asset = -1;
    for (size_t i = 0; i < toy->scene.asset_count; i++) {
        const struct scene_asset *at = &toy->scene.assets[i];
        const struct asset_view *view = &at->file->view;
        bool cut = clip_touches(&visibility->clip, at->bounds_min_m, at->bounds_max_m);
        for (uint32_t k = 0; k < view->header->index_count && visibility_of(visibility, (int)i) == ASSET_SHOWN; k += 3) {
            double a[3], b[3], c[3], t, facing, place[3];
            corner(at, view->indices[k], a);
            corner(at, view->indices[k + 1], b);
            corner(at, view->indices[k + 2], c);
            if (!slow_triangle(ray, a, b, c, &t, &facing) || t < ray->low || t > ray->high || t >= best || (facing < 0 && !cut))
                continue;
            for (int c3 = 0; c3 < 3; c3++)
                place[c3] = ray->origin[c3] + t * ray->direction[c3];
            if (!clip_keeps(&visibility->clip, place))
                continue;
            best = t;
            *asset = (int)i;
        }
    }
    return best;
}

/* Returns how many closed bodies contain the ray's point at distance `from`: for each hit farther away, an exit counts 1 and an
   entry -1. */
static int slow_bodies(const struct visibility *visibility, const struct ray *ray, double from)
{
    int bodies = 0;
    for (size_t i = 0; i < toy->scene.asset_count; i++) {
        const struct scene_asset *at = &toy->scene.assets[i];
        const struct closed_bodies *closed = asset_closed(at->file, 0);
        if (visibility_of(visibility, (int)i) != ASSET_SHOWN || !clip_touches(&visibility->clip, at->bounds_min_m, at->bounds_max_m))
            continue;
        for (size_t r = 0; r < closed->run_count; r++)
            for (uint32_t k = 0; k < closed->runs[r].index_count; k += 3) {
                const uint32_t *corners = at->file->view.indices + closed->runs[r].first_index + k;
                double a[3], b[3], c[3], t, facing;
                corner(at, corners[0], a);
                corner(at, corners[1], b);
                corner(at, corners[2], c);
                if (slow_triangle(ray, a, b, c, &t, &facing) && t >= from)
                    bodies += facing < 0 ? 1 : -1;
            }
    }
    return bodies;
}

/* Where a section plane cuts a body, a cap closes it. Asserts that the ray hits a cap exactly if it enters the visible part
   inside a body, and at the right point. Returns whether it does. */
static bool agrees_on_cap(const struct visibility *visibility, const struct ray *ray, const struct raycast_hit *hit)
{
    double low = ray->low, high = ray->high, facing = 0;
    bool left = clip_ray(&visibility->clip, ray->origin, ray->direction, &low, &high) && low > ray->low;
    bool cap = left && slow_bodies(visibility, ray, low) > 0;
    bool hit_cap = hit->asset >= 0 && hit->weights[0] + hit->weights[1] + hit->weights[2] == 0;
    assert_int_equal(cap, hit_cap);
    if (!cap)
        return false;
    for (int i = 0; i < 3; i++)
        facing += hit->normal[i] * ray->direction[i];
    assert_true(hit->inside && hit->t == low && facing < 0);
    return true;
}

static void random_ray(struct ray *ray)
{
    struct camera camera = { .up = { 0, 0, 1 }, .fov_deg = 50, .height_m = synthetic_random_unit(&seed) < 0.3 ? 4 : 0 };
    for (int i = 0; i < 3; i++) {
        camera.target_m[i] = between(toy->scene.bounds_min_m[i], toy->scene.bounds_max_m[i]);
        camera.eye_m[i] = camera.target_m[i] + between(-5, 5);
    }
    ray_init(ray, &camera, 1.6, between(-1, 1), between(-1, 1));
}

static void random_visibility(struct visibility *visibility)
{
    *visibility = (struct visibility){ 0 };
    if (synthetic_random_unit(&seed) < 0.5)
        asset_set_add(&visibility->hidden, (int)(5 * synthetic_random_unit(&seed)));
    if (synthetic_random_unit(&seed) < 0.5)
        asset_set_add(&visibility->ghosts, (int)(5 * synthetic_random_unit(&seed)));
    if (synthetic_random_unit(&seed) < 0.5)
        clip_box(&visibility->clip, (double[3]){ between(-4, 1), between(-2, 0), between(-1, 1) },
                 (double[3]){ between(1.1, 6), between(0.1, 3), between(1.1, 4) });
}

TEST(rays_find_what_a_loop_finds)
{
    int hits = 0, insides = 0, caps = 0;
    for (int round = 0; round < 4000; round++) {
        struct visibility visibility;
        struct ray ray;
        struct raycast_hit hit;
        int asset;
        random_visibility(&visibility);
        random_ray(&ray);
        double t = slow_raycast(&visibility, &ray, &asset);
        raycast(&toy->scene, &visibility, &ray, &hit);
        if (agrees_on_cap(&visibility, &ray, &hit)) {
            caps++;
            continue;
        }
        assert_int_equal(hit.asset < 0, asset < 0);
        if (asset < 0)
            continue;
        hits++;
        insides += hit.inside;
        assert_float_equal(hit.t, t, 1e-6);
        double sum = 0, length = 0, towards = 0;
        for (int i = 0; i < 3; i++) {
            double place = 0, vertex[3];
            for (int k = 0; k < 3; k++) {
                corner(&toy->scene.assets[hit.asset], hit.corners[k], vertex);
                place += hit.weights[k] * vertex[i];
            }
            assert_float_equal(place, ray.origin[i] + hit.t * ray.direction[i], 1e-6);
            sum += hit.weights[i];
            length += hit.normal[i] * hit.normal[i];
            towards += hit.normal[i] * ray.direction[i];
        }
        assert_float_equal(sum, 1, 1e-9);
        assert_float_equal(length, 1, 1e-9);
        assert_true(towards <= 0);
    }
    print_message("# %d hits of 4000, %d of them inside; %d on planes that close bodies\n", hits, insides, caps);
    assert_true(hits > 150 && insides > 5 && caps > 10);
}

TEST(a_picture_of_rays_agrees_with_the_camera)
{
    struct camera camera = { .eye_m = { 8, -9, 6 }, .target_m = { 1, 1, 1 }, .up = { 0, 0, 1 }, .fov_deg = 40 };
    for (int parallel = 0; parallel < 2; parallel++) {
        camera.height_m = parallel * 7;
        for (int i = 0; i < 200; i++) {
            double x = between(-1, 1), y = between(-1, 1), view[16], projection[16], eye[4], clip[4] = { 0 }, t = between(1, 20);
            struct ray ray;
            ray_init(&ray, &camera, 1.5, x, y);
            camera_matrices(&camera, 1.5, toy->scene.bounds_min_m, toy->scene.bounds_max_m, view, projection);
            for (int row = 0; row < 4; row++) {
                eye[row] = view[12 + row];
                for (int c = 0; c < 3; c++)
                    eye[row] += view[4 * c + row] * (ray.origin[c] + t * ray.direction[c]);
            }
            for (int row = 0; row < 4; row++)
                for (int c = 0; c < 4; c++)
                    clip[row] += projection[4 * c + row] * eye[c];
            assert_float_equal(clip[0] / clip[3], x, 1e-9);
            assert_float_equal(clip[1] / clip[3], y, 1e-9);
            assert_float_equal(eye[2], -t, 1e-9);
        }
    }
}

static int set_up(void **state)
{
    (void)state;
    toy = toy_unit();
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    toy_destroy(&toy);
    return 0;
}

TEST_GROUP(set_up, tear_down)
