/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Levels of detail: nested, without cracks, within their stated errors, with vertices in the order that the asset file requires. */
#include "tests/support/test.h"

#include "base/math/vec.h"
#include "preprocess/levels/vertex_order.h"
#include "preprocess/geometry/welded_positions.h"
#include "surface/mesh/bvh.h"
#include "tests/support/geometry_case.h"

#define AROUND 120u /* AROUND: number of squares around the torus; TUBE: around its tube */
#define TUBE 48u
#define MAJOR_M 2.0
#define MINOR_M 0.5

struct set_of { /* fixture: geometry and its levels */
    struct geometry g;
    struct levels levels;
    struct welded_positions places;
};

static uint32_t add_vertex(struct geometry *g, double u, double v)
{
    uint32_t i = g->vertex_count++;
    double a = 2 * acos(-1) * u, b = 2 * acos(-1) * v, ring = MAJOR_M + MINOR_M * cos(b);
    g->positions_m[i][0] = (float)(ring * cos(a));
    g->positions_m[i][1] = (float)(ring * sin(a));
    g->positions_m[i][2] = (float)(MINOR_M * sin(b));
    g->normals[i][0] = (float)(cos(b) * cos(a));
    g->normals[i][1] = (float)(cos(b) * sin(a));
    g->normals[i][2] = (float)sin(b);
    return i;
}

/* Adds the squares `first` to `end` around a torus as one primitive with vertices of its own: where they meet others, positions
   occur twice. */
static void add_part(struct geometry *g, uint32_t first, uint32_t end, uint32_t material)
{
    uint32_t corner = g->vertex_count;
    g->primitives[g->primitive_count] = (struct asset_primitive){ .first_index = g->index_count, .material = material };
    for (uint32_t x = first; x <= end; x++)
        for (uint32_t y = 0; y <= TUBE; y++)
            add_vertex(g, (double)(x % AROUND) / AROUND, (double)(y % TUBE) / TUBE);
    for (uint32_t x = 0; x < end - first; x++)
        for (uint32_t y = 0; y < TUBE; y++) {
            uint32_t a = corner + x * (TUBE + 1) + y, b = a + TUBE + 1;
            const uint32_t six[6] = { a, b, b + 1, a, b + 1, a + 1 };
            memcpy(g->indices + g->index_count, six, sizeof(six));
            g->index_count += 6;
        }
    g->primitives[g->primitive_count].index_count = g->index_count - g->primitives[g->primitive_count].first_index;
    g->primitive_count++;
}

/* Makes a closed torus of two materials. */
static void begin(struct set_of *s)
{
    struct geometry *g = &s->g;
    size_t most = 2 * (AROUND + 2) * (TUBE + 1);
    geometry_begin(g, most, 2 * (size_t)AROUND * TUBE);
    g->primitive_count = 0;
    g->material_count = 2;
    add_part(g, 0, AROUND / 3, 0);
    add_part(g, AROUND / 3, AROUND, 1);
    assert_true(levels_make(&s->levels, g, NULL));
    assert_true(welded_init(&s->places, (const float(*)[3])g->positions_m, g->vertex_count));
}

static void end(struct set_of *s)
{
    levels_finish(&s->levels);
    welded_finish(&s->places);
    geometry_finish(&s->g);
}

TEST_FIXTURE(struct set_of, begin, end)

TEST_ON(const struct set_of *s, levels_grow_coarser, set_up, tear_down)
{
    assert_true(s->levels.count >= 4);
    assert_memory_equal(s->levels.at[0].indices, s->g.indices, s->g.index_count * sizeof(uint32_t));
    assert_float_equal(s->levels.at[0].error_m, 0, 0);
    for (size_t l = 1; l < s->levels.count; l++) {
        const struct level *level = &s->levels.at[l];
        print_message("# level %zu: %u triangles, error %.4f m\n", l, level->index_count / 3, (double)level->error_m);
        assert_true(level->index_count * 10 <= (level - 1)->index_count * 9);
        assert_true(level->index_count * 10 >= (level - 1)->index_count * 3);
        assert_true(level->error_m > 0 && level->error_m >= (level - 1)->error_m);
    }
    assert_true(s->levels.at[s->levels.count - 1].index_count < 3 * 200);
}

/* The error of each level is 1.4 times that of the next finer one, or 1.3 times 1.3 if the level between was left out because
   it would save hardly any triangles. */
