/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where an asset's vertices lie on its surface, to give them distances: the vertices of coarser levels lie beside the surface
   and must get the distances of the side to which they belong. */
#include "surface/vertex_embedding.h"

#include "tests/support/test.h"

#include "base/files/cache_file.h"
#include "protocol/asset_distance.h"
#include "scene/asset.h"
#include "surface/surface_store.h"
#include "tests/support/cad.h"
#include "tests/support/model_maker.h"
#include "tests/support/prep_case.h"

#define CELL 0.02 /* size of the plate's cells and thickness of the plate, in metres */
#define ACROSS 80
#define UP 60
#define RADIUS 0.8 /* radius of the bent plate's inner side, in metres */
#define FAR 3e-3   /* of the largest distance */

static struct log *the_log;

static int set_up(void **state)
{
    the_log = log_create(LOG_ERROR);
    return prep_case_set_up(state);
}

static int tear_down(void **state)
{
    log_destroy(&the_log);
    return prep_case_tear_down(state);
}

/* Makes a thin plate, bent about the y axis. It is bent so much that an edge of a coarser level cuts through it and emerges on
   the other side. */
static void make_bent_plate(struct cad *plate, struct cad_random *random)
{
    cad_box(plate, random, ACROSS, UP, 1, CELL);
    for (size_t v = 0; v < plate->vertex_count; v++) {
        float *p = plate->positions[v];
        double turn = ((double)p[0] - ACROSS * CELL / 2) / RADIUS, radius = RADIUS + (double)p[2];
        p[0] = (float)(radius * sin(turn));
        p[2] = (float)(radius * cos(turn));
    }
}

static struct surface *kept_surface(const struct prep_case *c)
{
    struct cache_file kept;
    uint64_t key;
    char *path = prep_case_file(c, ".surface", &key);
    assert_true(cache_file_open_compressed(&kept, the_log, path, SURFACE_MAGIC, key));
    struct surface *surface = surface_unpack(&(struct unpack){ .at = kept.bytes, .left = kept.count }, the_log, NULL);
    assert_non_null(surface);
    cache_file_close(&kept);
    return surface;
}

/* --- points off the surface ------------------------------------------------------------------------------------------------- */

static void on_side(double turn, double y, double radius, float out[3])
{
    out[0] = (float)(radius * sin(turn));
    out[1] = (float)y;
    out[2] = (float)(radius * cos(turn));
}

/* Points below the plate's outer side, where an edge of a coarser level would lie, must be found on the outer side by their
   normal, although the inner side is nearer. */
TEST(what_stands_off_is_on_the_side_that_it_looks_along)
{
    enum { COUNT = 200 };
    struct cad *plate = test_cad();
    struct cad_random chance;
    float places[2 * COUNT][3], normals[2 * COUNT][3], found_m[2 * COUNT];
    uint32_t triangles[3 * COUNT];
    const double outer = RADIUS + CELL, source[3] = { 0, UP * CELL / 2, outer };
    double worst_m = 0, nearest_m = INFINITY;
    cad_random_start(&chance);
    make_bent_plate(plate, &chance);
    /* points 0 to COUNT - 1 lie exactly on the outer side, like vertices of the finest level; the others lie below them, nearer
       to the inner side */
    for (int i = 0; i < COUNT; i++) {
        double turn = 0.8 * (cad_random(&chance) - 0.5), y = UP * CELL * (0.3 + 0.4 * cad_random(&chance));
        double off_m = CELL * (0.55 + 0.4 * cad_random(&chance));
        on_side(turn, y, outer, places[i]);
        on_side(turn, y, outer - off_m, places[COUNT + i]);
        on_side(turn, 0, 1, normals[i]);
        on_side(turn, 0, 1, normals[COUNT + i]);
        triangles[3 * i] = triangles[3 * i + 1] = triangles[3 * i + 2] = (uint32_t)i;
    }
    struct surface *surface = surface_create(the_log, NULL, (const float(*)[3])plate->positions, plate->vertex_count, plate->triangles,
                                             plate->triangle_count, &(struct surface_params){ 0 });
    assert_non_null(surface);
    for (int told = 0; told < 2; told++) {
        struct vertex_embedding *embedding =
            vertex_embedding_create(surface, (const float(*)[3])places, told ? (const float(*)[3])normals : NULL, (size_t)(2 * COUNT),
                                    triangles, COUNT);
        assert_non_null(embedding);
        assert_true(vertex_embedding_distances(embedding, source, found_m));
        for (int i = 0; i < COUNT; i++) {
            const double dy = (double)places[i][1] - source[1], turn = atan2((double)places[i][0], (double)places[i][2]);
            double error_m = fabs((double)found_m[COUNT + i] - hypot(outer * turn, dy));
            if (told)
                worst_m = fmax(worst_m, error_m);
            else
                nearest_m = fmin(nearest_m, error_m);
        }
        vertex_embedding_destroy(&embedding);
    }
    print_message("# on their side places err by %.4f m at most, on the other one by %.3f m at least\n", worst_m, nearest_m);
    assert_true(worst_m < CELL / 4);
    assert_true(nearest_m > 0.1);
    surface_destroy(&surface);
}

