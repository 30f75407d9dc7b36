/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Splitting a mesh into clusters that can be culled: each triangle must be in one cluster, clusters must be small, and seen
   from outside about as many as expected must be culled. The mesh is a torus of two materials. */
#include "preprocess/levels/clusters.h"

#include "tests/support/test.h"

#define AROUND 120u
#define ALONG 60u

static void make_torus(struct geometry *g)
{
    const double turn = 2 * acos(-1);
    *g = (struct geometry){ .vertex_count = AROUND * ALONG, .index_count = 6 * AROUND * ALONG, .primitive_count = 3 };
    g->positions_m = mem_array(g->vertex_count, sizeof(*g->positions_m));
    g->indices = mem_array(g->index_count, sizeof(*g->indices));
    g->primitives = mem_array(3, sizeof(*g->primitives));
    g->primitives[0] = (struct asset_primitive){ .index_count = 6 * ALONG * 40 };
    g->primitives[1] = (struct asset_primitive){ .first_index = 6 * ALONG * 40, .index_count = 6 * ALONG * 79 };
    g->primitives[2] = (struct asset_primitive){ .first_index = 6 * ALONG * 119, .index_count = 6 * ALONG };
    for (uint32_t i = 0; i < AROUND; i++)
        for (uint32_t j = 0; j < ALONG; j++) {
            double a = turn * i / AROUND, b = turn * j / ALONG, r = 3 + cos(b);
            uint32_t v = i * ALONG + j, right = (i + 1) % AROUND * ALONG + j, up = i * ALONG + (j + 1) % ALONG;
            const uint32_t corners[6] = { v, right, right - j + (j + 1) % ALONG, v, right - j + (j + 1) % ALONG, up };
            const float at[3] = { (float)(r * cos(a)), (float)(r * sin(a)), (float)sin(b) };
            memcpy(g->positions_m[v], at, sizeof(at));
            memcpy(g->indices + 6 * v, corners, sizeof(corners));
        }
}

/* Makes the clusters of g's finest level. The positions given to clusters_begin() are overwritten while it works: it must not
   read them any more by then. */
static void make_clusters(struct geometry *g, struct workers *workers, struct clusters *clusters)
{
    const struct level level = {
        .indices = g->indices, .primitives = g->primitives, .index_count = g->index_count, .primitive_count = g->primitive_count
    };
    float(*positions_m)[3] = mem_array(g->vertex_count, sizeof(*positions_m));
    memcpy(positions_m, g->positions_m, g->vertex_count * sizeof(*positions_m));
    struct clusters_making *making = clusters_begin(workers, &level, (const float(*)[3])positions_m, g->vertex_count);
    memset(positions_m, 0, g->vertex_count * sizeof(*positions_m));
    mem_free(positions_m);
    *clusters = (struct clusters){ 0 };
    clusters_end(&making, 0, clusters);
    assert_null(making);
}

static int by_bytes(const void *a, const void *b)
{
    return memcmp(a, b, 3 * sizeof(uint32_t));
}

/* Returns a primitive's triangles in canonical order: each begins with its lowest corner, and the triangles are sorted. */
static uint32_t *in_order(const struct geometry *g, const struct asset_primitive *p)
{
    uint32_t *triangles = mem_array(p->index_count, sizeof(*triangles));
    for (uint32_t i = 0; i < p->index_count; i += 3) {
        const uint32_t *v = g->indices + p->first_index + i;
        uint32_t least = v[0] < v[1] && v[0] < v[2] ? 0 : v[1] < v[2] ? 1 : 2;
        for (uint32_t c = 0; c < 3; c++)
            triangles[i + c] = v[(least + c) % 3];
    }
    qsort(triangles, p->index_count / 3, 3 * sizeof(*triangles), by_bytes);
    return triangles;
}

TEST(no_triangle_is_lost)
{
    struct workers *workers = test_workers(2);
    for (int threaded = 0; threaded < 2; threaded++) {
        struct geometry g;
        struct clusters clusters;
        uint32_t *before[3], next = 0;
        make_torus(&g);
        for (int p = 0; p < 3; p++)
            before[p] = in_order(&g, &g.primitives[p]);
        make_clusters(&g, threaded ? workers : NULL, &clusters);
        for (int p = 0; p < 3; p++) {
            uint32_t *after = in_order(&g, &g.primitives[p]);
            assert_memory_equal(before[p], after, g.primitives[p].index_count * sizeof(*after));
            for (uint32_t at = 0; at < g.primitives[p].index_count; next++) {
                assert_int_equal(clusters.at[next].first_index, g.primitives[p].first_index + at);
                assert_in_range(clusters.at[next].index_count, 3, 3 * CLUSTERS_MAX_TRIANGLES);
                at += clusters.at[next].index_count;
            }
            mem_free(after);
            mem_free(before[p]);
        }
        assert_int_equal(next, clusters.count);
        clusters_finish(&clusters);
        geometry_finish(&g);
    }
}

/* The camera is 20 m away from a torus 8 m wide. */
TEST(views_leave_out_much)
{
    struct geometry g;
    struct clusters clusters;
    double half_m = 0;
    make_torus(&g);
    make_clusters(&g, NULL, &clusters);
    for (uint32_t c = 0; c < clusters.count; c++)
        for (int axis = 0; axis < 3; axis++)
            half_m += (double)(clusters.at[c].high_m[axis] - clusters.at[c].low_m[axis]) / 6 / clusters.count;
    uint32_t left_out = 0, backs = 0;
    const float eye_m[3] = { 0, 12, 16 };
    for (uint32_t c = 0; c < clusters.count; c++)
        left_out += asset_cluster_turned_away(&clusters.at[c], eye_m) ? clusters.at[c].index_count / 3 : 0;
    for (uint32_t i = 0; i < g.index_count; i += 3) {
        struct asset_cluster one = { .first_index = i, .index_count = 3 };
        asset_cluster_measure(&one, (const float(*)[3])g.positions_m, g.indices);
        backs += asset_cluster_turned_away(&one, eye_m);
    }
    print_message("# %u clusters, half %.2f m wide; %u of %u backs left out\n", clusters.count, half_m, left_out, backs);
    assert_in_range(clusters.count, g.index_count / 3 / CLUSTERS_MAX_TRIANGLES, g.index_count / 3 / CLUSTERS_MAX_TRIANGLES * 2);
    assert_true(half_m < 0.9);
    assert_true(left_out > backs / 3);
    clusters_finish(&clusters);
    geometry_finish(&g);
}