TEST_ON(const struct set_of *s, levels_lie_close, set_up, tear_down)
{
    const double size_m = 2 * (MAJOR_M + MINOR_M) * sqrt(2);
    size_t pairs = 0;
    for (size_t l = 2; l < s->levels.count; l++) {
        double finer_m = (double)s->levels.at[l - 1].error_m, coarser_m = (double)s->levels.at[l].error_m;
        if (finer_m < 0.0007 * size_m || coarser_m > 0.008 * size_m)
            continue;
        assert_true(coarser_m <= 1.7 * finer_m);
        pairs++;
    }
    assert_true(pairs >= 6);
}

TEST_ON(const struct set_of *s, levels_are_nested, set_up, tear_down)
{
    char *used = test_memory(mem_array(s->g.vertex_count, 1));
    for (size_t l = 0; l + 1 < s->levels.count; l++) {
        memset(used, 0, s->g.vertex_count);
        for (uint32_t i = 0; i < s->levels.at[l].index_count; i++)
            used[s->levels.at[l].indices[i]] = 1;
        for (uint32_t i = 0; i < s->levels.at[l + 1].index_count; i++)
            assert_true(used[s->levels.at[l + 1].indices[i]]);
    }
}

/* In each level every edge belongs to two triangles, which traverse it in opposite directions: the torus is still closed. */
TEST_ON(const struct set_of *s, closed_stays_closed, set_up, tear_down)
{
    for (size_t l = 0; l < s->levels.count; l++) {
        const struct level *level = &s->levels.at[l];
        struct edge_table edges;
        int *faces = mem_array(level->index_count, sizeof(*faces)), *balance = mem_array(level->index_count, sizeof(*balance));
        edge_table_init(&edges, level->index_count);
        for (uint32_t i = 0; i < level->index_count; i++) {
            uint32_t a = s->places.of_vertex[level->indices[i]];
            uint32_t b = s->places.of_vertex[level->indices[i % 3 == 2 ? i - 2 : i + 1]];
            assert_int_not_equal(a, b);
            uint32_t e = edge_table_add(&edges, a, b);
            faces[e]++;
            balance[e] += a < b ? 1 : -1;
        }
        for (size_t e = 0; e < edges.count; e++)
            assert_true(faces[e] == 2 && balance[e] == 0);
        edge_table_finish(&edges);
        mem_free(faces);
        mem_free(balance);
    }
}

/* The torus's materials meet in two planes through its axis, and in each level their border must still lie there. */
TEST_ON(const struct set_of *s, materials_keep_their_border, set_up, tear_down)
{
    for (size_t l = 0; l < s->levels.count; l++) {
        const struct level *level = &s->levels.at[l];
        assert_int_equal(level->primitive_count, 2);
        for (uint32_t p = 0; p < 2; p++) {
            const struct asset_primitive *primitive = &level->primitives[p];
            assert_int_equal(primitive->material, p);
            for (uint32_t i = primitive->first_index; i < primitive->first_index + primitive->index_count; i++) {
                const float *at = s->g.positions_m[level->indices[i]];
                double turn = atan2((double)at[1], (double)at[0]) / (2 * acos(-1));
                turn += turn < -1e-6 ? 1 : 0;
                bool in_first = turn < 1.0 / 3 + 1e-5 || turn > 1 - 1e-5, in_second = turn > 1.0 / 3 - 1e-5 || turn < 1e-5;
                assert_true(p == 0 ? in_first : in_second);
            }
        }
    }
}

static double random_unit(uint32_t *seed)
{
    *seed = *seed * 1664525u + 1013904223u;
    return (*seed >> 8) / 16777216.0;
}

static double brute_distance(const struct set_of *s, const struct level *level, const double p[3])
{
    double best = INFINITY;
    for (uint32_t i = 0; i < level->index_count; i += 3) {
        double corners[3][3], w[3], at[3];
        for (int c = 0; c < 3; c++)
            for (int axis = 0; axis < 3; axis++)
                corners[c][axis] = (double)s->g.positions_m[level->indices[i + (uint32_t)c]][axis];
        triangle_nearest(p, corners[0], corners[1], corners[2], w);
        for (int axis = 0; axis < 3; axis++)
            at[axis] = w[0] * corners[0][axis] + w[1] * corners[1][axis] + w[2] * corners[2][axis];
        best = fmin(best, vec_distance(p, at));
    }
    return best;
}

