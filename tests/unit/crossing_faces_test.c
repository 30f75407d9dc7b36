/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The search for faces that may cross others: it must report every face for which sampling finds a crossing, and few other
   faces. */
#include "surface/repair/crossing_faces.h"

#include "tests/support/test.h"

#include "base/math/vec.h"
#include "surface/mesh/bvh.h"
#include "tests/support/surface_case.h"

#define AROUND 12
#define RINGS 24
#define MOST_FACES 60

struct crossing_model {
    float at[AROUND * RINGS][3];
    uint32_t corners[6 * AROUND * RINGS], vertex_point[AROUND * RINGS];
    size_t vertex_count, triangle_count;
    struct trimesh mesh;
    struct body_parts parts;
};

static void model_join(struct crossing_model *model, double tolerance_m)
{
    size_t degenerate = 0, repeated = 0;
    assert_true(
        trimesh_weld(&model->mesh,
                     &(struct trimesh_model){ (const float(*)[3])model->at, model->vertex_count, model->corners, model->triangle_count },
                     1e-6, model->vertex_point, &degenerate, &repeated));
    parts_init(&model->parts, &model->mesh, model->triangle_count, tolerance_m, true);
    trimesh_stop_counting(&model->mesh);
}

static void model_finish(struct crossing_model *model)
{
    parts_finish(&model->parts);
    trimesh_finish(&model->mesh);
}

/* A pipe coiled with a radius of 1 m that rises rise_m per turn: it intersects itself if it rises by less than its width. */
static void make_coil(struct crossing_model *model, double radius_m, double rise_m, double turns)
{
    *model = (struct crossing_model){ 0 };
    for (int r = 0; r < RINGS; r++)
        for (int a = 0; a < AROUND; a++) {
            double turn = 2 * M_PI * turns * r / (RINGS - 1), angle = 2 * M_PI * a / AROUND, out = 1 + radius_m * cos(angle);
            float *p = model->at[model->vertex_count++];
            p[0] = (float)(out * cos(turn));
            p[1] = (float)(out * sin(turn));
            p[2] = (float)(radius_m * sin(angle) + rise_m * turn / (2 * M_PI));
        }
    for (uint32_t r = 0; r + 1 < RINGS; r++)
        for (uint32_t a = 0; a < AROUND; a++) {
            uint32_t p = r * AROUND + a, q = r * AROUND + (a + 1) % AROUND;
            memcpy(model->corners + 3 * model->triangle_count, (const uint32_t[6]){ p, q, p + AROUND, q, q + AROUND, p + AROUND },
                   6 * sizeof(uint32_t));
            model->triangle_count += 2;
        }
    model_join(model, 1e-3);
}

static size_t count_flagged(const struct crossing_model *model, const char *crosses)
{
    size_t count = 0;
    for (size_t t = 0; crosses && t < model->triangle_count; t++)
        count += crosses[t] != 0;
    return count;
}

TEST(a_pipe_that_winds_past_itself_has_none)
{
    struct crossing_model *model = mem_new(sizeof(*model));
    for (int n = 0; n < 50; n++) {
        double radius_m = between(0.02, 0.4);
        make_coil(model, radius_m, between(2.1, 4) * radius_m, between(0.2, 2));
        assert_null(crossing_faces_find(&model->parts));
        model_finish(model);
    }
    mem_free(model);
}

TEST(a_pipe_that_winds_into_itself_has_some)
{
    struct crossing_model *model = mem_new(sizeof(*model));
    make_coil(model, 0.2, 0.3, 1.25); /* the coil's last quarter turn overlaps its first */
    char *crosses = test_memory(crossing_faces_find(&model->parts));
    assert_in_range(count_flagged(model, crosses), 20, model->triangle_count / 2);
    for (size_t t = model->triangle_count * 2 / 5; t < model->triangle_count * 3 / 5; t++)
        assert_int_equal(crosses[t], 0);
    model_finish(model);
    mem_free(model);
}

