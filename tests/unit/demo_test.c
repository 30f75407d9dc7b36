/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The demo plant: its plant file has no findings, the heat exchanger has the size given in the paper, sensors lie on surfaces,
   the model has its deliberate faults, and alarm limits fit the simulated process. */
#include "tests/support/test.h"

#include "base/math/vec.h"
#include "deploy/demo/sim_values.h"
#include "plant/plant.h"
#include "plant/sensors.h"
#include "preprocess/geometry/geometry.h"
#include "preprocess/model/model_source.h"
#include "preprocess/pipeline/prepare.h"
#include "surface/mesh/bvh.h"
#include "surface/mesh/trimesh.h"

static struct plant *plant;
static struct model_source source;
static struct gltf_model model;

static int set_up(void **state)
{
    (void)state;
    struct diag diag = { 0 };
    plant = plant_load("deploy/demo/plant.yaml", &diag);
    diag_print(&diag, stderr);
    assert_int_equal(diag.count, 0);
    assert_non_null(plant);
    diag_finish(&diag);
    char why[MODEL_WHY_BYTES];
    assert_true(model_source_open(&source, "deploy/demo/plant.glb", why) && gltf_load(&model, &source, why));
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    gltf_free(&model);
    model_source_finish(&source);
    plant_destroy(&plant);
    return 0;
}

struct body { /* the geometry of one asset, taken from the model */
    struct geometry_params params;
    struct geometry geometry;
    struct trimesh mesh;
    size_t slivers_without_area, repeated;
};

static void body_init(struct body *body, int asset)
{
    char why[MODEL_WHY_BYTES];
    *body = (struct body){ .params = prepare_geometry(&plant->assets[asset]) };
    if (!geometry_cut(&body->geometry, &model, &body->params, why))
        fail_msg("%s: %s", plant->assets[asset].id, why);
    const struct geometry *g = &body->geometry;
    uint32_t *point = mem_array(g->vertex_count, sizeof(*point));
    assert_true(trimesh_weld(&body->mesh,
                             &(struct trimesh_model){ (const float(*)[3])g->positions_m, g->vertex_count, g->indices, g->index_count / 3 },
                             1e-6, point, &body->slivers_without_area, &body->repeated));
    mem_free(point);
}

static void body_finish(struct body *body)
{
    trimesh_finish(&body->mesh);
    geometry_finish(&body->geometry);
}

/* Returns the total number of triangles of the body, including degenerate ones. */
static size_t body_triangles(const struct body *body)
{
    return body->geometry.index_count / 3 + body->geometry.degenerate_triangles;
}

/* --- tests ------------------------------------------------------------------------------------------------------------------ */

TEST(test_registers_do_not_overlap)
{
    static unsigned char used[65536];
    for (size_t i = 0; i < plant->tag_count; i++) {
        const struct plant_tag *tag = plant->tags + i;
        int registers = tag->signal.type == DATA_FLOAT32 ? 2 : 1;
        assert_int_equal(tag->signal.table, TABLE_HOLDING);
        assert_int_equal(tag->signal.byte_order, registers == 2 ? BYTE_ORDER_CDAB : BYTE_ORDER_NONE);
        for (int k = 0; k < registers; k++)
            assert_int_equal(used[tag->signal.register_index + k]++, 0);
    }
}

TEST(test_exchanger)
{
    struct body body;
    int asset = plant_find_asset(plant, "E-101"), thermometers = 0;
    body_init(&body, asset);
    assert_in_range(body_triangles(&body), 60000, 66000);
    assert_int_equal(body.geometry.primitive_count, 5);
    for (size_t i = 0; i < plant->tag_count; i++)
        thermometers += plant->tags[i].asset == asset && plant->tags[i].group == plant_find_group(plant, "temperature");
    assert_int_equal(thermometers, 5);
    body_finish(&body);
}