/* Returns the largest distance of 300 random points of level `from` from level `to`. */
static double stray(const struct set_of *s, const struct level *from, const struct level *to, uint32_t *seed)
{
    double most = 0;
    for (int n = 0; n < 300; n++) {
        uint32_t i = 3 * (uint32_t)(random_unit(seed) * (from->index_count / 3));
        double a = random_unit(seed), b = random_unit(seed), p[3];
        if (a + b > 1) {
            a = 1 - a;
            b = 1 - b;
        }
        for (int axis = 0; axis < 3; axis++)
            p[axis] = (1 - a - b) * (double)s->g.positions_m[from->indices[i]][axis] +
                      a * (double)s->g.positions_m[from->indices[i + 1]][axis] + b * (double)s->g.positions_m[from->indices[i + 2]][axis];
        most = fmax(most, brute_distance(s, to, p));
    }
    return most;
}

TEST_ON(const struct set_of *s, error_is_a_bound, set_up, tear_down)
{
    uint32_t seed = 7;
    for (size_t l = 1; l < s->levels.count; l++) {
        double error_m = (double)s->levels.at[l].error_m;
        double there_m = stray(s, &s->levels.at[0], &s->levels.at[l], &seed), back_m = stray(s, &s->levels.at[l], &s->levels.at[0], &seed);
        print_message("# level %zu: error %.4f m, found %.4f m and %.4f m (seed 7)\n", l, error_m, there_m, back_m);
        assert_true(fmax(there_m, back_m) <= 1.05 * error_m);
        assert_true(fmax(there_m, back_m) >= 0.3 * error_m); /* the stated error is at most about three times the measured one */
    }
}

enum { LONE = 3 }; /* number of vertices added that belong to no triangle */

static void add_lone(struct geometry *g)
{
    size_t positions = g->vertex_count, normals = g->vertex_count;
    assert_true(!g->texcoords && !g->colors);
    mem_grow(&g->positions_m, &positions, g->vertex_count + LONE, sizeof(*g->positions_m));
    mem_grow(&g->normals, &normals, g->vertex_count + LONE, sizeof(*g->normals));
    for (int i = 0; i < LONE; i++) {
        memset(g->positions_m[g->vertex_count], 0, sizeof(*g->positions_m));
        memset(g->normals[g->vertex_count++], 0, sizeof(*g->normals));
    }
}

TEST_ON(struct set_of *s, a_level_is_a_prefix, set_up, tear_down)
{
    struct asset_level file[LEVELS_MAX];
    uint32_t *new_of, first_added = s->g.vertex_count - 5, count = s->g.vertex_count, primitives = 0;
    float(*before)[3] = mem_array(count, sizeof(*before));
    memcpy(before, s->g.positions_m, count * sizeof(*before));
    add_lone(&s->g);
    assert_true(vertex_order_apply(&s->g, &s->levels, first_added, file, &new_of));
    assert_int_equal(s->g.vertex_count, count);
    assert_int_equal(file[0].vertex_count, count);
    for (uint32_t v = count; v < count + LONE; v++)
        assert_int_equal(new_of[v], TRIMESH_NONE);
    for (uint32_t v = 0; v < count; v++)
        assert_memory_equal(before[v], s->g.positions_m[new_of[v]], sizeof(*before));
    for (size_t l = 0; l < s->levels.count; l++) {
        uint32_t coarser = l + 1 < s->levels.count ? file[l + 1].vertex_count : 0, highest = 0;
        assert_int_equal(file[l].first_primitive, primitives);
        primitives += file[l].primitive_count;
        for (uint32_t p = 0; p < file[l].primitive_count; p++) {
            const struct asset_primitive *primitive = &s->g.primitives[file[l].first_primitive + p];
            for (uint32_t i = 0; i < primitive->index_count; i++) {
                uint32_t v = s->g.indices[primitive->first_index + i];
                highest = v > highest ? v : highest;
                assert_int_equal(v, new_of[s->levels.at[l].indices[s->levels.at[l].primitives[p].first_index + i]]);
            }
        }
        assert_true(highest < file[l].vertex_count && coarser < file[l].vertex_count);
        assert_true(file[l].vertex_count < count || l == 0);
        assert_true(file[l].added_count <= file[l].vertex_count - coarser);
        for (uint32_t v = first_added; v < count; v++)
            if (new_of[v] >= coarser && new_of[v] < file[l].vertex_count)
                assert_true(new_of[v] >= file[l].vertex_count - file[l].added_count);
    }
    mem_free(before);
    mem_free(new_of);
}

