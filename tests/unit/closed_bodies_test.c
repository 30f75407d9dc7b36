/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tests which bodies of a model count as closed: those without holes whose triangles all face the same way. Gaps from rounding
   are permitted; bodies of glass never count. */
#include "scene/closed_bodies.h"

#include "tests/support/test.h"

#include "tests/support/no_textures.h"
#include "tests/support/shape.h"
#include "tests/support/toy.h"

enum { BOX = 192 }; /* triangles of shape_box */
static const double low[3] = { -1, -1, -1 }, high[3] = { 1, 1, 1 };

/* Makes an asset of the shape, which it then owns. Returns how many triangles belong to closed bodies. */
static uint32_t closed_triangles(struct test_shape *shape)
{
    struct toy *toy = toy_create();
    int asset = toy_add(toy, "A", shape, (double[3]){ 0 }, NULL, 0);
    const struct closed_bodies *closed = asset_closed(toy->scene.assets[asset].file, 0);
    uint32_t indices = 0, end = 0;
    for (size_t i = 0; i < closed->run_count; i++) {
        /* runs are ranges of indices; two that adjoin must have been merged into one */
        assert_true(closed->runs[i].index_count > 0 && (i == 0 || closed->runs[i].first_index > end));
        end = closed->runs[i].first_index + closed->runs[i].index_count;
        indices += closed->runs[i].index_count;
    }
    assert_ptr_equal(closed, asset_closed(toy->scene.assets[asset].file, 0)); /* found once */
    toy_destroy(&toy);
    return indices / 3;
}

TEST(test_a_box_is_closed)
{
    struct test_shape shape = { 0 };
    /* each side of the box has its own vertices, so they must be welded before the box counts as closed */
    shape_box(&shape, TOY_STEEL, low, high);
    assert_int_equal(closed_triangles(&shape), BOX);
}

TEST(test_what_has_a_hole_is_not)
{
    for (uint32_t gone = 0; gone < BOX; gone += 17) {
        struct test_shape shape = { 0 };
        shape_box(&shape, TOY_STEEL, low, high);
        memmove(shape.indices + 3 * gone, shape.indices + 3 * gone + 3, (3 * (BOX - 1) - 3 * gone) * sizeof(*shape.indices));
        shape.index_count -= 3;
        shape.primitives[0].index_count -= 3;
        assert_int_equal(closed_triangles(&shape), 0);
    }
}

/* Gaps of some micrometres between sides, as rounding leaves them, still count as closed; gaps of some millimetres do not. */
TEST(test_seams_may_gape_by_rounding)
{
    for (int wide = 0; wide < 2; wide++) {
        struct test_shape shape = { 0 };
        shape_box(&shape, TOY_STEEL, low, high);
        for (size_t i = 0; i < shape.vertex_count; i++)
            for (int c = 0; c < 3; c++)
                shape.positions[i][c] += (wide ? 1e-3f : 4e-6f) * (float)((i * 7 + (size_t)c * 3) % 3);
        assert_int_equal(closed_triangles(&shape), wide ? 0 : BOX);
    }
}

TEST(test_what_is_turned_round_in_part_is_not)
{
    struct test_shape shape = { 0 };
    shape_box(&shape, TOY_STEEL, low, high);
    uint32_t first = shape.indices[0];
    shape.indices[0] = shape.indices[1];
    shape.indices[1] = first;
    assert_int_equal(closed_triangles(&shape), 0);
}

TEST(test_bodies_are_judged_one_by_one)
{
    struct test_shape shape = { 0 };
    shape_box(&shape, TOY_STEEL, low, high);
    shape_plate(&shape, TOY_BLUE, (double[3]){ 3, 3, 3 }, (double[3]){ 1, 0, 0 }, (double[3]){ 0, 1, 0 }, 2);
    shape_box(&shape, TOY_CONCRETE, (double[3]){ 5, 5, 5 }, (double[3]){ 6, 6, 6 });
    /* this box touches the first one along a whole side, which must not make either count as open */
    shape_box(&shape, TOY_CONCRETE, (double[3]){ 1, -1, -1 }, (double[3]){ 2, 1, 1 });
    assert_int_equal(closed_triangles(&shape), 3 * BOX);
}

TEST(test_glass_bounds_nothing)
{
    const struct asset_material glass = { .base_color = { 1, 1, 1, 0.3f },
                                          .alpha = ASSET_ALPHA_BLEND,
                                          NO_TEXTURES };
    struct test_shape shape = { .materials = &glass, .material_count = 1 };
    shape_box(&shape, 0, low, high);
    assert_int_equal(closed_triangles(&shape), 0);
}