/* --- against plantcast-prep --------------------------------------------------------------------------------------------------- */

/* Counts the vertices of coarser levels whose distance, as embedded here, differs from the one in the asset file by more than
   FAR of the largest distance. */
static size_t count_far(const struct asset_view *view, const struct surface *surface, const float (*normals)[3])
{
    const struct asset_level *finest = &view->levels[0];
    const struct asset_primitive *first = &view->primitives[finest->first_primitive], *last = first + finest->primitive_count - 1;
    const uint32_t *triangles = view->indices + first->first_index;
    const uint32_t index_count = last->first_index + last->index_count - first->first_index;
    const size_t count = finest->vertex_count;
    struct vertex_embedding *embedding = vertex_embedding_create(surface, view->positions_m, normals, count, triangles, index_count / 3);
    assert_non_null(embedding);
    char *of_finest = test_memory(mem_array(count, 1));
    float *found_m = mem_array(count, sizeof(*found_m));
    size_t far = 0, coarser = 0;
    for (size_t i = 0; i < index_count; i++)
        of_finest[triangles[i]] = 1;
    for (size_t s = 0; s < view->header->sensor_count; s++) {
        const float *p = view->sensors[s].surface_m;
        double largest_m = 0;
        assert_true(vertex_embedding_distances(embedding, (const double[3]){ (double)p[0], (double)p[1], (double)p[2] }, found_m));
        for (size_t v = 0; v < count; v++)
            largest_m = fmax(largest_m, (double)asset_distance_m(view, s, v));
        for (size_t v = 0; v < count; v++) {
            double error_m = fabs((double)asset_distance_m(view, s, v) - (double)found_m[v]);
            assert_true(!of_finest[v] || error_m < FAR * largest_m);
            coarser += !of_finest[v];
            far += !of_finest[v] && error_m > FAR * largest_m;
        }
    }
    print_message("# %s normals, %zu of %zu distances of coarser levels are not those stored\n", normals ? "with" : "without", far,
                  coarser);
    mem_free(found_m);
    vertex_embedding_destroy(&embedding);
    return far;
}

/* The coarsest level is not tested: its error equals the plate's thickness, and it intersects itself in places, where neither
   side is right. */
TEST(coarser_levels_have_the_distances_of_their_own_side)
{
    struct prep_case *c = *state;
    struct cad *plate = test_cad();
    struct cad_random random = { 7 };
    uint64_t key;
    make_bent_plate(plate, &random);
    maker_write_cad(c->folder, "model.glb", "plate", plate);
    prep_case_plant(c, "plant: { name: Bent plate }\n"
                       "assets: [{ id: A, model: model.glb, nodes: plate, up: z }]\n"
                       "groups: [{ id: t, unit: K, min: 0, max: 1 }]\n"
                       "tags: tags.csv\n");
    prep_case_tags(c, "out,,,,t,A,,0.1,0.55,0.83\n"
                      "in,,,,t,A,,-0.2,0.6,0.7\n");
    prep_case_expect(c, "$PLANT", 0);
    char *path = prep_case_file(c, ".asset", &key);
    struct asset *asset = asset_open(the_log, path);
    assert_non_null(asset);
    struct surface *surface = kept_surface(c);
    size_t without = count_far(&asset->view, surface, NULL), with = count_far(&asset->view, surface, asset->view.normals);
    assert_true(without > 100 && with < without / 2);
    surface_destroy(&surface);
    asset_unref(&asset);
}

TEST_GROUP(set_up, tear_down)