TEST(test_sensors_on_surface)
{
    size_t by_node = 0;
    for (size_t a = 0; a < plant->asset_count; a++) {
        struct body body;
        struct plant_sensor *sensors;
        char why[MODEL_WHY_BYTES];
        body_init(&body, (int)a);
        struct bvh *bvh = bvh_create(&body.mesh);
        size_t count = plant_sensors(plant, (int)a, &sensors);
        for (size_t i = 0; i < count; i++) {
            double *at = sensors[i].position_m;
            struct bvh_place nearest;
            if (sensors[i].node && !geometry_node_place(&model, &body.params, sensors[i].node, at, why))
                fail_msg("%s: %s", plant->tags[sensors[i].tag].name, why);
            by_node += sensors[i].node != NULL;
            vec_sub(at, body.geometry.origin_m, at);
            bvh_nearest(bvh, at, INFINITY, NULL, NULL, &nearest);
            /* sensors that are placed by a node of the model may be 20 mm off, because the node's position is the centre of its
               fitting */
            if (nearest.distance_m > (sensors[i].node ? 0.02 : 0.001))
                fail_msg("%s: %g m from the surface of %s", plant->tags[sensors[i].tag].name, nearest.distance_m, plant->assets[a].id);
        }
        mem_free(sensors);
        bvh_destroy(&bvh);
        body_finish(&body);
    }
    assert_in_range(by_node, plant->tag_count / 3, plant->tag_count * 2 / 3);
}

/* The model deliberately contains faults that CAD exports have: duplicate faces and slivers (very thin triangles). */
TEST(test_faults)
{
    struct body body;
    body_init(&body, plant_find_asset(plant, "E-101"));
    size_t slivers = body.slivers_without_area + body.geometry.degenerate_triangles;
    for (size_t t = 0; t < body.mesh.tri_count; t++) {
        double longest = 0;
        for (int k = 0; k < 3; k++) {
            double edge[3];
            vec_sub(body.mesh.points[body.mesh.tris[t][(k + 1) % 3]], body.mesh.points[body.mesh.tris[t][k]], edge);
            longest = fmax(longest, vec_length(edge));
        }
        slivers += longest * longest > 100 * 2 * trimesh_tri_area(&body.mesh, t);
    }
    assert_in_range(body.repeated, 5, 1000);
    assert_in_range(slivers, 5, 5000);
    body_finish(&body);
}

/* --- simulated process compared with the alarm limits ----------------------------------------------------------------------- */

enum { CALM, UPSET_KINDS = 3, CYCLE_S = 690, MACHINES = 5, RECOVERY_S = 60 };

static bool beyond(const struct plant_tag *tag, double value, enum limit low, enum limit high)
{
    return value < tag->alarms.limits[low] || value > tag->alarms.limits[high]; /* NaN: no limit */
}

/* Returns which upset (simulated fault, such as lost cooling water) is running or still has effects: 1 to 3, or CALM. *last and
   *since_s: the last upset and the seconds since its end. */
static int upset_now(const struct sim_values *values, int *last, int *since_s)
{
    static const char *const names[] = { "cooling water lost", "exchanger fouled", "bearing worn" };
    const char *name;
    sim_values_upset(values, &name);
    for (int u = 0; u < UPSET_KINDS; u++)
        if (!strcmp(name, names[u])) {
            *last = u + 1;
            *since_s = 0;
            return *last;
        }
    return ++*since_s <= RECOVERY_S ? *last : CALM;
}

/* Without an upset, every tag must stay within its alarm limits. During an upset, at most 12 tags may be beyond H or L, and
   some must be beyond HH or LL. The simulated time covers one cycle of upsets per machine, because the worn bearing affects
   another machine in each cycle. */
TEST(test_limits_fit_the_process)
{
    struct diag diag = { 0 };
    struct sim_map map = { 0 };
    struct sim_values *values = sim_values_create(plant, &map, false, &diag);
    int last = CALM, since_s = 0, most[UPSET_KINDS + 1] = { 0 }, most_far[UPSET_KINDS + 1] = { 0 };
    assert_non_null(values);
    for (int second = 0; second < MACHINES * CYCLE_S; second++) {
        sim_values_step(values, 1);
        int upset = upset_now(values, &last, &since_s), count = 0, far = 0;
        for (size_t i = 0; i < plant->tag_count; i++) {
            double value = sim_values_at(values, i);
            bool out = beyond(&plant->tags[i], value, LIMIT_L, LIMIT_H);
            if (out && upset == CALM)
                print_error("%s: %g after %d s, in calm\n", plant->tags[i].name, value, second);
            count += out;
            far += beyond(&plant->tags[i], value, LIMIT_LL, LIMIT_HH);
        }
        most[upset] = count > most[upset] ? count : most[upset];
        most_far[upset] = far > most_far[upset] ? far : most_far[upset];
    }
    assert_int_equal(most[CALM], 0);
    for (int u = 1; u <= UPSET_KINDS; u++) {
        assert_in_range(most[u], 3, 12);
        assert_in_range(most_far[u], 1, most[u]);
    }
    sim_values_destroy(&values);
    diag_finish(&diag);
}

TEST_GROUP(set_up, tear_down)