/* --- parts ---------------------------------------------------------------------------------------------------------------- */

static void add_box(struct geometry *g, double x, double y, double z, double size_x, double size_y, double size_z)
{
    const double low[3] = { x, y, z }, size[3] = { size_x, size_y, size_z };
    for (int side = 0; side < 6; side++) {
        int axis = side / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
        uint32_t first = g->vertex_count;
        for (int corner = 0; corner < 4; corner++) {
            float *p = g->positions_m[g->vertex_count], *n = g->normals[g->vertex_count++];
            p[axis] = (float)(low[axis] + side % 2 * size[axis]);
            p[u] = (float)(low[u] + corner % 2 * size[u]);
            p[v] = (float)(low[v] + corner / 2 * size[v]);
            n[axis] = side % 2 ? 1 : -1;
        }
        const uint32_t out[6] = { 0, 1, 3, 0, 3, 2 }, in[6] = { 0, 3, 1, 0, 2, 3 };
        for (int i = 0; i < 6; i++)
            g->indices[g->index_count++] = first + (side % 2 ? out : in)[i];
    }
    g->primitives[0].index_count = g->index_count;
}

/* Returns the error of the finest level in which no triangle has a vertex with x > from_m, i.e. the parts beyond are gone;
   INFINITY if no level is without them. */
static double error_without(const struct geometry *g, const struct levels *levels, double from_m)
{
    for (size_t l = 0; l < levels->count; l++) {
        bool any = false;
        for (uint32_t i = 0; i < levels->at[l].index_count; i++)
            any |= (double)g->positions_m[levels->at[l].indices[i]][0] > from_m;
        if (!any)
            return (double)levels->at[l].error_m;
    }
    return INFINITY;
}

static size_t vertices_above(const struct geometry *g, const struct level *level, double from_m)
{
    size_t count = 0;
    for (uint32_t i = 0; i < level->index_count; i++)
        count += (double)g->positions_m[level->indices[i]][2] > from_m;
    return count;
}

/* 100 bolts on a slab of 10 m protrude by 2 cm: they must disappear in levels with an error of at least 2 cm, and not in finer
   ones. */
TEST(bolts_go_where_they_hardly_stand_out)
{
    struct geometry g;
    struct levels levels;
    geometry_begin(&g, 24 * 101, 12 * 101);
    add_box(&g, 0, 0, 0, 10, 10, 0.5);
    for (int i = 0; i < 100; i++)
        add_box(&g, 0.5 + i % 10, 0.5 + i / 10, 0.45, 0.05, 0.05, 0.07);
    assert_true(levels_make(&levels, &g, NULL));
    assert_true(levels.count >= 2);
    assert_int_equal(vertices_above(&g, &levels.at[levels.count - 1], 0.501), 0);
    for (size_t l = 0; l < levels.count; l++)
        if (vertices_above(&g, &levels.at[l], 0.501) < 100)
            assert_true((double)levels.at[l].error_m >= 0.0199);
    levels_finish(&levels);
    geometry_finish(&g);
}

/* Nuts on a slab protrude by 2 cm. A torus above gives the asset levels of every error, and levels with more than 2.2 cm must
   not contain nuts. */
TEST(nuts_go_once_they_stand_out_by_less)
{
    struct geometry g;
    struct levels levels;
    size_t with = 0, without = 0;
    geometry_begin(&g, 24 * (101 + AROUND * TUBE / 4), 12 * (101 + AROUND * TUBE / 4));
    g.primitive_count = 0;
    add_part(&g, 0, AROUND, 0);
    add_box(&g, -5, -5, -1.5, 10, 10, 0.5);
    for (int i = 0; i < 100; i++)
        add_box(&g, -4.5 + i % 10, -4.5 + i / 10, -1.01, 0.05, 0.05, 0.03);
    assert_true(levels_make(&levels, &g, NULL));
    for (size_t l = 0; l < levels.count; l++) {
        bool any = vertices_above(&g, &levels.at[l], -0.99) > vertices_above(&g, &levels.at[l], -0.9);
        double error_m = (double)levels.at[l].error_m;
        print_message("# level %zu: error %.4f m, %s nuts\n", l, error_m, any ? "with" : "without");
        assert_true(any ? error_m <= 0.0221 : error_m >= 0.0199);
        with += any;
        without += !any;
    }
    assert_true(with > 1 && without > 0);
    levels_finish(&levels);
    geometry_finish(&g);
}

