/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The number of triangles to which a level must be subdivided, estimated from a sample of its triangles. */
#include "tests/support/test.h"

#include "preprocess/subdivision/subdivide_impl.h"
#include "tests/support/surface_case.h"

#define BLOCK 8u
#define TRIANGLES 24000u
#define PARTS 3u

/* Makes a level of unconnected triangles: triangle t has the vertices 3 t to 3 t + 2. */
static void make_level(struct level *level)
{
    *level = (struct level){ .index_count = 3 * TRIANGLES, .primitive_count = PARTS };
    level->indices = mem_array(level->index_count, sizeof(*level->indices));
    level->primitives = mem_array(PARTS, sizeof(*level->primitives));
    for (uint32_t i = 0; i < level->index_count; i++)
        level->indices[i] = i;
    for (uint32_t p = 0; p < PARTS; p++) {
        uint32_t first = p * (TRIANGLES / PARTS) + (p ? 3 : 0), end = p + 1 == PARTS ? TRIANGLES : (p + 1) * (TRIANGLES / PARTS) + 3;
        level->primitives[p] = (struct asset_primitive){ .first_index = 3 * first, .index_count = 3 * (end - first), .material = p };
    }
}

TEST(a_sample_is_some_neighbours_of_every_part)
{
    struct level level, sample;
    make_level(&level);
    size_t blocks = subdiv_take_sample(&sample, &level);
    assert_int_equal(sample.index_count, 3 * BLOCK * blocks);
    assert_in_range(blocks, TRIANGLES / BLOCK / 11, TRIANGLES / BLOCK / 6);
    assert_int_equal(sample.primitive_count, PARTS);
    for (uint32_t p = 0; p < PARTS; p++) {
        const struct asset_primitive *of = &level.primitives[p], *from = &sample.primitives[p];
        assert_int_equal(from->material, p);
        assert_in_range(from->index_count, of->index_count / 14, of->index_count / 5);
        for (uint32_t i = 0; i < from->index_count; i++) {
            uint32_t v = sample.indices[from->first_index + i];
            assert_in_range(v, of->first_index, of->first_index + of->index_count - 1);
            assert_true(i % (3 * BLOCK) == 0 || v == sample.indices[from->first_index + i - 1] + 1);
        }
    }
    level_finish(&level);
    level_finish(&sample);
}

/* Prepares a subdivision with three edges for each triangle of the level. errors: by triangle, the error of its edges as a
   multiple of the allowed error. */
static void take_in_hand(struct subdiv *split, const struct level *level, const float *errors)
{
    size_t count = level->index_count / 3;
    split->mesh.tri_count = count;
    split->mesh.tris = mem_array(count, sizeof(*split->mesh.tris));
    split->mesh.cuts = mem_array(3 * count, sizeof(*split->mesh.cuts));
    for (uint32_t t = 0; t < count; t++) {
        split->mesh.tris[t].origin = t;
        for (uint32_t i = 0; i < 3; i++) {
            split->mesh.tris[t].e[i] = 3 * t + i;
            split->mesh.cuts[3 * t + i].error = (float)SUBDIV_AIM * errors[level->indices[3 * t] / 3];
        }
    }
}

static bool comes_to(struct subdiv *split, double most)
{
    split->most_tris = (size_t)most;
    return subdiv_will_exceed_bound(split);
}

static void release(struct subdiv *split)
{
    mem_free(split->mesh.tris);
    mem_free(split->mesh.cuts);
}

/* Halving an edge divides its error by four, so an edge with e times the allowed error must be halved ceil(log4(e)) times. The
   estimate must agree with the number of triangles that results. */
TEST(a_sample_says_what_the_level_needs)
{
    struct level level, sample;
    float *errors = test_memory(mem_array(TRIANGLES, sizeof(*errors)));
    double needed = 0;
    make_level(&level);
    for (uint32_t t = 0; t < TRIANGLES; t++) {
        errors[t] = (float)exp(7 * cad_random(&chance) - 2);
        needed += 1 + 3 * (errors[t] > 1 ? ceil(log((double)errors[t]) / log(4)) : 0);
    }
    size_t blocks = subdiv_take_sample(&sample, &level);
    const struct subdiv_input alone = { .workers = NULL };
    struct subdiv whole = { .in = &alone }, part = { .sample_blocks = blocks, .sample_of = (double)level.index_count / sample.index_count };
    take_in_hand(&whole, &level, errors);
    take_in_hand(&part, &sample, errors);
    assert_true(comes_to(&whole, needed - 100));
    assert_false(comes_to(&whole, needed + 100));
    /* the estimate from a sample must exceed 85 % of the real need, but not 110 %: a margin for chance is subtracted */
    assert_true(comes_to(&part, 0.85 * needed));
    assert_false(comes_to(&part, 1.1 * needed));
    whole.finest = true;
    assert_false(comes_to(&whole, needed - 100));
    release(&whole);
    release(&part);
    level_finish(&level);
    level_finish(&sample);
}

/* In the sample, a single triangle has a huge error. That says nothing about the triangles outside the sample, so the estimate
   must not make preparation give up the level. */
TEST(a_sample_is_not_sure_of_what_one_triangle_needs)
{
    struct level level, sample;
    float *errors = test_memory(mem_array(TRIANGLES, sizeof(*errors)));
    make_level(&level);
    size_t blocks = subdiv_take_sample(&sample, &level);
    struct subdiv part = { .sample_blocks = blocks, .sample_of = (double)level.index_count / sample.index_count };
    take_in_hand(&part, &sample, errors);
    assert_true(comes_to(&part, 0.9 * TRIANGLES));
    release(&part);
    take_in_hand(&part, &sample, errors);
    for (uint32_t t = 0; t < part.mesh.tri_count; t++)
        part.mesh.tris[t].origin = 0; /* makes all triangles count as pieces of the same original triangle */
    assert_false(comes_to(&part, 0.9 * TRIANGLES));
    release(&part);
    level_finish(&level);
    level_finish(&sample);
}

TEST_GROUP(surface_case_set_up, surface_case_tear_down)