/* Returns whether the edge of a triangle of part `own` crosses the triangle `tri`, by the rule of repair.h that
   crossing_faces_find() must follow. */
static bool piece_crosses(const struct crossing_model *model, const uint32_t edge[2], uint32_t own, uint32_t tri)
{
    const struct trimesh *mesh = &model->mesh;
    const double *p = mesh->points[edge[0]], *q = mesh->points[edge[1]], *reach_m = model->parts.reach_m;
    const uint32_t *v = mesh->tris[tri], part = model->parts.of_source[mesh->tri_source[tri]];
    double t, w[3], n[3], up[3], length = vec_distance(p, q), end_m = min_of(reach_m[own], reach_m[part]);
    for (int i = 0; i < 3 && own == part; i++)
        if (v[i] == edge[0] || v[i] == edge[1])
            return false;
    if (!triangle_crossed(p, q, mesh->points[v[0]], mesh->points[v[1]], mesh->points[v[2]], &t, w) || fmin(t, 1 - t) * length < end_m)
        return false;
    vec_normal(mesh->points[v[0]], mesh->points[v[1]], mesh->points[v[2]], n);
    for (int i = 0; i < 2 && own == part; i++) {
        vec_sub(i ? q : p, mesh->points[v[0]], up);
        if (fabs(vec_dot(up, n)) < CROSSING_CLEAR * reach_m[own] * vec_length(n))
            return false;
    }
    return true;
}

/* Makes many random triangles on a few points, so that triangles share corners and sides, overlap and cross. */
static void make_tangle(struct crossing_model *model, uint32_t points, double flatness)
{
    *model = (struct crossing_model){ .vertex_count = points, .triangle_count = (size_t)between(4, MOST_FACES) };
    for (uint32_t p = 0; p < points; p++)
        for (int axis = 0; axis < 3; axis++)
            model->at[p][axis] = (float)(between(-1, 1) * (axis == 2 ? flatness : 1));
    for (size_t c = 0; c < 3 * model->triangle_count; c++)
        model->corners[c] = (uint32_t)between(0, points - 1e-6);
    model_join(model, 1e-3);
}

/* Counts how often the edges of the sampled triangle `piece` cross other sampled triangles. */
static size_t count_crossings(const struct crossing_model *model, size_t piece)
{
    const struct trimesh *mesh = &model->mesh;
    size_t count = 0;
    for (uint32_t other = 0; other < mesh->tri_count; other++)
        for (int i = 0; i < 3; i++) {
            const uint32_t edge[2] = { mesh->tris[piece][i], mesh->tris[piece][(i + 1) % 3] };
            count += piece_crosses(model, edge, model->parts.of_source[mesh->tri_source[piece]], other);
        }
    return count;
}

TEST(no_crossing_of_pieces_is_missed)
{
    struct crossing_model *model = mem_new(sizeof(*model));
    size_t found = 0, flagged = 0, all = 0;
    for (int n = 0; n < sweep(400, 60); n++) {
        make_tangle(model, (uint32_t)between(5, 40), pow(10, between(-6, 0)));
        char *crosses = test_memory(crossing_faces_find(&model->parts));
        trimesh_sample(&model->mesh, between(0.15, 0.6), 4000);
        flagged += count_flagged(model, crosses);
        all += model->triangle_count;
        for (size_t t = 0; t < model->mesh.tri_count; t++) {
            size_t crossings = count_crossings(model, t);
            found += crossings;
            assert_true(crossings == 0 || (crosses && crosses[model->mesh.tri_source[t]]));
        }
        model_finish(model);
    }
    print_message("# %zu crossings; %zu of %zu faces may cross\n", found, flagged, all);
    assert_true(found > 1000 && flagged < all);
    mem_free(model);
}

TEST_GROUP(surface_case_set_up, surface_case_tear_down)
