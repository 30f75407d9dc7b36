/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Assets whose faces coincide: which of the two is in front, and that picking hits the same one as pictures show. */
#include "scene/coincident.h"

#include "tests/support/test.h"

#include "scene/raycast.h"
#include "tests/support/toy.h"

static const double HERE[3] = { 0, 0, 0 }, SENSOR[1][3] = { { 0.5, 0.5, 1 } };

static int add_box(struct toy *toy, const char *id, double low_x, double low_y, double low_z, double high_x, double high_y, double high_z,
                   size_t sensor_count)
{
    struct test_shape shape = { 0 };
    shape_box(&shape, TOY_STEEL, (double[]){ low_x, low_y, low_z }, (double[]){ high_x, high_y, high_z });
    return toy_add(toy, id, &shape, HERE, SENSOR, sensor_count);
}

TEST(earlier_ones_are_seen)
{
    struct toy *toy = toy_create();
    int first = add_box(toy, "A", 0, 0, 0, 1, 1, 1, 0), second = add_box(toy, "B", 0.2, 0.1, 0, 3, 0.9, 1, 0);
    int third = add_box(toy, "C", 2, 0, 0.5, 4, 1, 1, 0), alone = add_box(toy, "D", 0, 0, 1.5, 1, 1, 2.5, 0);
    coincident_find(&toy->scene);
    assert_true(toy->scene.assets[first].front > toy->scene.assets[second].front);
    assert_true(toy->scene.assets[second].front > toy->scene.assets[third].front);
    assert_int_equal(toy->scene.assets[third].front, 0);
    assert_int_equal(toy->scene.assets[alone].front, 0);
    toy_destroy(&toy);
}

TEST(those_with_sensors_are_seen)
{
    struct toy *toy = toy_create();
    int context = add_box(toy, "A", 0, 0, 0, 1, 1, 1, 0), measured = add_box(toy, "B", 0, 0, 0, 1, 1, 2, 1);
    coincident_find(&toy->scene);
    assert_true(toy->scene.assets[measured].front > toy->scene.assets[context].front);
    toy_destroy(&toy);
}

/* Assets that intersect or lie 2 mm in front of each other have no coincident faces, so depth alone decides which one is
   visible. */
TEST(others_do_not_coincide)
{
    static const double low[3][3] = { { 1, 0, 0 }, { 0.5, 0.5, 0.5 }, { 0.2, 0.2, 0.2 } };
    static const double high[3][3] = { { 2, 1, 1 }, { 1.5, 1.5, 1.5 }, { 0.8, 0.8, 1.002 } };
    for (int i = 1; i < 3; i++) {
        struct toy *toy = toy_create();
        add_box(toy, "A", 0, 0, 0, 1, 1, 1, 0);
        add_box(toy, "B", low[i][0], low[i][1], low[i][2], high[i][0], high[i][1], high[i][2], 0);
        coincident_find(&toy->scene);
        assert_int_equal(toy->scene.assets[0].front, 0);
        assert_int_equal(toy->scene.assets[1].front, 0);
        toy_destroy(&toy);
    }
}

/* Rays from many directions hit a face that two assets share: the hit asset must be the one that pictures show, whichever asset
   comes first in the plant. */
TEST(rays_hit_what_is_seen)
{
    for (int parallel = 0; parallel < 2; parallel++)
        for (int with_sensor = 0; with_sensor < 2; with_sensor++) {
            struct toy *toy = toy_create();
            add_box(toy, "A", 0, 0, 0, 1, 1, 1, with_sensor == 0);
            add_box(toy, "B", 0, 0, 0, 1, 1, 1, with_sensor == 1);
            coincident_find(&toy->scene);
            for (int i = 0; i < 100; i++) {
                struct camera camera = { .eye_m = { i % 10 - 4.37, i / 10 - 4.41, 3 },
                                         .target_m = { 0.13 + 0.07 * (i / 10), 0.11 + 0.08 * (i % 10), 1 },
                                         .up = { 0, 1, 0.1 },
                                         .fov_deg = 40,
                                         .height_m = parallel ? 2 : 0 };
                struct visibility visibility = { 0 };
                struct raycast_hit hit;
                struct ray ray;
                ray_init(&ray, &camera, 1.6, 0, 0);
                raycast(&toy->scene, &visibility, &ray, &hit);
                assert_int_equal(hit.asset, with_sensor);
                assert_float_equal(ray.origin[2] + hit.t * ray.direction[2], 1, 1e-6);
            }
            toy_destroy(&toy);
        }
}