/* A small block of 5 cm, 20 m from the rest, disappears in levels whose error is at least its size. Many bars of that size,
   side by side as a grating, must stay. */
TEST(what_is_alone_and_small_goes_but_no_crowd)
{
    struct geometry g;
    struct levels levels;
    geometry_begin(&g, 24 * 402, 12 * 402);
    add_box(&g, 0, 0, 0, 10, 2, 2);
    add_box(&g, 30, 0, 0, 0.05, 0.05, 0.05);
    assert_true(levels_make(&levels, &g, NULL));
    double alone_m = error_without(&g, &levels, 20);
    assert_true(isinf(alone_m) || alone_m >= 0.0865); /* INFINITY: with so few triangles no coarser level was made, which is allowed */
    levels_finish(&levels);
    for (int i = 0; i < 400; i++)
        add_box(&g, 40 + 0.1 * (i % 20), 0.1 * (i / 20), 1, 0.05, 0.05, 0.05);
    assert_true(levels_make(&levels, &g, NULL));
    /* the grating of small bars disappears only in levels whose error is at least the grating's size */
    assert_true(error_without(&g, &levels, 39.9) >= 2.75);
    alone_m = INFINITY;
    for (size_t l = 0; l < levels.count; l++) {
        bool any = false;
        for (uint32_t i = 0; i < levels.at[l].index_count; i++) {
            double x = (double)g.positions_m[levels.at[l].indices[i]][0];
            any |= x > 20 && x < 35;
        }
        assert_true(any || (double)levels.at[l].error_m >= 0.0865);
    }
    levels_finish(&levels);
    geometry_finish(&g);
}

/* Counts corners of triangles whose vertex normal points to the triangle's back: they would be lit from the wrong side. */
static size_t looking_away(const struct geometry *g, const struct level *level)
{
    size_t count = 0;
    for (uint32_t i = 0; i < level->index_count; i++) {
        const uint32_t *v = level->indices + i / 3 * 3;
        double at[3][3], n[3], u[3], w[3], dot = 0;
        for (int c = 0; c < 3; c++)
            for (int axis = 0; axis < 3; axis++)
                at[c][axis] = (double)g->positions_m[v[c]][axis];
        for (int axis = 0; axis < 3; axis++) {
            u[axis] = at[1][axis] - at[0][axis];
            w[axis] = at[2][axis] - at[0][axis];
        }
        for (int axis = 0; axis < 3; axis++) {
            n[axis] = u[(axis + 1) % 3] * w[(axis + 2) % 3] - u[(axis + 2) % 3] * w[(axis + 1) % 3];
            dot += n[axis] * (double)g->normals[level->indices[i]][axis];
        }
        count += dot < -0.5 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    }
    return count;
}

/* Thin plates must keep an upper and a lower face with vertices of their own, even in levels whose error exceeds the plates'
   thickness. */
TEST(thin_plates_keep_their_sides)
{
    struct set_of s = { 0 };
    uint32_t seed = 11;
    size_t thinner = 0;
    geometry_begin(&s.g, 24 * 60, 12 * 60);
    for (int i = 0; i < 60; i++)
        add_box(&s.g, 1.02 * (i % 10), 1.02 * (i / 10), 0.001 * i, 1, 1, 0.02 + 0.001 * (i % 7));
    assert_true(levels_make(&s.levels, &s.g, NULL));
    for (size_t l = 1; l < s.levels.count; l++) {
        const struct level *level = &s.levels.at[l];
        double stray_m = fmax(stray(&s, &s.levels.at[0], level, &seed), stray(&s, level, &s.levels.at[0], &seed));
        print_message("# level %zu: %u triangles, error %.4f m, found %.4f m (seed 11)\n", l, level->index_count / 3,
                      (double)level->error_m, stray_m);
        assert_int_equal(looking_away(&s.g, level), 0);
        assert_true(stray_m <= (double)level->error_m);
        thinner += level->error_m >= 0.0199f;
    }
    assert_true(thinner > 0);
    void *of_plates = &s;
    levels_are_nested(&of_plates);
    levels_finish(&s.levels);
    geometry_finish(&s.g);
}
